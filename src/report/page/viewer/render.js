// One picture: what is filled into buffers when the state changes, and what is drawn every time.

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
    envelope: "#58b0f0", net: "#c2ccd6", ghost: "#b794f6", shade: 0.45, edgeAlpha: 0.85, lineAlpha: 0.30,
  },
};

const mixed = (a, b, t) => hex(a).map((v, k) => mix(v, hex(b)[k], t));

function setUpCard(view, canvas) {
  view.card = makeCard(canvasContext(canvas));
  for (const mesh of view.model.meshes) mesh.card = null;
  view.card.batches = {};
  view.shadowKey = "";
}

function onCard(view, mesh) {
  if (!mesh.card) mesh.card = uploadMesh(view.card, mesh);
  return mesh.card;
}

/** Buffers of the error map and the envelope. */
function fill(view) {
  const { card } = view;
  const b = card.batches;
  const lines = (name, data) => (b[name] = uploadLines(card, b[name], data));
  b.glyphs = uploadGlyphs(card, b.glyphs, glyphInstances(view));
  b.spots = uploadGlyphs(card, b.spots, spotInstances(view));
  b.arrows = uploadArrows(card, b.arrows, arrowInstances(view));
  lines("net", netInstances(view));
  lines("pins", pinInstances(view));
  const { envelopes } = view.drawing;
  const { envelope, operation } = view.state;
  const shown = envelope ? envelopes.filter((_, k) => operation === null || k === operation) : [];
  lines("atWork", ringInstances(shown.flatMap((e) => e.atWork)));
  // Of several operations the first stands for the rest: their reach differs little.
  lines("around", ringInstances(shown.slice(0, 1).flatMap((e) => e.around)));
}

function partsNow({ drawing, state }) {
  const held = heldAt(drawing.movement, state.time);
  return drawing.parts.filter((p) => p.operation === null || p.operation === held);
}

const isRobots = (part) => ["robot", "tool", "held"].includes(part.kind);
const isSpace = (part) => part.kind === "fence" || part.kind === "keep-out";
const seenAs = ({ state }, part) => (isSpace(part) ? "space" : state[isRobots(part) ? "robot" : "solids"]);

function colourOf(view, part) {
  const looks = LOOKS[view.theme];
  return hex(part.kind === "robot" && part.link === 0 ? looks.foot : looks[part.kind] || looks.equipment);
}

