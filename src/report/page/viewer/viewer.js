// The viewer: state, camera, and when to draw what.

/** Duration of a movement of the camera, ms. */
const FLIGHT = 320;

/** Time between two pictures above which drawing counts as slow, and as interrupted, ms. */
const SLOW = 60;
const INTERRUPTED = 400;

/** Resolution of the canvas while drawing is slow and things move. */
const COARSE = 0.55;

/** Angle of the camera per pixel of a drag, rad. */
const TURN = 0.008;

/** Returns whether the browser offers WebGL 2. */
function isSupported() {
  try {
    return Boolean(document.createElement("canvas").getContext("webgl2"));
  } catch {
    return false;
  }
}

/** @param {DrawingDocument} written @param {Graphics} graphics @returns {View} */
function initialView(written, graphics) {
  const model = readModel(written, new Map());
  const size = { width: 1, height: 1 };
  const camera = fittedCamera({ model, ...size }, "iso");
  return {
    model,
    drawing: model.drawings[0],
    state: {
      drawing: 0,
      operation: null,
      lens: 0,
      sense: null,
      arrows: "resultant",
      envelope: false,
      solids: "solid",
      robot: "solid",
      time: 0,
      compareTo: null,
    },
    lens: 0,
    scale: { ranges: {}, comparison: null },
    magnification: 1,
    spacing: 100,
    floorBounds: [0, 0, 1, 1],
    theme: "light",
    shifts: new Map(),
    frames: [],
    camera,
    optics: opticsOf({ camera, model, ...size }),
    ...size,
    ratio: 1,
    playing: false,
    picked: null,
    graphics,
    shadowKey: "",
    shadowCamera: IDENTITY,
  };
}

