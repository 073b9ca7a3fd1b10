// One picture: what is filled into buffers when the state changes, and what is drawn every time.

/** Direction to the light. */
const SUN = normalized([0.42, -0.5, 1.15]);

/** Colours of the picture, and strengths of shadow, edges and grid. */
const LOOKS = {
  light: {
    robot: "#ea7317",
    foot: "#4a525c",
    tool: "#353b43",
    held: "#3f8fd2",
    equipment: "#c3cbd4",
    obstacle: "#8d959f",
    fence: "#d9a400",
    "keep-out": "#cf222e",
    edge: "#1b232d",
    ground: "#f4f6f8",
    grid: "#7d8894",
    paper: "#ffffff",
    envelope: "#0969a8",
    net: "#33404d",
    ghost: "#7c3aed",
    shadow: 0.34,
    edgeAlpha: 0.75,
    gridAlpha: 0.42,
  },
  dark: {
    robot: "#f08a35",
    foot: "#6a737e",
    tool: "#3d444d",
    held: "#58a6ff",
    equipment: "#87919d",
    obstacle: "#5d6671",
    fence: "#e3b341",
    "keep-out": "#ff6b61",
    edge: "#05080c",
    ground: "#1b222b",
    grid: "#8b97a5",
    paper: "#12171d",
    envelope: "#58b0f0",
    net: "#c2ccd6",
    ghost: "#b794f6",
    shadow: 0.45,
    edgeAlpha: 0.85,
    gridAlpha: 0.3,
  },
};

/** @param {View} view */
const looksOf = (view) => LOOKS[view.theme];

/** Returns the buffers of a mesh, made when they are first needed. @param {View} view @param {Mesh} mesh */
function buffersOf(view, mesh) {
  if (!mesh.buffers) mesh.buffers = uploadMesh(view.graphics, mesh);
  return mesh.buffers;
}

/** Fills the buffers of the error map and the envelope. @param {View} view */
function fillBatches(view) {
  const { graphics } = view;
  const { batches } = graphics;
  const fillLines = (/** @type {string} */ name, /** @type {Float32Array<ArrayBuffer>} */ data) => {
    batches[name] = uploadLines(graphics, batches[name], data);
  };
  batches.glyphs = uploadGlyphs(graphics, batches.glyphs, glyphInstances(view));
  batches.spots = uploadGlyphs(graphics, batches.spots, spotInstances(view));
  batches.arrows = uploadArrows(graphics, batches.arrows, arrowInstances(view));
  fillLines("net", netInstances(view));
  fillLines("pins", pinInstances(view));
  const { envelope, operation } = view.state;
  const shown = view.drawing.envelopes.filter((_, k) => envelope && (operation === null || k === operation));
  fillLines("atWork", ringInstances(shown.flatMap((one) => one.atWork)));
  // The outlines elsewhere differ little between operations: the first stands for all.
  fillLines("around", ringInstances(shown.slice(0, 1).flatMap((one) => one.around)));
}

/** Returns the pose of a part at the time shown. @param {View} view @param {Part} part @returns {Matrix} */
function poseOf(view, part) {
  if (!part.at) return (part.link === null ? null : view.frames[part.link]) || view.drawing.base;
  const shift = part.equipment === null ? undefined : view.shifts.get(part.equipment);
  return shift ? product(shift, part.at) : part.at;
}

/** Returns the parts that are in the cell at the time shown. @param {View} view */
function partsNow({ drawing, state }) {
  const held = heldAt(drawing.movement, state.time);
  return drawing.parts.filter((part) => part.operation === null || part.operation === held);
}

const ROBOT_KINDS = ["robot", "tool", "held"];
const SPACE_KINDS = ["fence", "keep-out"];

/** Returns how a part is drawn. @param {View} view @param {Part} part @returns {Visibility | "space"} */
function visibilityOf({ state }, part) {
  if (SPACE_KINDS.includes(part.kind)) return "space";
  return ROBOT_KINDS.includes(part.kind) ? state.robot : state.solids;
}

/** @param {View} view @param {Part} part */
function partColour(view, part) {
  const looks = looksOf(view);
  const isFoot = part.kind === "robot" && part.link === 0;
  return colourOf(isFoot ? looks.foot : looks[part.kind] || looks.equipment);
}

