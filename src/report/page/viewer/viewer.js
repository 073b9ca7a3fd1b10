// The viewer itself: state, camera, and when to draw what.

const FOV = 0.46;
const PRESETS = {
  iso: { azimuth: -0.72, elevation: 0.5, parallel: false },
  top: { azimuth: -Math.PI / 2, elevation: Math.PI / 2, parallel: true },
  front: { azimuth: -Math.PI / 2, elevation: 0, parallel: true },
  side: { azimuth: 0, elevation: 0, parallel: true },
};
const SUN = unit([0.42, -0.5, 1.15]);
const LOOKS = {
  light: {
    robot: "#ea7317", foot: "#4a525c", tool: "#353b43", held: "#3f8fd2", equipment: "#c3cbd4", obstacle: "#8d959f",
    fence: "#d9a400", "keep-out": "#cf222e", edge: "#1b232d", ground: "#f4f6f8", line: "#7d8894", paper: "#ffffff",
    envelope: "#0969a8", net: "#33404d", ghost: "#7c3aed", shade: 0.34, edgeAlpha: 0.75, lineAlpha: 0.42,
  },
  dark: {
    robot: "#f08a35", foot: "#6a737e", tool: "#3d444d", held: "#58a6ff", equipment: "#87919d", obstacle: "#5d6671",
    fence: "#e3b341", "keep-out": "#ff6b61", edge: "#05080c", ground: "#1b222b", line: "#8b97a5", paper: "#12171d",
    envelope: "#58b0f0", net: "#c2ccd6", ghost: "#b794f6", shade: 0.6, edgeAlpha: 0.85, lineAlpha: 0.30,
  },
};

function supported() {
  try {
    return !!document.createElement("canvas").getContext("webgl2");
  } catch {
    return false;
  }
}