/**
 * Shows a document (sweetspot/drawing/1) in a host element. `ViewerState` lists what can be shown,
 * `ViewerEvents` the events. The CSS variable --ss-height sets the height of the picture.
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
    this.stage = element("div", { class: "ss-stage" }, canvas);
    this.root = element("div", { class: "ss-viewer" }, this.stage);
    this.view = initialView(written, graphics);
    /** @type {{ [Name in keyof ViewerEvents]: ((told: ViewerEvents[Name]) => void)[] }} */
    this.listeners = { camera: [], pick: [], time: [], state: [] };
    /** Whether the data shown have changed since the last picture, and whether a picture is queued. */
    this.dirty = { data: true, queued: false };
    /** Movement of the camera. @type {{ from: Camera, goal: Camera, start: number } | null} */
    this.flight = null;
    /** Whether the picture has a size yet. */
    this.isSized = false;
    /** Time of the last picture and count of slow pictures. */
    this.pace = { last: 0, slow: 0, coarse: 1, timer: 0 };
    this.lastTick = 0;
    this.legendScale = 0;
    this.hintTimer = 0;
    // The content of the host stays for print and for browsers without WebGL.
    for (const child of host.children) if (child instanceof HTMLElement) child.hidden = true;
    host.append(this.root);
    this.tip = makeTip(this.stage);
    this.labels = makeLabels(this.stage);
    this.legend = makeLegend(this.root);
    this.hintBox = element("div", { class: "ss-hint" });
    this.stage.append(this.hintBox);
    settle(this.view);
    this.view.state.time = timeOf(this.view.drawing, null);
    if (options.controls !== false) this.addControls();
    this.listen(options);
    this.show({ ...options, operation: options.operation ?? null });
    this.resize();
    this.setTheme(false);
  }

  addControls() {
    const show = (/** @type {Partial<ViewerState>} */ wanted) => this.show(wanted);
    this.controls = makeControls(this.view, this.root, show, (name) => this.look(name));
    this.timeline = makeTimeline(this.view, (on) => this.play(on), show);
    this.stage.after(this.timeline.box);
  }

  /** @param {ViewerOptions} options */
  listen(options) {
    listenToPointer(this, this.canvas, options);
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => this.restoreGraphics());
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.setTheme(false));
    addEventListener("beforeprint", () => this.setTheme(true));
    addEventListener("afterprint", () => this.setTheme(false));
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  supported() {
    return true;
  }

  /** @template {keyof ViewerEvents} Name @param {Name} event @param {ViewerEvents[Name]} what */
  tell(event, what) {
    for (const listener of this.listeners[event]) listener(what);
  }

  /** @template {keyof ViewerEvents} Name @param {Name} event @param {(told: ViewerEvents[Name]) => void} listener */
  on(event, listener) {
    this.listeners[event].push(listener);
    return this;
  }

  state() {
    return { ...this.view.state };
  }

  // ---- What is shown.

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
      // The same reading and model of the other layout, wherever its list has them.
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
    this.requestPicture(!isTimeOnly);
    return this;
  }

  /** Shows another document of the same cell. @param {DrawingDocument} written */
  replace(written) {
    const { view } = this;
    const { time } = view.state;
    const isAt = (/** @type {StopRecord} */ stop) => time >= stop.time_s && time <= stop.time_s + 0.65;
    const halt = view.drawing.movement.stops.find(isAt);
    const old = view.model.meshes;
    view.model = readModel(written, new Map(old.map((mesh) => [mesh.key, mesh])));
    const kept = new Set(view.model.meshes);
    for (const mesh of old) if (!kept.has(mesh) && mesh.buffers) dropMesh(view.graphics, mesh.buffers);
    view.shifts.clear();
    view.picked = null;
    view.shadowKey = "";
    settle(view);
    view.state.time = halt ? this.timeAtStop(halt, time) : Math.min(time, durationOf(view.drawing.movement));
    this.requestPicture(true);
    return this;
  }

  /** Returns the time at which the robot rests at a stop of the document before. @param {StopRecord} halt @param {number} time */
  timeAtStop(halt, time) {
    const { movement } = this.view.drawing;
    const isSame = (/** @type {StopRecord} */ stop) =>
      stop.operation === halt.operation && (halt.operation !== null || stop.time_s >= halt.time_s);
    const stop = movement.stops.find(isSame);
    return stop ? stop.time_s + time - halt.time_s : Math.min(time, durationOf(movement));
  }

  /** Moves equipment and what it carries, until the next document. @param {number} index @param {PlacementNumbers} placement */
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
    this.requestPicture(true);
  }

  // ---- The camera.

  camera() {
    const { camera } = this.view;
    return { ...camera, target: [...camera.target] };
  }

  /** @param {Partial<Camera>} wanted */
  setCamera(wanted) {
    this.linked(wanted);
    this.tell("camera", this.camera());
  }

  /** Takes over a camera without an event. @param {Partial<Camera>} wanted */
  linked(wanted) {
    this.flight = null;
    const camera = { ...this.view.camera, ...wanted };
    this.view.camera = { ...camera, elevation: clamp(camera.elevation, -0.25, Math.PI / 2) };
    this.requestPicture(false);
  }

  /** Turns the camera by a drag. @param {number} dx px @param {number} dy px */
  turn(dx, dy) {
    const { azimuth, elevation } = this.view.camera;
    this.setCamera({ azimuth: azimuth - dx * TURN, elevation: elevation + dy * TURN });
  }

  /** Shifts the picture by a drag. @param {number} dx px @param {number} dy px */
  shift(dx, dy) {
    const { right, up, pixelsPerMm } = this.view.optics;
    const offset = add(scaled(right, -dx / pixelsPerMm), scaled(up, dy / pixelsPerMm));
    this.setCamera({ target: add(this.view.camera.target, offset) });
  }

  /** Changes the distance; the point of the cell at a place in the picture stays there. @param {number} factor @param {number[]} [at] px */
  zoom(factor, at) {
    const { camera, model, optics, width, height } = this.view;
    const span = norm(subtract(model.high, model.low));
    const distance = clamp(camera.distance * factor, span * 0.08, span * 12);
    const [dx, dy] = at ? [at[0] - width / 2, height / 2 - at[1]] : [0, 0];
    const across = add(
      scaled(optics.right, dx / optics.pixelsPerMm),
      scaled(optics.up, dy / optics.pixelsPerMm),
    );
    const towards = scaled(across, 1 - distance / camera.distance);
    this.setCamera({ distance, target: add(camera.target, towards) });
  }

  /** Flies to a view. @param {ViewName | "reset"} name */
  look(name) {
    if (!this.isSized) return;
    const { camera } = this.view;
    const goal = fittedCamera(this.view, name === "reset" ? "iso" : name);
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (isStill || goal.parallel !== camera.parallel) {
      this.setCamera(goal);
      return;
    }
    // The shorter way round.
    const turn = 2 * Math.PI;
    const difference = camera.azimuth - goal.azimuth;
    const azimuth = goal.azimuth + difference - turn * Math.round(difference / turn);
    this.flight = { from: { ...camera, azimuth }, goal, start: performance.now() };
    this.requestPicture(false);
  }

  /** @param {number} x @param {number} y @param {number} z */
  project(x, y, z) {
    return this.isSized ? seenAt(this.view, [x, y, z]) : null;
  }

  /** @param {number} x @param {number} y @param {number} [height] */
  pickFloor(x, y, height = this.view.drawing.floor_mm) {
    return this.isSized ? floorUnder(this.view, x, y, height) : null;
  }

  /** @param {number} x @param {number} y @param {boolean} [obstacles] */
  pickEquipment(x, y, obstacles = false) {
    return this.isSized ? equipmentUnder(this.view, x, y, obstacles) : null;
  }

  /** Picks the node under the pointer. @param {number[] | null} at px @param {number} radius px @param {boolean} [clicked] */
  hover(at, radius, clicked = false) {
    const { view } = this;
    const next = at && nodeNear(view, at, radius);
    const isSame = next?.field === view.picked?.field && next?.index === view.picked?.index;
    if (isSame && !clicked) return;
    view.picked = next;
    showTip(this.tip, view);
    this.tell("pick", next && pickEvent(next, clicked));
  }

  /** Shows a hint for a while. @param {string} text */
  hint(text) {
    this.hintBox.textContent = text;
    this.hintBox.classList.add("ss-seen");
    clearTimeout(this.hintTimer);
    this.hintTimer = setTimeout(() => this.hintBox.classList.remove("ss-seen"), 1600);
  }

  /** Plays or stops the movement of the robot. @param {boolean} [on] */
  play(on = true) {
    const { view } = this;
    if (on === view.playing) return;
    const duration = durationOf(view.drawing.movement);
    view.playing = on && view.drawing.movement.times_s.length > 1;
    if (on && view.state.time >= duration - 0.01) view.state.time = 0;
    this.lastTick = performance.now();
    this.requestPicture(false);
  }

  // ---- When to draw.

  /** Asks for a picture. @param {boolean} data whether what the buffers show has changed */
  requestPicture(data) {
    this.dirty.data ||= data;
    if (this.dirty.queued) return;
    this.dirty.queued = true;
    requestAnimationFrame((now) => this.tick(now));
  }

  /** @param {number} now ms */
  tick(now) {
    this.dirty.queued = false;
    this.keepPace(now);
    if (this.view.playing) this.advanceTime(now);
    if (this.flight) this.advanceFlight(this.flight, now);
    this.render();
    if (this.view.playing || this.flight) this.requestPicture(false);
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

  /** @param {{ from: Camera, goal: Camera, start: number }} flight @param {number} now ms */
  advanceFlight(flight, now) {
    const { from, goal, start } = flight;
    const linear = clamp((now - start) / FLIGHT, 0, 1);
    const share = linear * linear * (3 - 2 * linear);
    this.setCamera({
      parallel: goal.parallel,
      target: add(scaled(from.target, 1 - share), scaled(goal.target, share)),
      distance: mix(from.distance, goal.distance, share),
      azimuth: mix(from.azimuth, goal.azimuth, share),
      elevation: mix(from.elevation, goal.elevation, share),
    });
    this.flight = linear < 1 ? flight : null;
  }

  /** Draws coarsely where drawing is slow (no graphics card) while things move, and finely at rest. @param {number} now ms */
  keepPace(now) {
    const { pace } = this;
    const gap = now - pace.last;
    pace.last = now;
    if (gap <= INTERRUPTED) pace.slow = clamp(pace.slow + (gap > SLOW ? 1 : -1), 0, 4);
    if (pace.slow < 3 && pace.coarse === 1) return;
    this.fitCanvas(pace.slow < 1 ? 1 : COARSE);
    clearTimeout(pace.timer);
    pace.timer = setTimeout(() => {
      pace.slow = 2;
      this.fitCanvas(1);
      this.render();
    }, 260);
  }

  /** Sets the resolution of the canvas. @param {number} coarse share of the full resolution */
  fitCanvas(coarse) {
    const { view, canvas } = this;
    this.pace.coarse = coarse;
    view.ratio = Math.min(devicePixelRatio || 1, 3) * coarse;
    const [width, height] = [Math.round(view.width * view.ratio), Math.round(view.height * view.ratio)];
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
  }

  render() {
    const { view, dirty, canvas } = this;
    if (!this.isSized || view.graphics.gl.isContextLost()) return;
    const { data } = dirty;
    dirty.data = false;
    view.frames = framesAt(view.drawing.movement, view.state.time);
    view.optics = opticsOf(view);
    if (data) fillBatches(view);
    drawPicture(view, canvas.width, canvas.height);
    drawLabels(view, this.labels);
    showTip(this.tip, view);
    if (data || Math.abs(this.legendScale - view.optics.pixelsPerMm) > 1e-9) {
      this.legendScale = view.optics.pixelsPerMm;
      showLegend(this.legend, view);
    }
    if (this.controls && data) showControls(this.controls, view);
    if (this.timeline) showTimeline(this.timeline, view);
    if (data) this.describe();
  }

  /** Describes the picture for who does not see it. */
  describe() {
    const { cell, name } = this.view.drawing;
    const what = `Three-dimensional view of ${cell}, layout ${name}: robot, equipment and error map.`;
    this.canvas.setAttribute("aria-label", `${what} Arrow keys turn it.`);
  }

  resize() {
    const { view } = this;
    const box = this.stage.getBoundingClientRect();
    const [width, height] = [Math.round(box.width), Math.round(box.height)];
    if (width < 2 || height < 2) return;
    const before = view.width / view.height;
    view.width = width;
    view.height = height;
    this.fitCanvas(1);
    if (!this.isSized) view.camera = fittedCamera(view, "iso");
    // A narrower picture keeps the width of the cell.
    else if (width / height < before && before < 1.2) view.camera.distance *= before / (width / height);
    this.isSized = true;
    this.dirty.data = true;
    this.render();
  }

  /** Takes the colours of the page. @param {boolean} printing */
  setTheme(printing) {
    const dark = getComputedStyle(this.root).getPropertyValue("--ss-dark").trim() === "1";
    this.view.theme = dark && !printing ? "dark" : "light";
    this.dirty.data = true;
    this.render();
  }

  /** Makes everything on the graphics card anew after the loss of the context. */
  restoreGraphics() {
    const { view } = this;
    view.graphics = makeGraphics(view.graphics.gl);
    for (const mesh of view.model.meshes) mesh.buffers = null;
    view.shadowKey = "";
    this.requestPicture(true);
  }
}

