// The viewer itself: state, camera, and when to draw what.

function supported() {
  try {
    return !!document.createElement("canvas").getContext("webgl2");
  } catch {
    return false;
  }
}

/**
 * Shows a document (sweetspot/drawing/1) in a host element, whose own content stays where there is no WebGL.
 *
 * Options: every key of the state to begin with; controls: false for the bare picture; wheel: "always" to zoom
 * without a click before. The state: drawing, operation, compareTo (indices; null: all, none), lens (index), sense
 * (name; null: each operation's own), arrows (none, x, y, z, components, resultant), envelope (true, false), robot and
 * solids (solid, clear, none), time (s). Events: camera, pick (node under the pointer, or null), time, state.
 * The height of the picture is the CSS variable --ss-height.
 */
function sweetspotViewer(host, written, options = {}) {
  if (!supported()) return unsupported();
  const root = element("div", { class: "ss-viewer" });
  const stage = element("div", { class: "ss-stage" });
  const canvas = element("canvas", { tabIndex: 0, role: "img" });
  stage.append(canvas);
  root.append(stage);
  const kept = [...host.children].filter((child) => !child.hidden);
  for (const old of kept) old.hidden = true;
  host.append(root);

  const view = {
    model: readModel(written, new Map()), drawing: null, lens: 0, times: 1, scale: { ranges: {} }, theme: "light",
    shifts: new Map(), ratio: 1, coarse: 1, card: null, shadowKey: "", found: null, width: 1, height: 1, optics: null, camera: null, playing: false, floorBounds: [0, 0, 1, 1],
    state: { drawing: 0, operation: null, lens: 0, sense: null, arrows: "resultant", envelope: false,
      solids: "solid", robot: "solid", time: 0, compareTo: null },
  };
  const listeners = new Map();
  const dirty = { data: true, queued: false };
  let [tip, labels, legend, controls, timeline] = [];
  let [lastTick, flight, keyPx, lastFrame, slow, fine] = [0, null, 0, 0, 0, 0];

  const tell = (event, what) => (listeners.get(event) || []).forEach((f) => f(what));
  const ask = (data) => {
    dirty.data = dirty.data || data;
    if (!dirty.queued) {
      dirty.queued = true;
      requestAnimationFrame(tick);
    }
  };

  // ---- state
  function settle() {
    const { model, state } = view;
    state.drawing = clamp(Math.round(state.drawing) || 0, 0, model.drawings.length - 1);
    const d = (view.drawing = model.drawings[state.drawing]);
    if (state.operation !== null && !d.operations[state.operation]) state.operation = null;
    if (state.compareTo !== null && (!model.drawings[state.compareTo] || state.compareTo === state.drawing)) state.compareTo = null;
    view.lens = d.lenses[state.lens] ? state.lens : 0;
    const lens = d.lenses[view.lens];
    const units = new Set(d.fields.map((f) => f.senses[senseIn(f, state.sense)].unit));
    const ranges = {};
    for (const word of units) {
      const range = rangeOf(model, lens, state.sense, word);
      if (range) ranges[word] = range;
    }
    view.scale = { ranges };
    compareScale();
    const extent = size(minus(model.high, model.low));
    const spacing = Math.min(...d.fields.map((f) => f.spacing), extent / 8);
    view.spacing = spacing;
    // Arrows to both sides need more room.
    const far = lens.signed || state.arrows.length === 1 ? 2.4 : state.arrows === "components" ? 1.2 : 2;
    const longest = longestError(model, lens, state.arrows) || 1;
    view.times = roundDown(clamp(spacing * far, extent * 0.02 * far, extent * 0.13) / longest);
    const margin = Math.max(300, extent * 0.1);
    const out = (v, up) => (up ? Math.ceil((v + margin) / 500) : Math.floor((v - margin) / 500)) * 500;
    view.floorBounds = [out(model.low[0]), out(model.low[1]), out(model.high[0], true), out(model.high[1], true)];
  }

  function compareScale() {
    const { state, model, drawing } = view;
    if (state.compareTo === null) return;
    view.scale.other = model.drawings[state.compareTo];
    let most = 0;
    const fields = shownFields(drawing, state.operation);
    for (const f of fields) for (let k = 0; k < f.count; k++) most = Math.max(most, Math.abs(differenceAt(view, f, k) || 0));
    view.scale.most = most || 1;
    view.scale.unit = fields.length ? fields[0].senses[senseIn(fields[0], state.sense)].unit : "";
  }

  function show(wanted) {
    const before = { ...view.state };
    const lensBefore = view.drawing && view.drawing.lenses[view.lens];
    for (const key of Object.keys(view.state)) if (wanted[key] !== undefined) view.state[key] = wanted[key];
    const { state, model } = view;
    const changed = state.drawing !== before.drawing || state.operation !== before.operation;
    if (state.drawing !== before.drawing && wanted.lens === undefined && lensBefore) {
      // The same reading and model of the other layout, wherever they stand in its list.
      state.lens = Math.max(lensIn(model.drawings[clamp(state.drawing, 0, model.drawings.length - 1)], lensBefore), 0);
    }
    const timeOnly = Object.keys(wanted).every((key) => key === "time");
    if (!timeOnly) settle();
    if (changed && wanted.time === undefined && !view.playing) state.time = timeOf(view.drawing, state.operation);
    state.time = clamp(Number(state.time) || 0, 0, view.drawing.movement.times_s.at(-1) || 0);
    if (state.time !== before.time) tell("time", state.time);
    if (!timeOnly) {
      view.found = null;
      tell("state", { ...state });
    }
    ask(!timeOnly);
    return api;
  }

  // ---- camera
  function setCamera(wanted, quietly) {
    if (!view.camera) return;
    flight = null;
    view.camera = { ...view.camera, ...wanted };
    view.camera.elevation = clamp(view.camera.elevation, -0.25, Math.PI / 2);
    if (!quietly) tell("camera", { ...view.camera, target: [...view.camera.target] });
    ask(false);
  }

  view.turn = (dx, dy) => setCamera({ azimuth: view.camera.azimuth - dx * 0.008, elevation: view.camera.elevation + dy * 0.008 });
  view.shift = (dx, dy) => {
    const { right, up, pxPerMm } = view.optics;
    setCamera({ target: add(view.camera.target, add(times(right, -dx / pxPerMm), times(up, dy / pxPerMm))) });
  };
  view.zoom = (factor, at) => {
    const span = size(minus(view.model.high, view.model.low));
    const distance = clamp(view.camera.distance * factor, span * 0.08, span * 12);
    const real = distance / view.camera.distance;
    const { right, up, pxPerMm } = view.optics;
    const [dx, dy] = at ? [at[0] - view.width / 2, view.height / 2 - at[1]] : [0, 0];
    const towards = times(add(times(right, dx / pxPerMm), times(up, dy / pxPerMm)), 1 - real);
    setCamera({ distance, target: add(view.camera.target, towards) });
  };
  view.look = (name) => {
    if (!view.camera) return;
    const goal = fitted(view, name === "reset" ? "iso" : name);
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches || goal.parallel !== view.camera.parallel;
    if (still) return setCamera(goal);
    const whole = 2 * Math.PI;
    const from = { ...view.camera, azimuth: goal.azimuth + ((((view.camera.azimuth - goal.azimuth + Math.PI) % whole) + whole) % whole) - Math.PI };
    flight = { from, goal, start: performance.now() };
    ask(false);
  };
  view.play = (on) => {
    if (on === view.playing) return;
    const { times_s: moments } = view.drawing.movement;
    view.playing = on && moments.length > 1;
    if (on && view.state.time >= moments[moments.length - 1] - 0.01) view.state.time = 0;
    lastTick = performance.now();
    ask(false);
  };
  view.hover = (at, reach, clicked) => {
    const next = at && nodeNear(view, at, reach);
    const now = view.found;
    if (!clicked && !next === !now && (!next || (next.k === now.k && next.field === now.field))) return;
    view.found = next;
    showTip(tip, view);
    tell("pick", next && { operation: next.field.operation, index: next.k, node: next.field.nodes[next.k],
      position: nodeAt(next.field, next.k), status: next.field.status[next.k], reason: next.field.reason[next.k], clicked: !!clicked });
  };
  view.hint = (words) => {
    hint.textContent = words;
    hint.classList.add("ss-seen");
    clearTimeout(view.hinted);
    view.hinted = setTimeout(() => hint.classList.remove("ss-seen"), 1600);
  };

  // ---- where parts are
  view.poseOf = (part) => {
    if (part.at) {
      const shift = view.shifts.get(part.equipment);
      return shift ? product(shift, part.at) : part.at;
    }
    return view.frames[part.link] || view.drawing.base;
  };

  /** An equipment and what stands on it, until the next document. */
  function movePart(index, { x_mm, y_mm, z_mm, yaw_deg }) {
    const equipment = view.drawing.equipment[index];
    if (!equipment || !equipment.at) return;
    const { at } = equipment;
    const yaw = yaw_deg === undefined ? Math.atan2(at[1], at[0]) : (yaw_deg * Math.PI) / 180;
    const goal = upright(x_mm ?? at[12], y_mm ?? at[13], z_mm ?? at[14], yaw);
    const shift = product(goal, inverse(at));
    view.shifts.set(index, shift);
    const carried = (k) => view.drawing.equipment[k].on === index;
    view.drawing.equipment.forEach((e, k) => {
      if (carried(k)) view.shifts.set(k, shift);
    });
    view.shadowKey = "";
    ask(true);
  }

  // ---- when
  function tick(now) {
    dirty.queued = false;
    keepUp(now);
    if (view.playing) {
      const { times_s: moments } = view.drawing.movement;
      const end = moments[moments.length - 1];
      view.state.time = Math.min(view.state.time + Math.min((now - lastTick) / 1000, 0.4), end);
      lastTick = now;
      if (view.state.time >= end) view.playing = false;
      tell("time", view.state.time);
    }
    if (flight) {
      const t = clamp((now - flight.start) / 320, 0, 1);
      const s = t * t * (3 - 2 * t);
      const { from, goal } = flight;
      const next = { ...goal, target: add(times(from.target, 1 - s), times(goal.target, s)) };
      for (const key of ["distance", "azimuth", "elevation"]) next[key] = mix(from[key], goal[key], s);
      const again = t < 1 ? flight : null;
      setCamera(next);
      flight = again;
    }
    render();
    if (view.playing || flight) ask(false);
  }

  /** Where drawing is slow (no graphics card), it is coarser while things move, and fine again at rest. */
  function keepUp(now) {
    const gap = now - lastFrame;
    lastFrame = now;
    slow = gap > 400 ? slow : clamp(slow + (gap > 60 ? 1 : -1), 0, 4);
    if (slow < 3 && view.coarse === 1) return;
    fit(slow < 1 ? 1 : 0.55);
    clearTimeout(fine);
    fine = setTimeout(() => {
      slow = 2;
      fit(1);
      render();
    }, 260);
  }

  function fit(coarse) {
    view.coarse = coarse;
    view.ratio = Math.min(devicePixelRatio || 1, 3) * coarse;
    const [w, h] = [Math.round(view.width * view.ratio), Math.round(view.height * view.ratio)];
    if (canvas.width !== w) canvas.width = w;
    if (canvas.height !== h) canvas.height = h;
  }

  function render() {
    if (!view.camera || view.card.gl.isContextLost()) return;
    const { data } = dirty;
    dirty.data = false;
    view.frames = framesAt(view.drawing.movement, view.state.time);
    view.optics = opticsOf(view);
    if (data) fill(view);
    drawPicture(view, canvas.width, canvas.height);
    drawLabels(view, labels);
    showTip(tip, view);
    if (data || Math.abs(keyPx - view.optics.pxPerMm) > 1e-9) {
      keyPx = view.optics.pxPerMm;
      showLegend(legend, view);
    }
    if (controls && data) showControls(controls, view);
    if (timeline) showTimeline(timeline, view, show);
    if (data) {
      canvas.setAttribute("aria-label", `Three-dimensional view of ${view.drawing.cell}, layout ${view.drawing.name}: robot, equipment and error map. Arrow keys turn it.`);
    }
  }

  function resize() {
    const box = stage.getBoundingClientRect();
    const [w, h] = [Math.round(box.width), Math.round(box.height)];
    if (w < 2 || h < 2) return;
    const first = view.width < 2;
    const shape = view.width / view.height;
    [view.width, view.height] = [w, h];
    fit(1);
    if (first) view.camera = fitted(view, "iso");
    // In a narrower picture the same width of the cell is kept.
    else if (w / h < shape && shape < 1.2) view.camera.distance *= shape / (w / h);
    dirty.data = true;
    render();
  }

  function theme(printing) {
    const dark = getComputedStyle(root).getPropertyValue("--ss-dark").trim() === "1" && !printing;
    view.theme = dark ? "dark" : "light";
    dirty.data = true;
    render();
  }

  function replace(next) {
    const known = new Map(view.model.meshes.map((m) => [m.key, m]));
    const { time } = view.state;
    const halt = view.drawing.movement.stops.find((s) => time >= s.time_s && time <= s.time_s + 0.65);
    view.model = readModel(next, known);
    const kept = new Set(view.model.meshes);
    for (const mesh of known.values()) if (!kept.has(mesh) && mesh.card) dropMesh(view.card, mesh.card);
    view.shifts.clear();
    [view.found, view.shadowKey] = [null, ""];
    settle();
    // A robot that rests at a spot rests at that spot still, wherever it is now.
    const { stops, times_s: moments } = view.drawing.movement;
    const again = halt && stops.find((s) => s.operation === halt.operation && (halt.operation !== null || s.time_s >= halt.time_s));
    view.state.time = again ? again.time_s + time - halt.time_s : Math.min(time, moments.at(-1) || 0);
    ask(true);
    return api;
  }

  const api = {
    show, replace, movePart, setCamera, canvas,
    pickFloor: (px, py, z = view.drawing.floor_mm) => view.optics && floorUnder(view, px, py, z),
    pickEquipment: (px, py, obstacles = false) => view.optics && equipmentUnder(view, px, py, obstacles),
    state: () => ({ ...view.state }),
    camera: () => ({ ...view.camera, target: [...view.camera.target] }),
    on: (event, f) => {
      listeners.set(event, [...(listeners.get(event) || []), f]);
      return api;
    },
    project: (x, y, z) => view.optics && seenAt(view, [x, y, z]),
    look: (name) => view.look(name),
    play: (on = true) => view.play(on),
    supported: () => true,
    linked: (camera) => setCamera(camera, true),
  };

  tip = makeTip(stage);
  labels = makeLabels(stage);
  legend = makeLegend(root);
  const hint = element("div", { class: "ss-hint" });
  stage.append(hint);
  settle();
  view.state.time = timeOf(view.drawing, null);
  if (options.controls !== false) {
    controls = makeControls(view, root, show);
    timeline = makeTimeline(view, root, show);
    stage.after(timeline.box);
  }
  try {
    setUpCard(view, canvas);
  } catch (fault) {
    console.warn(fault);
    root.remove();
    for (const old of kept) old.hidden = false;
    return unsupported();
  }
  makeHand(view, canvas, options);
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => {
    setUpCard(view, canvas);
    ask(true);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => theme(false));
  addEventListener("beforeprint", () => theme(true));
  addEventListener("afterprint", () => theme(false));
  new ResizeObserver(resize).observe(stage);
  show({ ...options, operation: options.operation ?? null });
  resize();
  theme(false);
  return api;
}

/** Without WebGL the page keeps what it shows instead. */
function unsupported() {
  const api = { supported: () => false, state: () => ({}), camera: () => ({}), project: () => null, pickFloor: () => null, pickEquipment: () => null };
  for (const name of ["show", "replace", "movePart", "setCamera", "look", "play", "linked", "on"]) api[name] = () => api;
  return api;
}

/** Cameras of several viewers as one. */
sweetspotViewer.link = (viewers) => {
  for (const viewer of viewers) {
    viewer.on("camera", (camera) => viewers.forEach((other) => other !== viewer && other.linked(camera)));
  }
};
sweetspotViewer.supported = supported;
globalThis.sweetspotViewer = sweetspotViewer;
