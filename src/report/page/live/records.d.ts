// Types of the answers of the `sweetspot view` server (src/report/json/live.rs and src/cli/view), and of the
// requests of the page. Lengths are in mm, angles in degrees. A placement is x, y, z and yaw.

/** x, y and z in mm, and the yaw in degrees. */
type Placement = number[];
/** x and y of the centre, width and height, mm. */
type RectangleNumbers = number[];

/** One number of the layout that the page can change. */
interface NumberRecord {
  key: string;
  free: boolean;
  min: number | null;
  max: number | null;
  /** The only allowed values; null if a range is allowed. */
  list: number[] | null;
}

/** Numbers of one piece of equipment, of the attitude of one operation, or of the robot base. */
interface NumberGroup {
  group: "equipment" | "attitude" | "robot_base";
  name: string;
  /** Index of the equipment. */
  index?: number;
  numbers: NumberRecord[];
}

interface CellEquipment {
  name: string;
  obstacle: boolean;
  /** Index of the equipment that carries this equipment. */
  on: number | null;
  footprint: RectangleNumbers;
  surface: RectangleNumbers | null;
}

/** Part of a cell that does not depend on the layout, and the layout shown. */
interface CellRecord {
  schema: "sweetspot/live/1";
  cell: string;
  robot: string;
  errors: string;
  form: NumberGroup[];
  senses: string[];
  budget: number;
  seed: number;
  can_search: boolean;
  equipment: CellEquipment[];
  base_footprint: RectangleNumbers;
  /** Least x and y, greatest x and y of every keep-out zone. */
  keep_out: number[][];
  fence: number[][] | null;
  file: string;
  now: StepRecord;
}

type Numbers = Record<string, number>;

/** The numbers of a layout. */
interface LayoutNumbers {
  robot_base: Numbers;
  equipment: Record<string, Numbers>;
  attitude: Record<string, Numbers>;
}

/** Error map of an operation: one list for each property of the nodes. */
interface NodesRecord {
  ij: number[][];
  at: number[][];
  status: NodeStatus[];
  value: (number | null)[];
  error: (number[] | null)[];
  /** Index of the reason of each node. */
  why: number[];
  reasons: string[];
  every: number;
}

interface OperationAnswer {
  name: string;
  equipment: number | null;
  sense: string;
  value: number | null;
  limit: number | null;
  margin: number | null;
  /** Upper bound of the value within the placement tolerances. */
  worst: number | null;
  /** Names of the joints that are near a limit at the spot. */
  near_limits: string[];
  /** Number of nodes by status. */
  counts: Record<string, number>;
  best: number[] | null;
  nodes: NodesRecord;
}

/** Evaluation of a layout. */
interface AnswerRecord {
  feasible: boolean;
  met: boolean;
  /** Whether the layout works at every misplacement within the tolerances; null if none is demanded. */
  certified: boolean | null;
  objective: number | null;
  unit: string;
  word: string;
  reasons: string[];
  placements: Placement[];
  base: Placement;
  operations: OperationAnswer[];
}

interface LensChoice {
  model: string;
  reading: string;
  word: string;
}

interface QuestionRecord {
  sense: string | null;
  reading: string;
  model: string;
}

/** The step of the session that is shown. */
interface StepRecord {
  revision: number;
  /** Number of steps that can be undone; `redo` is the number that can be redone. */
  undo: number;
  redo: number;
  /** Description of the change. */
  what: string;
  question: QuestionRecord;
  numbers: LayoutNumbers;
  lenses: LensChoice[];
  /** Objective of the previous step. */
  before: number | null;
  answer: AnswerRecord;
}

/** Answer to a layout that is tried but not kept. */
interface TryRecord {
  numbers: LayoutNumbers;
  answer: AnswerRecord;
  drawing: DrawingDocument | null;
}

interface SearchRecord {
  running: boolean;
  evaluations: number;
  budget: number;
  feasible: number;
  seed: number;
  start: number | null;
  best: number | null;
  gain_percent: number | null;
  unit: string;
  seconds: number;
  ended: string | null;
  fault: string | null;
  acceptable: boolean;
}

interface PulseRecord {
  revision: number;
  search: SearchRecord | null;
}

/** Outlines of the reach at the height of the work, for each operation. */
interface ReachRecord {
  outlines: number[][][][];
}

/** Region in which one piece may stand, and the room of the piece. */
interface RegionRecord {
  equipment: string;
  outline_mm: number[][][];
  rim_mm: number;
  z_mm: number[];
  yaw_deg: number[];
  room_mm: number | null;
  room_deg: number | null;
  ends_with: string;
}

/** Room of every piece; empty if the layout is not feasible or misses a limit. */
interface RoomRecord {
  regions: RegionRecord[];
  whole_cell: { turn_deg: number[]; ends_with: string } | null;
}

/** Where the origin of a piece may stand, as closed rings. */
interface StandingRecord {
  outline: number[][][];
}

/** Answers of the server by request. */
interface Answers {
  state: CellRecord;
  now: StepRecord;
  reach: ReachRecord;
  room: RoomRecord;
  standing: StandingRecord;
  drawing: DrawingDocument;
  pulse: PulseRecord;
  try: TryRecord;
  "try-drawing": TryRecord;
  save: { saved: string };
  search: PulseRecord;
  stop: PulseRecord;
  layout: StepRecord;
  question: StepRecord;
  accept: StepRecord;
  undo: StepRecord;
  redo: StepRecord;
  reset: StepRecord;
}

/** Requests that change the layout shown. */
type ChangeRequest = "layout" | "question" | "accept" | "undo" | "redo" | "reset";

/** Answer of the server to a request that it refuses. */
interface Refusal {
  error?: string;
  /** Whether a file of this name exists. */
  taken?: boolean;
}

interface Window {
  /** Durations from a change to the drawn map, ms; tests/browser/view.mjs reads them. */
  sweetspotDrawn: number[];
  /** Returns the position of the origin of equipment in the 3-D view, px; for tests/browser/view.mjs. */
  sweetspotSpot(name: string): number[] | null;
}