/** @param {NodeReference} node @param {boolean} clicked @returns {PickEvent} */
const pickEvent = ({ field, index }, clicked) => ({
  operation: field.operation,
  index,
  node: field.nodes[index],
  position: nodeAt(field, index),
  status: field.status[index],
  reason: field.reason[index],
  clicked,
});

/** Returns a viewer for a browser without WebGL: it shows nothing, and the page keeps its content. @returns {SweetspotViewer} */
function unsupportedViewer() {
  /** @type {SweetspotViewer} */
  const viewer = {
    canvas: null,
    supported: () => false,
    show: () => viewer,
    replace: () => viewer,
    movePart: () => undefined,
    setCamera: () => undefined,
    linked: () => undefined,
    state: () => ({}),
    camera: () => ({}),
    on: () => viewer,
    project: () => null,
    pickFloor: () => null,
    pickEquipment: () => null,
    look: () => undefined,
    play: () => undefined,
  };
  return viewer;
}

/**
 * Shows a document in a host element. Without WebGL the host keeps its content.
 * @param {HTMLElement} host
 * @param {DrawingDocument} written
 * @param {ViewerOptions} [options]
 * @returns {SweetspotViewer}
 */
function makeViewer(host, written, options = {}) {
  if (!isSupported()) return unsupportedViewer();
  const canvas = element("canvas", { tabIndex: 0, role: "img" });
  let graphics;
  try {
    graphics = makeGraphics(contextOf(canvas));
  } catch (error) {
    console.warn(error);
    return unsupportedViewer();
  }
  return new Viewer(host, written, options, canvas, graphics);
}

/** Makes several viewers share one camera. @param {SweetspotViewer[]} viewers */
function linkViewers(viewers) {
  for (const viewer of viewers) {
    viewer.on("camera", (camera) => {
      for (const other of viewers) if (other !== viewer) other.linked(camera);
    });
  }
}

globalThis.sweetspotViewer = Object.assign(makeViewer, {
  supported: isSupported,
  link: linkViewers,
  nodeSigns: NODE_SIGNS,
  marks: MARKS,
});
