// The viewer: its state, and the interface for the scripts of a page.

/** Time that the hint is shown, ms. */
const HINT = 1600;

/** Time after the start of a stop during which the robot counts as resting there, s. */
const STOP = 0.65;

/**
 * Shows a document (sweetspot/drawing/1) in a host element. `ViewerState` lists what can be shown, and
 * `ViewerEvents` lists the events. The CSS variable --ss-height sets the height of the picture.
 * @implements {SweetspotViewer}
 */
class Viewer {
  /**
   * @param {HTMLElement} host
   * @param {DrawingDocument} written
   * @param {ViewerOptions} options
   * @param {HTMLCanvasElement} canvas
   * @param {Graphics} graphics
   */
  constructor(host, written, options, canvas, graphics) {
    this.canvas = canvas;
    this.view = initialView(written, graphics);
    settle(this.view);
    this.view.state.time = timeOf(this.view.drawing, null);
    /** @type {{ [Name in keyof ViewerEvents]: ((told: ViewerEvents[Name]) => void)[] }} */
    this.listeners = { camera: [], pick: [], time: [], state: [] };
    this.picture = new Picture(
      this.view,
      canvas,
      (now) => this.advance(now),
      (data) => this.showControls(data),
    );
    this.cameraControl = new CameraControl(
      this.view,
      (camera) => this.tell("camera", camera),
      () => this.picture.request(false),
    );
    this.lastTick = 0;
    this.hintTimer = 0;
    this.hintBox = element("div", { class: "ss-hint" });
    this.picture.stage.append(this.hintBox);
    // The content of the host is kept for print and for browsers without WebGL.
    for (const child of host.children) if (child instanceof HTMLElement) child.hidden = true;
    host.append(this.picture.root);
    if (options.controls !== false) this.addControls();
    listenToPointer(this.pointerTarget(), canvas, options);
    this.show({ ...options, operation: options.operation ?? null });
    this.picture.start();
  }

  addControls() {
    const { root, stage } = this.picture;
    const show = (/** @type {Partial<ViewerState>} */ wanted) => this.show(wanted);
    this.controls = makeControls(this.view, root, show, (name) => this.look(name));
    this.timeline = makeTimeline(this.view, (on) => this.play(on), show);
    stage.after(this.timeline.box);
  }

  /** @param {boolean} data whether the data shown have changed */
  showControls(data) {
    if (this.controls && data) showControls(this.controls, this.view);
    if (this.timeline) showTimeline(this.timeline, this.view);
  }

  /** @returns {PointerTarget} */
  pointerTarget() {
    const { cameraControl } = this;
    return {
      turn: (dx, dy) => cameraControl.turn(dx, dy),
      shift: (dx, dy) => cameraControl.shift(dx, dy),
      zoom: (factor, at) => cameraControl.zoom(factor, at),
      look: (name) => this.look(name),
      hover: (at, radius, clicked) => this.hover(at, radius, clicked),
      hint: (text) => this.hint(text),
    };
  }

  supported() {
    return true;
  }

  /**
   * @template {keyof ViewerEvents} Name
   * @param {Name} event
   * @param {ViewerEvents[Name]} what
   */
  tell(event, what) {
    for (const listener of this.listeners[event]) listener(what);
  }

  /**
   * @template {keyof ViewerEvents} Name
   * @param {Name} event
   * @param {(told: ViewerEvents[Name]) => void} listener
   */
  on(event, listener) {
    this.listeners[event].push(listener);
    return this;
  }

  // ---- State of the picture.

  state() {
    return { ...this.view.state };
  }

  /** @param {Partial<ViewerState>} wanted */
  show(wanted) {
    const { view } = this;
    const { state } = view;
    const before = { ...state };
    const lens = view.drawing.lenses[view.lens];
    for (const key of Object.keys(state)) {
      const value = Reflect.get(wanted, key);
      if (value !== undefined) Reflect.set(state, key, value);
    }
    if (state.drawing !== before.drawing && wanted.lens === undefined) {
      // Keeps reading and model: their lens may have another index in the other layout.
      const other = view.model.drawings[clamp(state.drawing, 0, view.model.drawings.length - 1)];
      state.lens = Math.max(lensIn(other, lens), 0);
    }
    const isTimeOnly = Object.keys(wanted).every((key) => key === "time");
    if (!isTimeOnly) settle(view);
    const goesElsewhere = state.drawing !== before.drawing || state.operation !== before.operation;
    if (goesElsewhere && wanted.time === undefined && !view.playing) {
      state.time = timeOf(view.drawing, state.operation);
    }
    state.time = clamp(Number(state.time) || 0, 0, durationOf(view.drawing.movement));
    if (state.time !== before.time) this.tell("time", state.time);
    if (!isTimeOnly) {
      view.picked = null;
      this.tell("state", { ...state });
    }
    this.picture.request(!isTimeOnly);
    return this;
  }

  /**
   * Shows another document of the same cell.
   * @param {DrawingDocument} written
   */
  replace(written) {
    const { view } = this;
    const { time } = view.state;
    const isAt = (/** @type {StopRecord} */ stop) => time >= stop.time_s && time <= stop.time_s + STOP;
    const halt = view.drawing.movement.stops.find(isAt);
    const old = view.model.meshes;
    view.model = readModel(written, new Map(old.map((mesh) => [mesh.key, mesh])));
    const kept = new Set(view.model.meshes);
    for (const mesh of old) if (!kept.has(mesh) && mesh.buffers) dropMesh(view.graphics, mesh.buffers);
    view.shifts.clear();
    view.picked = null;
    view.shadowKey = "";
    settle(view);
    view.state.time = timeAfter(view.drawing.movement, halt, time);
    this.picture.request(true);
    return this;
  }

