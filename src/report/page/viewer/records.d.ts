// Types of the document `sweetspot/drawing/1`, which src/report/json/drawing.rs writes, and of the data that
// the viewer derives from it. Lengths are in mm, angles of joints in degrees, angles of the camera in
// radians.

/** Three numbers: x, y and z in the world frame. */
type Vector = number[];
/** Homogeneous transformation: 16 numbers, column by column. */
type Matrix = number[];
/** Red, green and blue from 0 to 1. */
type Colour = number[];
/** Rigid pose in a document: the columns of the rotation matrix, then the origin; 12 numbers. */
type PoseRecord = number[];
/** Little-endian array in base64: 32-bit floats, or 32-bit unsigned integers. */
type EncodedArray = string;

interface MeshRecord {
  positions: EncodedArray;
  normals: EncodedArray;
  indices: EncodedArray;
}

interface JointRecord {
  name: string;
  unit: "deg" | "mm";
}

interface RectangleRecord {
  centre_mm: number[];
  size_mm: number[];
}

interface EquipmentRecord {
  name: string;
  obstacle: boolean;
  /** Index of the equipment that carries this equipment. */
  on: number | null;
  at: PoseRecord | null;
  surface: RectangleRecord | null;
  footprint: RectangleRecord;
}

interface OperationRecord {
  name: string;
  equipment: number | null;
  sense: string;
  standoff_mm: number;
  limit: number | null;
}

type PartKind = "robot" | "tool" | "held" | "equipment" | "obstacle" | "fence" | "keep-out";

interface PartRecord<Pose = PoseRecord, Mesh = number> {
  name: string;
  owner: string;
  kind: PartKind;
  /** Index of the robot link that carries the part; null for a part that is fixed in the world. */
  link: number | null;
  at: Pose | null;
  equipment: number | null;
  /** Index of the operation during which the robot holds the part. */
  operation: number | null;
  mesh: Mesh;
}

/** One way to evaluate the error: an error model and a reading (tolerance interpretation). */
interface LensRecord {
  model: string;
  reading: string;
  signed: boolean;
}

interface SenseRecord {
  name: string;
  unit: string;
}

/** Errors and values of all nodes of an operation under one lens; NaN for a node without values. */
interface TakeRecord {
  lens: number;
  error: EncodedArray;
  values: EncodedArray[];
  best: number | null;
}

/** Error map of one operation. */
interface FieldRecord {
  operation: number;
  equipment: number | null;
  senses: SenseRecord[];
  sense: number;
  size: number[];
  every: number;
  nodes: number[][];
  positions: EncodedArray;
  status: NodeStatus[];
  reason: string[];
  joints: (number[] | null)[];
  best: number | null;
  spot_mm: Vector | null;
  refined_mm: Vector | null;
  takes: TakeRecord[];
}

interface EnvelopeRecord {
  at_work: EncodedArray[];
  around: EncodedArray[];
}

interface StopRecord {
  /** Index of the operation; null at home. */
  operation: number | null;
  name: string;
  joints: number[];
  time_s: number;
}

interface MovementRecord<Frames = EncodedArray> {
  /** Whether the paths between the stops were checked for collision. */
  checked: boolean;
  stops: StopRecord[];
  times_s: number[];
  /** Index of the operation whose part the robot holds, for each time. */
  holding: (number | null)[];
  links: number;
  frames: Frames;
}

interface DrawingRecord {
  name: string;
  cell: string;
  robot: string;
  base: PoseRecord;
  floor_mm: number;
  extent_mm: Vector[];
  joints: JointRecord[];
  equipment: EquipmentRecord[];
  operations: OperationRecord[];
  parts: PartRecord[];
  lenses: LensRecord[];
  fields: FieldRecord[];
  envelopes: EnvelopeRecord[];
  movement: MovementRecord;
}

interface DrawingDocument {
  schema: "sweetspot/drawing/1";
  units: { length: "mm"; angle: "deg" };
  meshes: MeshRecord[];
  drawings: DrawingRecord[];
}

// ---- Data that the viewer derives from a document.

interface Extent {
  low: Vector;
  high: Vector;
}

interface Mesh extends Extent {
  /** Content of the mesh as a key. It identifies the same mesh in the next document. */
  key: string;
  positions: Float32Array<ArrayBuffer>;
  normals: Float32Array<ArrayBuffer>;
  indices: Uint32Array<ArrayBuffer>;
  /** Feature edges: six numbers for each segment. */
  edges: Float32Array<ArrayBuffer>;
  /** Points on the mesh to which the leader line of a label may lead. */
  anchors: Vector[];
  buffers: MeshBuffers | null;
}