/** Draws the shadow map, if something has moved since it was drawn. @param {View} view @param {Part[]} parts */
function drawShadow(view, parts) {
  const { state, graphics, model } = view;
  const { gl } = graphics;
  const radius = norm(subtract(model.high, model.low)) * 0.62;
  const right = normalized(cross([0, 0, 1], SUN));
  const middle = scaled(add(model.low, model.high), 0.5);
  const look = viewMatrix(add(middle, scaled(SUN, 2 * radius)), right, cross(SUN, right), SUN);
  view.shadowCamera = product(orthographic(2 * radius, 2 * radius, radius * 0.5, radius * 3.5), look);
  const key = JSON.stringify([state.time, state.drawing, state.robot, state.solids]);
  if (key === view.shadowKey) return;
  view.shadowKey = key;
  gl.bindFramebuffer(gl.FRAMEBUFFER, graphics.shadow.target);
  gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
  gl.clear(gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(2, 4);
  for (const part of parts) {
    if (visibilityOf(view, part) !== "solid") continue;
    const values = { model: poseOf(view, part), camera: view.shadowCamera, grow: 0, viewport: [1, 1] };
    drawMesh(graphics, "shadow", buffersOf(view, part.mesh), values);
  }
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
}

/** Draws the whole picture. @param {View} view @param {number} width pixels @param {number} height pixels */
function drawPicture(view, width, height) {
  const { gl, shadow } = view.graphics;
  const parts = partsNow(view);
  resetState(gl);
  drawShadow(view, parts);
  gl.bindTexture(gl.TEXTURE_2D, shadow.map);
  gl.viewport(0, 0, width, height);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  const shared = sharedUniforms(view, width, height);
  const solid = parts.filter((part) => visibilityOf(view, part) === "solid");
  for (const part of solid) drawSolid(view, part, shared, 1);
  for (const part of solid) drawOutline(view, part, shared);
  gl.enable(gl.BLEND);
  gl.depthMask(false);
  for (const part of solid) drawEdges(view, part, shared, 1);
  drawGround(view, shared);
  drawErrorMap(view, shared);
  drawGhost(view, shared);
  drawGlyphs(view, shared);
  // Transparent parts come last: marks behind them stay bright.
  for (const part of parts) {
    const visibility = visibilityOf(view, part);
    if (visibility === "clear") drawGlass(view, part, shared, 0.22);
    if (visibility === "space") drawGlass(view, part, shared, part.kind === "fence" ? 0.1 : 0.13);
  }
}

/** @param {WebGL2RenderingContext} gl */
function resetState(gl) {
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  gl.depthMask(true);
  gl.colorMask(true, true, true, true);
  gl.disable(gl.CULL_FACE);
  gl.disable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  gl.bindTexture(gl.TEXTURE_2D, null);
}

/** @param {View} view @param {number} width @param {number} height @returns {Uniforms} */
function sharedUniforms(view, width, height) {
  const { optics } = view;
  return {
    camera: optics.camera,
    viewport: [width, height],
    shadowMap: 0,
    shadowCamera: view.shadowCamera,
    sun: SUN,
    eye: optics.viewpoint,
    parallelView: view.camera.parallel ? 1 : 0,
    perMm: optics.scalePerMm * view.ratio,
    model: IDENTITY,
    paper: colourOf(looksOf(view).paper),
    grow: 0,
    flatly: 0,
  };
}

/** @param {View} view @param {Part} part @param {Uniforms} shared @param {number} alpha */
function drawSolid(view, part, shared, alpha) {
  const { gl } = view.graphics;
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(1, 1);
  const values = { ...shared, model: poseOf(view, part), colour: [...partColour(view, part), alpha] };
  drawMesh(view.graphics, "solid", buffersOf(view, part.mesh), values);
  gl.disable(gl.POLYGON_OFFSET_FILL);
}

/** Draws the outline of a round solid: the back of a slightly larger one. @param {View} view @param {Part} part @param {Uniforms} shared */
function drawOutline(view, part, shared) {
  const { gl } = view.graphics;
  const looks = looksOf(view);
  const paper = colourOf(looks.paper);
  const colour = [...colourOf(looks.edge).map((channel, k) => mix(channel, paper[k], 0.25)), 1];
  const values = { ...shared, model: poseOf(view, part), colour, flatly: 1, grow: 0.9 * view.ratio };
  gl.enable(gl.CULL_FACE);
  gl.cullFace(gl.FRONT);
  drawMesh(view.graphics, "solid", buffersOf(view, part.mesh), values);
  gl.disable(gl.CULL_FACE);
}

/** @param {View} view @param {Part} part @param {Uniforms} shared @param {number} strength */
function drawEdges(view, part, shared, strength) {
  const looks = looksOf(view);
  drawInstances(view.graphics, "line", buffersOf(view, part.mesh).edges, {
    ...shared,
    model: poseOf(view, part),
    colour: [...colourOf(looks.edge), looks.edgeAlpha * strength],
    width: 1.1 * view.ratio,
    pull: 0.00008,
  });
}

/** Draws a transparent solid: only the faces nearest to the eye. @param {View} view @param {Part} part @param {Uniforms} shared @param {number} alpha */
function drawGlass(view, part, shared, alpha) {
  const { gl } = view.graphics;
  gl.depthMask(true);
  gl.colorMask(false, false, false, false);
  drawSolid(view, part, shared, 1);
  gl.colorMask(true, true, true, true);
  gl.depthMask(false);
  drawSolid(view, part, shared, alpha);
  drawEdges(view, part, shared, 0.45);
}

/** @param {View} view @param {Uniforms} shared */
function drawGround(view, shared) {
  const looks = looksOf(view);
  drawFloor(view.graphics, {
    ...shared,
    bounds: view.floorBounds,
    height: view.drawing.floor_mm,
    dark: looks.shadow,
    line: [...colourOf(looks.grid), looks.gridAlpha],
    ground: [...colourOf(looks.ground), 0.9],
  });
}

/** Draws the arrows with a rim that parts them, the net between the nodes and the reach. @param {View} view @param {Uniforms} shared */
function drawErrorMap(view, shared) {
  const { graphics, ratio } = view;
  const { gl, batches } = graphics;
  const looks = looksOf(view);
  gl.disable(gl.BLEND);
  gl.depthMask(true);
  const radius = clamp(view.spacing * 0.045, 2, 14);
  drawInstances(graphics, "arrow", batches.arrows, { ...shared, radius, halo: [0, 0, 0, 0] });
  gl.enable(gl.CULL_FACE);
  gl.cullFace(gl.FRONT);
  const halo = [...colourOf(looks.paper), 1];
  drawInstances(graphics, "arrow", batches.arrows, { ...shared, radius, halo, grow: 0.9 * ratio });
  gl.disable(gl.CULL_FACE);
  gl.enable(gl.BLEND);
  gl.depthMask(false);
  const lines = { ...shared, pull: 0.0003 };
  const net = [...colourOf(looks.net), 0.2];
  const [around, atWork] = [0.42, 1].map((alpha) => [...colourOf(looks.envelope), alpha]);
  drawInstances(graphics, "line", batches.net, { ...lines, colour: net, width: ratio });
  drawInstances(graphics, "line", batches.around, { ...lines, colour: around, width: 1.1 * ratio });
  drawInstances(graphics, "line", batches.atWork, { ...lines, colour: atWork, width: 2.4 * ratio });
}

/** Draws the edges of the equipment where the layout compared with has it. @param {View} view @param {Uniforms} shared */
function drawGhost(view, shared) {
  const colour = [...colourOf(looksOf(view).ghost), 0.8];
  for (const part of view.scale.comparison?.other.parts ?? []) {
    if (part.kind !== "equipment" || !part.at) continue;
    const values = { ...shared, model: part.at, colour, width: 1.4 * view.ratio, pull: 0.0003 };
    drawInstances(view.graphics, "line", buffersOf(view, part.mesh).edges, values);
  }
}

/** Elevation below which glyphs rise from the surface, rad. */
const RISE_BELOW = 0.61;

/** Draws the marks of nodes and spots. @param {View} view @param {Uniforms} shared */
function drawGlyphs(view, shared) {
  const { graphics, ratio } = view;
  const { gl, batches } = graphics;
  const { right, up } = view.optics;
  const { elevation } = view.camera;
  const rise = Math.max(0, RISE_BELOW - Math.abs(elevation));
  const ahead = normalized(cross([0, 0, 1], right));
  const risen = add(scaled(ahead, Math.cos(rise)), [0, 0, Math.sin(rise)]);
  const values = {
    ...shared,
    across: right,
    upwards: elevation < 0 ? up : risen,
    radius: view.spacing * 0.16,
    least: 3 * ratio,
    most: 7 * ratio,
    pull: 0.0012,
    fade: 1,
  };
  drawInstances(graphics, "glyph", batches.glyphs, values);
  const pins = { colour: [...TONES.pink[view.theme], 0.9], width: 1.6 * ratio, pull: 0.0006 };
  drawInstances(graphics, "line", batches.pins, { ...shared, ...pins });
  // A solid in front of a mark dims it; a spot is always seen.
  gl.depthFunc(gl.GREATER);
  drawInstances(graphics, "glyph", batches.glyphs, { ...values, fade: 0.16 });
  gl.depthFunc(gl.ALWAYS);
  drawInstances(graphics, "glyph", batches.spots, { ...values, least: 4.2 * ratio });
  gl.depthFunc(gl.LEQUAL);
}