function sweetspotViewer(host, written, options = {}) {
  if (!supported()) return unsupported();
  const root = element("div", { class: "ss-viewer" });
  const stage = element("div", { class: "ss-stage" });
  const canvas = element("canvas", { tabIndex: 0, role: "img" });
  stage.append(canvas);
  root.append(stage);
  for (const old of host.children) old.hidden = true;
  host.append(root);

  const view = {
    model: readModel(written, new Map()), drawing: null, lens: 0, times: 1, scale: { ranges: {} }, theme: "light",
    shifts: new Map(), width: 1, height: 1, optics: null, camera: null, playing: false, floorBounds: [0, 0, 1, 1],
    state: { drawing: 0, operation: null, lens: 0, sense: null, arrows: "resultant", envelope: false,
      solids: "solid", robot: "solid", time: 0, compareTo: null },
  };
  const listeners = new Map();
  const dirty = { data: true, frame: true, queued: false };
  let [gl, card, tip, labels, legend, controls, timeline] = [null];
  let [found, ratio, lastTick, flight, shadowKey, keyPx] = [null, 1, 0, null, "", 0];

  const tell = (event, what) => (listeners.get(event) || []).forEach((f) => f(what));
  const ask = (data) => {
    dirty.data = dirty.data || data;
    dirty.frame = true;
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
    view.times = roundDown(clamp(spacing * 2.4, extent * 0.05, extent * 0.13) / (longestError(model, lens) || 1));
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
    if (state.time !== before.time) tell("time", state.time);
    if (!timeOnly) {
      found = null;
      tell("state", { ...state });
    }
    ask(!timeOnly);
    return api;
  }

  // ---- camera
  function fitted(preset) {
    const { low, high } = view.model;
    const target = times(add(low, high), 0.5);
    const camera = { target, distance: 1, ...PRESETS[preset] };
    const { right, up, back } = axesOf(camera);
    const h = Math.tan(FOV / 2) * 0.9;
    const w = h * (view.width / view.height);
    let far = 1;
    for (let c = 0; c < 8; c++) {
      const p = minus([0, 1, 2].map((a) => ((c >> a) & 1 ? high[a] : low[a])), target);
      const deep = camera.parallel ? 0 : dot(p, back);
      far = Math.max(far, Math.abs(dot(p, right)) / w + deep, Math.abs(dot(p, up)) / h + deep);
    }
    camera.distance = far;
    return camera;
  }

  function axesOf({ azimuth, elevation }) {
    const [c, s, ce, se] = [Math.cos(azimuth), Math.sin(azimuth), Math.cos(elevation), Math.sin(elevation)];
    const back = [ce * c, ce * s, se];
    const right = [-s, c, 0];
    return { right, up: cross(back, right), back };
  }

  function optics() {
    const { camera, model, width, height } = view;
    const { right, up, back } = axesOf(camera);
    const eye = add(camera.target, times(back, camera.distance));
    const radius = size(minus(model.high, model.low)) * 1.3 + 2000;
    const tall = 2 * camera.distance * Math.tan(FOV / 2);
    const reach = size(minus(camera.target, times(add(model.low, model.high), 0.5))) + radius;
    const near = camera.parallel ? camera.distance - 2 * reach : Math.max(camera.distance - reach, camera.distance * 0.02, 10);
    const far = camera.distance + 2 * reach;
    const project = camera.parallel ? parallel((tall * width) / height, tall, near, far) : perspective(FOV, width / height, near, far);
    const perMm = camera.parallel ? height / tall : height / 2 / Math.tan(FOV / 2);
    return { eye, right, up, back, camera: product(project, lookFrom(eye, right, up, back)), perMm,
      pxPerMm: height / tall, towards: camera.parallel ? back : eye };
  }

  function project(x, y, z) {
    const p = projected(view.optics.camera, [x, y, z]);
    return { x: (p[0] / p[3] + 1) * 0.5 * view.width, y: (1 - p[1] / p[3]) * 0.5 * view.height, visible: p[3] > 0, depth: p[3] };
  }

  /** Start and direction of the line of sight through a place in the picture. */
  function sight(px, py) {
    const { right, up, back, eye, pxPerMm } = view.optics;
    const across = add(times(right, (px - view.width / 2) / pxPerMm), times(up, (view.height / 2 - py) / pxPerMm));
    if (view.camera.parallel) return { from: add(eye, across), along: times(back, -1) };
    return { from: eye, along: unit(minus(across, times(back, view.camera.distance))) };
  }

  function pickFloor(px, py, z = view.drawing.floor_mm) {
    const { from, along } = sight(px, py);
    const far = (z - from[2]) / along[2];
    return far > 0 && isFinite(far) ? { x: from[0] + far * along[0], y: from[1] + far * along[1], z } : null;
  }

  /** The equipment (not an obstacle unless asked) under a place in the picture, by the boxes round its parts. */
  function pickEquipment(px, py, obstacles = false) {
    const { from, along } = sight(px, py);
    let best = null;
    for (const part of view.drawing.parts) {
      if (part.equipment === null || (part.kind !== "equipment" && !obstacles)) continue;
      const back = inverse(poseOf(part));
      const far = boxHit(part.mesh, moved(back, from), turned(back, along));
      if (far !== null && (!best || far < best.far)) best = { equipment: part.equipment, far };
    }
    return best ? { equipment: best.equipment, at: add(from, times(along, best.far)) } : null;
  }

  function setCamera(wanted, quietly) {
    flight = null;
    view.camera = { ...view.camera, ...wanted };
    view.camera.elevation = clamp(view.camera.elevation, -0.25, Math.PI / 2);
    if (!quietly) tell("camera", { ...view.camera, target: [...view.camera.target] });
    ask(false);
  }

  view.project = project;
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
    const goal = fitted(name === "reset" ? "iso" : name);
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
    if (!clicked && !next === !found && (!next || (next.k === found.k && next.field === found.field))) return;
    found = next;
    showTip(tip, view, found);
    const what = found && { operation: found.field.operation, index: found.k, node: found.field.nodes[found.k],
      position: nodeAt(found.field, found.k), status: found.field.status[found.k], reason: found.field.reason[found.k], clicked: !!clicked };
    tell("pick", what);
  };

  // ---- where parts are
  function poseOf(part) {
    if (part.at) {
      const shift = view.shifts.get(part.equipment);
      return shift ? product(shift, part.at) : part.at;
    }
    return (view.frames && view.frames[part.link]) || view.drawing.base;
  }
  view.poseOf = poseOf;

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
    shadowKey = "";
    ask(true);
  }

  // ---- the graphics card
  function setUp() {
    gl = canvasContext(canvas);
    card = makeCard(gl);
    for (const mesh of view.model.meshes) mesh.card = null;
    card.batches = {};
    shadowKey = "";
  }

  function onCard(mesh) {
    if (!mesh.card) mesh.card = uploadMesh(card, mesh);
    return mesh.card;
  }

  function fill() {
    const b = card.batches;
    const lines = (name, data) => (b[name] = uploadLines(card, b[name], data));
    b.glyphs = uploadGlyphs(card, b.glyphs, glyphInstances(view));
    b.spots = uploadGlyphs(card, b.spots, spotInstances(view));
    b.arrows = uploadArrows(card, b.arrows, arrowInstances(view));
    lines("net", netInstances(view));
    lines("pins", pinInstances(view));
    const { envelopes } = view.drawing;
    const rings = envelopes[view.state.operation ?? 0];
    const drawn = view.state.envelope && rings;
    const works = view.state.operation === null ? envelopes.flatMap((e) => e.atWork) : rings ? rings.atWork : [];
    lines("atWork", ringInstances(drawn ? works : []));
    lines("around", ringInstances(drawn ? rings.around : []));
  }

  function partsNow() {
    const held = heldAt(view.drawing.movement, view.state.time);
    return view.drawing.parts.filter((p) => p.operation === null || p.operation === held);
  }

  const isRobots = (part) => ["robot", "tool", "held"].includes(part.kind);
  const isSpace = (part) => part.kind === "fence" || part.kind === "keep-out";
  const seenAs = (part) => (isSpace(part) ? "space" : view.state[isRobots(part) ? "robot" : "solids"]);

  function drawShadow(parts) {
    const key = JSON.stringify([view.state.time, view.state.drawing, view.state.robot, view.state.solids]);
    const { low, high } = view.model;
    const middle = times(add(low, high), 0.5);
    const radius = size(minus(high, low)) * 0.62;
    const right = unit(cross([0, 0, 1], SUN));
    const look = lookFrom(add(middle, times(SUN, 2 * radius)), right, cross(SUN, right), SUN);
    view.shadowCamera = product(parallel(2 * radius, 2 * radius, radius * 0.5, radius * 3.5), look);
    if (key === shadowKey) return;
    shadowKey = key;
    gl.bindFramebuffer(gl.FRAMEBUFFER, card.shadow.target);
    gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(2, 4);
    for (const part of parts) {
      if (seenAs(part) !== "solid") continue;
      drawMesh(card, "shadow", onCard(part.mesh), { model: poseOf(part), camera: view.shadowCamera, grow: 0, viewport: [1, 1] });
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  function colourOf(part) {
    const looks = LOOKS[view.theme];
    return hex(part.kind === "robot" && part.link === 0 ? looks.foot : looks[part.kind] || looks.equipment);
  }

  function draw() {
    view.frames = framesAt(view.drawing.movement, view.state.time);
    view.optics = optics();
    const looks = LOOKS[view.theme];
    const [w, h] = [canvas.width, canvas.height];
    const o = view.optics;
    const parts = partsNow();
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
    gl.colorMask(true, true, true, true);
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.BLEND);
    gl.bindTexture(gl.TEXTURE_2D, null);
    drawShadow(parts);
    gl.bindTexture(gl.TEXTURE_2D, card.shadow.map);
    gl.viewport(0, 0, w, h);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const shared = { camera: o.camera, viewport: [w, h], shadowMap: 0, shadowCamera: view.shadowCamera, sun: SUN,
      eye: o.towards, parallelView: view.camera.parallel ? 1 : 0, perMm: o.perMm * ratio, model: UNMOVED,
      paper: hex(looks.paper), grow: 0, flatly: 0 };
    const solid = parts.filter((p) => seenAs(p) === "solid");
    for (const part of solid) drawSolid(part, shared, 1);
    for (const part of solid) drawEdges(part, shared, 1);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    drawFloor(card, { ...shared, bounds: view.floorBounds, height: view.drawing.floor_mm, dark: looks.shade,
      line: [...hex(looks.line), looks.lineAlpha], ground: [...hex(looks.ground), 0.9] });
    gl.depthMask(true);
    drawMap(shared, looks);
    for (const part of parts) if (seenAs(part) === "clear") drawGlass(part, shared, 0.22);
    for (const part of parts) if (isSpace(part)) drawGlass(part, shared, part.kind === "fence" ? 0.16 : 0.13);
    drawGhost(shared, looks);
    drawSigns(shared, looks);
    drawOver();
  }

  function drawSolid(part, shared, alpha) {
    const values = { ...shared, model: poseOf(part), colour: [...colourOf(part), alpha] };
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    drawMesh(card, "solid", onCard(part.mesh), values);
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  /** Creases as lines, outlines as the back of a slightly larger solid. */
  function drawEdges(part, shared, strength) {
    const looks = LOOKS[view.theme];
    const colour = [...hex(looks.edge), looks.edgeAlpha * strength];
    const model = poseOf(part);
    gl.enable(gl.CULL_FACE);
    gl.cullFace(gl.FRONT);
    if (strength === 1) drawMesh(card, "solid", onCard(part.mesh), { ...shared, model, colour: [...mixed(looks.edge, looks.paper, 0.25), 1], flatly: 1, grow: 0.9 * ratio });
    gl.disable(gl.CULL_FACE);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    drawInstances(card, "line", onCard(part.mesh).edges, { ...shared, model, colour, width: 1.1 * ratio, pull: 0.0003 });
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  /** Only what is nearest of a solid that one sees through. */
  function drawGlass(part, shared, alpha) {
    gl.disable(gl.BLEND);
    gl.colorMask(false, false, false, false);
    drawSolid(part, shared, 1);
    gl.colorMask(true, true, true, true);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    drawSolid(part, shared, alpha);
    drawEdges(part, shared, 0.45);
    gl.enable(gl.BLEND);
  }

  function drawMap(shared, looks) {
    const b = card.batches;
    gl.disable(gl.BLEND);
    gl.disable(gl.CULL_FACE);
    const radius = clamp(view.spacing * 0.045, 2, 14);
    drawInstances(card, "arrow", b.arrows, { ...shared, radius, halo: [0, 0, 0, 0] });
    gl.enable(gl.CULL_FACE);
    gl.cullFace(gl.FRONT);
    drawInstances(card, "arrow", b.arrows, { ...shared, radius, halo: [...hex(looks.paper), 1], grow: 0.9 * ratio });
    gl.disable(gl.CULL_FACE);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    drawInstances(card, "line", b.net, { ...shared, colour: [...hex(looks.net), 0.2], width: ratio, pull: 0.0002 });
    drawInstances(card, "line", b.around, { ...shared, colour: [...hex(looks.envelope), 0.42], width: 1.1 * ratio, pull: 0.0002 });
    drawInstances(card, "line", b.atWork, { ...shared, colour: [...hex(looks.envelope), 1], width: 2.4 * ratio, pull: 0.0004 });
    gl.depthMask(true);
  }

  /** Where the equipment of the layout compared with stands: its edges alone. */
  function drawGhost(shared, looks) {
    const { other } = view.scale;
    if (!other) return;
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    for (const part of other.parts) {
      if (part.kind !== "equipment") continue;
      drawInstances(card, "line", onCard(part.mesh).edges, { ...shared, model: part.at, colour: [...hex(looks.ghost), 0.8], width: 1.4 * ratio, pull: 0.0003 });
    }
    gl.depthMask(true);
  }

  function drawSigns(shared, looks) {
    const b = card.batches;
    const { right, back, up } = view.optics;
    // Signs lie on the surface; seen flatter than 35 degrees they rise.
    const rise = Math.max(0, 0.61 - Math.abs(view.camera.elevation));
    const ahead = unit(cross([0, 0, 1], right));
    const upwards = add(times(ahead, Math.cos(rise)), [0, 0, Math.sin(rise)]);
    const values = { ...shared, across: right, upwards: view.camera.elevation < 0 ? up : upwards, radius: view.spacing * 0.15,
      least: 2.6 * ratio, most: 6.5 * ratio, pull: 0.0012, fade: 1, back };
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    drawInstances(card, "glyph", b.glyphs, values);
    drawInstances(card, "line", b.pins, { ...shared, colour: [...SPOT[view.theme], 0.9], width: 1.6 * ratio, pull: 0.0006 });
    // What stands before a sign dims it.
    gl.depthFunc(gl.GREATER);
    drawInstances(card, "glyph", b.glyphs, { ...values, fade: 0.16 });
    gl.depthFunc(gl.ALWAYS);
    drawInstances(card, "glyph", b.spots, { ...values, least: 4.2 * ratio, fade: 1 });
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
  }

  /** Labels and the tip, over the picture. */
  function drawOver() {
    const points = [];
    for (const field of shownFields(view.drawing, view.state.operation)) {
      const step = Math.ceil(field.count / 600);
      for (let k = 0; k < field.count; k += step) {
        const p = project(...placeOf(view, field, nodeAt(field, k)));
        points.push([p.x, p.y]);
      }
    }
    const names = arrange(labels, labelBoxes(view), points, view.width, view.height);
    showLabels(labels, [...floorNumbers(view), ...axisLabels(), ...names]);
    if (found) {
      const p = project(...placeOf(view, found.field, nodeAt(found.field, found.k)));
      showTip(tip, view, Object.assign(found, { x: p.x, y: p.y }));
    } else tip.hidden = true;
  }

  /** The world axes in the corner, as a drawing of their directions. */
  function axisLabels() {
    const { right, up } = view.optics;
    const [x, y] = [38, view.height - 40];
    const ends = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((a) => [x + 26 * dot(a, right), y - 26 * dot(a, up)]);
    triad.forEach((line, k) => {
      line.setAttribute("x1", x);
      line.setAttribute("y1", y);
      line.setAttribute("x2", ends[k][0].toFixed(1));
      line.setAttribute("y2", ends[k][1].toFixed(1));
    });
    return ends.map(([ex, ey], k) => ({ text: "xyz"[k], kind: `axis ss-axis-${"xyz"[k]}`, x: x + (ex - x) * 1.32 - 4, y: y + (ey - y) * 1.32 - 8 }));
  }
  const triad = ["x", "y", "z"].map((name) => drawn("line", { class: `ss-${name}` }));
  stage.append(drawn("svg", { class: "ss-triad", "aria-hidden": "true" }, ...triad));

  // ---- when
  function tick(now) {
    dirty.queued = false;
    if (view.playing) {
      const { times_s: moments } = view.drawing.movement;
      const end = moments[moments.length - 1];
      view.state.time = Math.min(view.state.time + Math.min((now - lastTick) / 1000, 0.2), end);
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

  function render() {
    if (!card || gl.isContextLost() || view.width < 2 || view.height < 2) return;
    const data = dirty.data;
    [dirty.data, dirty.frame] = [false, false];
    if (data) fill();
    draw();
    if (data || Math.abs(keyPx - view.optics.pxPerMm) > 1e-9) {
      keyPx = view.optics.pxPerMm;
      showLegend(legend, view);
    }
    if (controls && data) showControls(controls, view);
    if (timeline) showTimeline(timeline, view, show);
    if (data) canvas.setAttribute("aria-label", `Three-dimensional view of ${view.drawing.cell}, layout ${view.drawing.name}: robot, equipment and error map. Arrow keys turn it.`);
  }

  function resize() {
    const box = stage.getBoundingClientRect();
    ratio = Math.min(devicePixelRatio || 1, 3);
    const [w, h] = [Math.round(box.width), Math.round(box.height)];
    if (w < 2 || h < 2) return;
    const first = view.width < 2;
    const shape = view.width / view.height;
    [view.width, view.height] = [w, h];
    [canvas.width, canvas.height] = [Math.round(w * ratio), Math.round(h * ratio)];
    if (first) view.camera = fitted("iso");
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
    const play = view.playing;
    view.model = readModel(next, known);
    const kept = new Set(view.model.meshes);
    for (const mesh of known.values()) if (!kept.has(mesh) && mesh.card) dropMesh(card, mesh.card);
    view.shifts.clear();
    [found, shadowKey] = [null, ""];
    settle();
    const end = view.drawing.movement.times_s.at(-1) || 0;
    view.state.time = play ? Math.min(view.state.time, end) : timeOf(view.drawing, view.state.operation);
    ask(true);
    return api;
  }

  const api = {
    show, replace, movePart, pickFloor, pickEquipment, setCamera, canvas,
    state: () => ({ ...view.state }),
    camera: () => ({ ...view.camera, target: [...view.camera.target] }),
    on: (event, f) => {
      listeners.set(event, [...(listeners.get(event) || []), f]);
      return api;
    },
    project: (x, y, z) => project(x, y, z),
    look: (name) => view.look(name),
    play: (on = true) => view.play(on),
    supported: () => true,
    linked: (camera) => setCamera(camera, true),
  };

  tip = makeTip(stage);
  labels = makeLabels(stage);
  legend = makeLegend(root);
  settle();
  view.state.time = timeOf(view.drawing, null);
  if (options.controls !== false) {
    controls = makeControls(view, root, show);
    timeline = makeTimeline(view, root, show);
    stage.after(timeline.box);
  }
  setUp();
  makeHand(view, canvas, options);
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => {
    setUp();
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

const mixed = (a, b, t) => hex(a).map((v, k) => mix(v, hex(b)[k], t));

function dropMesh(card, made) {
  card.gl.deleteVertexArray(made.array);
  card.gl.deleteVertexArray(made.shade);
}

/** How far along a line a box is met; null: not. */
function boxHit({ low, high }, from, along) {
  let [enter, leave] = [-Infinity, Infinity];
  for (let k = 0; k < 3; k++) {
    const [a, b] = [(low[k] - from[k]) / along[k], (high[k] - from[k]) / along[k]];
    if (isNaN(a) || isNaN(b)) continue;
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter <= leave && leave > 0 ? Math.max(enter, 0) : null;
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