type Part = PartRecord<Matrix, Mesh>;

interface Take {
  error: Float32Array;
  values: Float32Array[];
  best: number | null;
}

type Field = Omit<FieldRecord, "positions" | "takes"> & {
  positions: Float32Array;
  /** Takes by the index of their lens. */
  takes: Take[];
  count: number;
  /** Mean distance between neighbouring nodes, mm. */
  spacing: number;
};

interface Envelope {
  atWork: Float32Array[];
  around: Float32Array[];
}

type Movement = MovementRecord<Float32Array>;
type Equipment = Omit<EquipmentRecord, "at"> & { at: Matrix | null };

type Drawing = Omit<DrawingRecord, "base" | "parts" | "equipment" | "envelopes" | "movement" | "fields"> & {
  base: Matrix;
  parts: Part[];
  equipment: Equipment[];
  envelopes: Envelope[];
  movement: Movement;
  fields: Field[];
};

interface Model extends Extent {
  meshes: Mesh[];
  drawings: Drawing[];
  /** Points that a camera must see. */
  points: Vector[];
}

// ---- State of the picture.

type NodeStatus =
  | "ok"
  | "out-of-reach"
  | "joint-limit"
  | "attitude"
  | "not-converged"
  | "collision"
  | "singular"
  | "approach"
  | "retract"
  | "unjudged";
type Mark = NodeStatus | "spot" | "diamond";
/** Mark of a node, with its meaning. */
interface NodeSign {
  mark: Mark;
  text: string;
}

/** Line drawing of a node that cannot be used: strokes in units of the radius of its ring, y downwards. */
interface GlyphRecord {
  ring: boolean;
  dashed: boolean;
  strokes: [number, number][][];
  tone: Tone;
}

/** Label and glyph of a status, from src/core/drawing/node_glyph.rs. A usable node has no glyph. */
interface NodeSignRecord {
  label: string;
  glyph: GlyphRecord | null;
}

declare const NODE_SIGN_TABLE: Record<NodeStatus, NodeSignRecord>;

/** Shape of a mark: a path within a square from -1 to 1 (y downwards), its tone, and whether it is dashed. */
interface MarkShape {
  path: string;
  tone: Tone;
  dashed: boolean;
}

type Tone = "value" | "grey" | "red" | "orange" | "pink";

type Theme = "light" | "dark";
type Visibility = "solid" | "clear" | "none";
type ArrowChoice = "none" | "x" | "y" | "z" | "components" | "resultant";
type ViewName = "iso" | "top" | "front" | "side";

/** Choices of the switches. Pages share them through `show`, `state` and the event `state`. */
interface ViewerState {
  drawing: number;
  /** Index of the operation; null shows all operations. */
  operation: number | null;
  lens: number;
  /** Name of a sense; null shows the sense of each operation. */
  sense: string | null;
  arrows: ArrowChoice;
  envelope: boolean;
  solids: Visibility;
  robot: Visibility;
  /** Time of the movement, s. */
  time: number;
  /** Index of the drawing to compare with; null turns the comparison off. */
  compareTo: number | null;
}

interface ViewerOptions extends Partial<ViewerState> {
  /** `false` shows the bare picture. */
  controls?: boolean;
  /** `"always"` zooms with the wheel without a preceding click. */
  wheel?: "always";
}

interface Camera {
  target: Vector;
  distance: number;
  azimuth: number;
  elevation: number;
  /** Whether the projection is orthographic. */
  parallel: boolean;
}

/** Quantities derived from a camera and the size of the picture. */
interface Optics {
  eye: Vector;
  right: Vector;
  up: Vector;
  back: Vector;
  /** Projection times view matrix. */
  camera: Matrix;
  /** Pixels per mm at the distance of the target. */
  pixelsPerMm: number;
  /** Pixels per mm at a point, multiplied by the fourth homogeneous coordinate of the point. */
  scalePerMm: number;
  /** Position of the eye, or the direction to it in an orthographic projection. */
  viewpoint: Vector;
}

interface ValueRange {
  low: number;
  high: number;
}

interface ColourScale {
  /** Range of the values by unit. */
  ranges: Record<string, ValueRange>;
  /** Comparison with another layout; null if no layout is compared. */
  comparison: { other: Drawing; greatest: number; unit: string } | null;
}

interface NodeReference {
  field: Field;
  index: number;
}