/** The shadow is drawn anew only if something moved. */
function drawShadow(view, parts) {
  const { state, card, model } = view;
  const { gl } = card;
  const radius = size(minus(model.high, model.low)) * 0.62;
  const right = unit(cross([0, 0, 1], SUN));
  const middle = times(add(model.low, model.high), 0.5);
  const look = lookFrom(add(middle, times(SUN, 2 * radius)), right, cross(SUN, right), SUN);
  view.shadowCamera = product(parallel(2 * radius, 2 * radius, radius * 0.5, radius * 3.5), look);
  const key = JSON.stringify([state.time, state.drawing, state.robot, state.solids]);
  if (key === view.shadowKey) return;
  view.shadowKey = key;
  gl.bindFramebuffer(gl.FRAMEBUFFER, card.shadow.target);
  gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
  gl.clear(gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(2, 4);
  for (const part of parts) {
    if (seenAs(view, part) !== "solid") continue;
    const values = { model: view.poseOf(part), camera: view.shadowCamera, grow: 0, viewport: [1, 1] };
    drawMesh(card, "shadow", onCard(view, part.mesh), values);
  }
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
}

/** The whole picture, into a canvas of so many pixels. */
function drawPicture(view, width, height) {
  const looks = LOOKS[view.theme];
  const { card, optics: o } = view;
  const { gl } = card;
  const parts = partsNow(view);
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  gl.depthMask(true);
  gl.colorMask(true, true, true, true);
  gl.disable(gl.CULL_FACE);
  gl.disable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  gl.bindTexture(gl.TEXTURE_2D, null);
  drawShadow(view, parts);
  gl.bindTexture(gl.TEXTURE_2D, card.shadow.map);
  gl.viewport(0, 0, width, height);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  const shared = { camera: o.camera, viewport: [width, height], shadowMap: 0, shadowCamera: view.shadowCamera, sun: SUN,
    eye: o.towards, parallelView: view.camera.parallel ? 1 : 0, perMm: o.perMm * view.ratio, model: UNMOVED,
    paper: hex(looks.paper), grow: 0, flatly: 0 };
  const solid = parts.filter((p) => seenAs(view, p) === "solid");
  for (const part of solid) drawSolid(view, part, shared, 1);
  for (const part of solid) drawOutline(view, part, shared);
  gl.enable(gl.BLEND);
  gl.depthMask(false);
  for (const part of solid) drawEdges(view, part, shared, 1);
  drawFloor(card, { ...shared, bounds: view.floorBounds, height: view.drawing.floor_mm, dark: looks.shade,
    line: [...hex(looks.line), looks.lineAlpha], ground: [...hex(looks.ground), 0.9] });
  drawMap(view, shared, looks);
  drawGhost(view, shared, looks);
  drawSigns(view, shared, looks);
  // Last what one sees through: signs behind it stay bright.
  for (const part of parts) {
    const seen = seenAs(view, part);
    if (seen === "clear") drawGlass(view, part, shared, 0.22);
    if (seen === "space") drawGlass(view, part, shared, part.kind === "fence" ? 0.1 : 0.13);
  }
}

function drawSolid(view, part, shared, alpha) {
  const { gl } = view.card;
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(1, 1);
  const values = { ...shared, model: view.poseOf(part), colour: [...colourOf(view, part), alpha] };
  drawMesh(view.card, "solid", onCard(view, part.mesh), values);
  gl.disable(gl.POLYGON_OFFSET_FILL);
}

/** The outline of round solids: the back of a slightly larger one. */
function drawOutline(view, part, shared) {
  const { gl } = view.card;
  const looks = LOOKS[view.theme];
  gl.enable(gl.CULL_FACE);
  gl.cullFace(gl.FRONT);
  const colour = [...mixed(looks.edge, looks.paper, 0.25), 1];
  drawMesh(view.card, "solid", onCard(view, part.mesh), { ...shared, model: view.poseOf(part), colour, flatly: 1, grow: 0.9 * view.ratio });
  gl.disable(gl.CULL_FACE);
}

function drawEdges(view, part, shared, strength) {
  const looks = LOOKS[view.theme];
  const colour = [...hex(looks.edge), looks.edgeAlpha * strength];
  drawInstances(view.card, "line", onCard(view, part.mesh).edges,
    { ...shared, model: view.poseOf(part), colour, width: 1.1 * view.ratio, pull: 0.00008 });
}

/** Of a solid that one sees through only what is nearest. */
function drawGlass(view, part, shared, alpha) {
  const { gl } = view.card;
  gl.depthMask(true);
  gl.colorMask(false, false, false, false);
  drawSolid(view, part, shared, 1);
  gl.colorMask(true, true, true, true);
  gl.depthMask(false);
  drawSolid(view, part, shared, alpha);
  drawEdges(view, part, shared, 0.45);
}

/** Arrows with a rim that parts them, the net between the nodes, the reach. */
function drawMap(view, shared, looks) {
  const { card, ratio } = view;
  const { gl } = card;
  const b = card.batches;
  gl.disable(gl.BLEND);
  gl.depthMask(true);
  const radius = clamp(view.spacing * 0.045, 2, 14);
  drawInstances(card, "arrow", b.arrows, { ...shared, radius, halo: [0, 0, 0, 0] });
  gl.enable(gl.CULL_FACE);
  gl.cullFace(gl.FRONT);
  drawInstances(card, "arrow", b.arrows, { ...shared, radius, halo: [...hex(looks.paper), 1], grow: 0.9 * ratio });
  gl.disable(gl.CULL_FACE);
  gl.enable(gl.BLEND);
  gl.depthMask(false);
  const line = (batch, colour, alpha, width) =>
    drawInstances(card, "line", batch, { ...shared, colour: [...hex(colour), alpha], width: width * ratio, pull: 0.0003 });
  line(b.net, looks.net, 0.2, 1);
  line(b.around, looks.envelope, 0.42, 1.1);
  line(b.atWork, looks.envelope, 1, 2.4);
}

/** Where the equipment of the layout compared with stands: its edges alone. */
function drawGhost(view, shared, looks) {
  const { other } = view.scale;
  for (const part of other ? other.parts : []) {
    if (part.kind !== "equipment") continue;
    const values = { ...shared, model: part.at, colour: [...hex(looks.ghost), 0.8], width: 1.4 * view.ratio, pull: 0.0003 };
    drawInstances(view.card, "line", onCard(view, part.mesh).edges, values);
  }
}

function drawSigns(view, shared, looks) {
  const { card, ratio } = view;
  const { gl } = card;
  const b = card.batches;
  const { right, up } = view.optics;
  // Signs lie on the surface; seen flatter than 35 degrees they rise.
  const { elevation } = view.camera;
  const rise = Math.max(0, 0.61 - Math.abs(elevation));
  const ahead = unit(cross([0, 0, 1], right));
  const upwards = elevation < 0 ? up : add(times(ahead, Math.cos(rise)), [0, 0, Math.sin(rise)]);
  const values = { ...shared, across: right, upwards, radius: view.spacing * 0.16, least: 3 * ratio, most: 7 * ratio, pull: 0.0012, fade: 1 };
  drawInstances(card, "glyph", b.glyphs, values);
  drawInstances(card, "line", b.pins, { ...shared, colour: [...SPOT[view.theme], 0.9], width: 1.6 * ratio, pull: 0.0006 });
  // What stands before a sign dims it; a spot is always seen.
  gl.depthFunc(gl.GREATER);
  drawInstances(card, "glyph", b.glyphs, { ...values, fade: 0.16 });
  gl.depthFunc(gl.ALWAYS);
  drawInstances(card, "glyph", b.spots, { ...values, least: 4.2 * ratio });
  gl.depthFunc(gl.LEQUAL);
}