  /**
   * Moves a piece of equipment and the equipment on it, until the next document.
   * @param {number} index
   * @param {PlacementNumbers} placement
   */
  movePart(index, { x_mm, y_mm, z_mm, yaw_deg }) {
    const { view } = this;
    const at = view.drawing.equipment[index]?.at;
    if (!at) return;
    const yaw = yaw_deg === undefined ? Math.atan2(at[1], at[0]) : (yaw_deg * Math.PI) / 180;
    const goal = uprightPose([x_mm ?? at[12], y_mm ?? at[13], z_mm ?? at[14]], yaw);
    const shift = product(goal, inverse(at));
    view.drawing.equipment.forEach((equipment, k) => {
      if (k === index || equipment.on === index) view.shifts.set(k, shift);
    });
    view.shadowKey = "";
    this.picture.request(true);
  }

  // ---- Camera and pointer.

  camera() {
    return this.cameraControl.current();
  }

  /** @param {Partial<Camera>} wanted */
  setCamera(wanted) {
    this.cameraControl.set(wanted);
  }

  /** @param {Camera} camera */
  linked(camera) {
    this.cameraControl.take(camera);
  }

  /** @param {ViewName | "reset"} name */
  look(name) {
    if (this.picture.isSized) this.cameraControl.look(name);
  }

  /**
   * @param {number} x
   * @param {number} y
   * @param {number} z
   */
  project(x, y, z) {
    return this.picture.isSized ? seenAt(this.view, [x, y, z]) : null;
  }

  /**
   * @param {number} x
   * @param {number} y
   * @param {number} [height]
   */
  pickFloor(x, y, height = this.view.drawing.floor_mm) {
    return this.picture.isSized ? floorUnder(this.view, x, y, height) : null;
  }

  /**
   * @param {number} x
   * @param {number} y
   * @param {boolean} [obstacles]
   */
  pickEquipment(x, y, obstacles = false) {
    return this.picture.isSized ? equipmentUnder(this.view, x, y, obstacles) : null;
  }

  /**
   * Picks the node under the pointer.
   * @param {number[] | null} at px
   * @param {number} radius px
   * @param {boolean} [clicked]
   */
  hover(at, radius, clicked = false) {
    const { view } = this;
    const next = at && nodeNear(view, at, radius);
    const isSame = next?.field === view.picked?.field && next?.index === view.picked?.index;
    if (isSame && !clicked) return;
    view.picked = next;
    showTip(this.picture.tip, view);
    this.tell("pick", next && pickEvent(next, clicked));
  }

  /**
   * Shows a hint for a while.
   * @param {string} text
   */
  hint(text) {
    this.hintBox.textContent = text;
    this.hintBox.classList.add("ss-seen");
    clearTimeout(this.hintTimer);
    this.hintTimer = setTimeout(() => this.hintBox.classList.remove("ss-seen"), HINT);
  }

  // ---- The movement of the robot.

  /**
   * Plays or stops the movement.
   * @param {boolean} [on]
   */
  play(on = true) {
    const { view } = this;
    if (on === view.playing) return;
    const duration = durationOf(view.drawing.movement);
    view.playing = on && view.drawing.movement.times_s.length > 1;
    if (on && view.state.time >= duration - 0.01) view.state.time = 0;
    this.lastTick = performance.now();
    this.picture.request(false);
  }

  /**
   * Moves robot and camera before a picture; returns whether one of these motions continues.
   * @param {number} now ms
   */
  advance(now) {
    if (this.view.playing) this.advanceTime(now);
    this.cameraControl.advance(now);
    return this.view.playing || this.cameraControl.flight !== null;
  }

  /** @param {number} now ms */
  advanceTime(now) {
    const { state, drawing } = this.view;
    const duration = durationOf(drawing.movement);
    state.time = Math.min(state.time + Math.min((now - this.lastTick) / 1000, 0.4), duration);
    this.lastTick = now;
    if (state.time >= duration) this.view.playing = false;
    this.tell("time", state.time);
  }
}

/**
 * Returns the time to show in a new movement. A robot that rested at a stop still rests there.
 * @param {Movement} movement
 * @param {StopRecord | undefined} halt stop of the previous movement at which the robot rested
 * @param {number} time s
 */
function timeAfter(movement, halt, time) {
  const isSame = (/** @type {StopRecord} */ stop) =>
    stop.operation === halt?.operation && (halt.operation !== null || stop.time_s >= halt.time_s);
  const stop = halt && movement.stops.find(isSame);
  return stop ? stop.time_s + time - halt.time_s : Math.min(time, durationOf(movement));
}

/**
 * Returns the event of a picked node.
 * @param {NodeReference} node
 * @param {boolean} clicked
 * @returns {PickEvent}
 */
const pickEvent = ({ field, index }, clicked) => ({
  operation: field.operation,
  index,
  node: field.nodes[index],
  position: nodeAt(field, index),
  status: field.status[index],
  reason: field.reason[index],
  clicked,
});