/** State from which the functions of the viewer draw. */
interface View {
  model: Model;
  drawing: Drawing;
  state: ViewerState;
  /** Index of the lens in the lenses of the drawing. */
  lens: number;
  scale: ColourScale;
  /** Magnification of the error arrows. */
  magnification: number;
  /** Mean distance between nodes, mm. */
  spacing: number;
  /** Bounds of the drawn floor: least x and y, greatest x and y, mm. */
  floorBounds: number[];
  theme: Theme;
  /** Displacement of equipment that is being dragged, by its index. */
  shifts: Map<number, Matrix>;
  /** Pose of every robot link at the time shown. */
  frames: Matrix[];
  camera: Camera;
  optics: Optics;
  /** Size of the picture in CSS pixels. */
  width: number;
  height: number;
  /** Pixels of the canvas per CSS pixel. */
  ratio: number;
  playing: boolean;
  picked: NodeReference | null;
  graphics: Graphics;
  /** Key of the content of the shadow map. */
  shadowKey: string;
  shadowCamera: Matrix;
}

interface PickEvent {
  operation: number;
  index: number;
  node: number[];
  position: Vector;
  status: NodeStatus;
  reason: string;
  clicked: boolean;
}

interface ViewerEvents {
  camera: Camera;
  pick: PickEvent | null;
  time: number;
  state: ViewerState;
}

interface ScreenPoint {
  x: number;
  y: number;
  visible: boolean;
}

interface FloorPoint {
  x: number;
  y: number;
  z: number;
}

interface PlacementNumbers {
  x_mm?: number;
  y_mm?: number;
  z_mm?: number;
  yaw_deg?: number;
}

/** Interface of a viewer for the scripts of a page. */
interface SweetspotViewer {
  readonly canvas: HTMLCanvasElement | null;
  supported(): boolean;
  show(wanted: Partial<ViewerState>): SweetspotViewer;
  replace(document: DrawingDocument): SweetspotViewer;
  movePart(equipment: number, placement: PlacementNumbers): void;
  setCamera(wanted: Partial<Camera>): void;
  /** Sets the camera to the camera of a linked viewer, without an event. */
  linked(camera: Camera): void;
  state(): Partial<ViewerState>;
  camera(): Partial<Camera>;
  on<Name extends keyof ViewerEvents>(
    event: Name,
    listener: (told: ViewerEvents[Name]) => void,
  ): SweetspotViewer;
  project(x: number, y: number, z: number): ScreenPoint | null;
  pickFloor(x: number, y: number, height?: number): FloorPoint | null;
  pickEquipment(x: number, y: number, obstacles?: boolean): { equipment: number; at: Vector } | null;
  look(name: ViewName | "reset"): void;
  play(on?: boolean): void;
}

interface SweetspotViewerFactory {
  (host: HTMLElement, document: DrawingDocument, options?: ViewerOptions): SweetspotViewer;
  /** Makes several viewers share one camera. */
  link(viewers: SweetspotViewer[]): void;
  /** Returns whether the browser offers WebGL 2. */
  supported(): boolean;
  /** Meaning and mark of every status of a node. */
  nodeSigns: Record<NodeStatus, NodeSign>;
  marks: Record<Mark, MarkShape>;
}

declare var sweetspotViewer: SweetspotViewerFactory;

// ---- Data on the graphics card.

interface Program {
  program: WebGLProgram;
  attributes: Record<string, number>;
  uniforms: Record<string, { location: WebGLUniformLocation; type: number }>;
}

type ProgramName = "solid" | "shadow" | "line" | "arrow" | "glyph" | "floor";

interface MeshBuffers {
  array: WebGLVertexArrayObject;
  shadowArray: WebGLVertexArrayObject;
  count: number;
  edges: Batch;
  buffers: WebGLBuffer[];
}

/** Instances that are drawn with one call. */
interface Batch {
  buffer: WebGLBuffer;
  array: WebGLVertexArrayObject;
  count: number;
}

interface Graphics {
  gl: WebGL2RenderingContext;
  programs: Record<ProgramName, Program>;
  /** Corners of one line segment, of a square about the origin, and of the unit square. */
  stripe: WebGLBuffer;
  square: WebGLBuffer;
  quarter: WebGLBuffer;
  arrow: { round: WebGLBuffer; form: WebGLBuffer; count: number };
  shadow: { map: WebGLTexture; target: WebGLFramebuffer };
  floor: WebGLVertexArrayObject;
  batches: Record<string, Batch>;
}

/** Values of the uniforms of a program, by name. */
type Uniforms = Record<string, number | number[]>;
