// One picture: the buffers that are filled when the state changes, and the drawing of every picture.

/** Direction to the light. */
const SUN = normalized([0.42, -0.5, 1.15]);

/**
 * Returns the buffers of a mesh, made when they are first needed.
 * @param {View} view
 * @param {Mesh} mesh
 */
function buffersOf(view, mesh) {
  if (!mesh.buffers) mesh.buffers = uploadMesh(view.graphics, mesh);
  return mesh.buffers;
}

/**
 * Returns the pose of a part at the time shown.
 * @param {View} view
 * @param {Part} part
 * @returns {Matrix}
 */
function poseOf(view, part) {
  if (!part.at) return (part.link === null ? null : view.frames[part.link]) || view.drawing.base;
  const shift = part.equipment === null ? undefined : view.shifts.get(part.equipment);
  return shift ? product(shift, part.at) : part.at;
}

/**
 * Returns the parts that are in the cell at the time shown.
 * @param {View} view
 */
function partsNow({ drawing, state }) {
  const held = heldAt(drawing.movement, state.time);
  return drawing.parts.filter((part) => part.operation === null || part.operation === held);
}

/**
 * Draws the shadow map again if something has moved.
 * @param {View} view
 * @param {Part[]} parts
 */
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

/**
 * Draws the whole picture.
 * @param {View} view
 * @param {number} width pixels
 * @param {number} height pixels
 */
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
  // Transparent parts are drawn last, so that marks behind them stay bright.
  for (const part of parts) {
    const visibility = visibilityOf(view, part);
    if (visibility === "clear") drawGlass(view, part, shared, 0.22);
    if (visibility === "space") drawGlass(view, part, shared, part.kind === "fence" ? 0.1 : 0.13);
  }
}

/**
 * Sets the state of WebGL that a picture starts from.
 * @param {WebGL2RenderingContext} gl
 */
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

/**
 * Returns the uniforms that all programs share.
 * @param {View} view
 * @param {number} width
 * @param {number} height
 * @returns {Uniforms}
 */
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

/**
 * Draws the faces of a part.
 * @param {View} view
 * @param {Part} part
 * @param {Uniforms} shared
 * @param {number} alpha
 */
function drawSolid(view, part, shared, alpha) {
  const { gl } = view.graphics;
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(1, 1);
  const values = { ...shared, model: poseOf(view, part), colour: [...partColour(view, part), alpha] };
  drawMesh(view.graphics, "solid", buffersOf(view, part.mesh), values);
  gl.disable(gl.POLYGON_OFFSET_FILL);
}

/**
 * Draws the silhouette of a part: the back faces of a slightly enlarged copy.
 * @param {View} view
 * @param {Part} part
 * @param {Uniforms} shared
 */
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

/**
 * Draws the feature edges of a part.
 * @param {View} view
 * @param {Part} part
 * @param {Uniforms} shared
 * @param {number} strength
 */
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

/**
 * Draws a transparent solid: only the faces nearest to the eye.
 * @param {View} view
 * @param {Part} part
 * @param {Uniforms} shared
 * @param {number} alpha
 */
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

/**
 * Draws the floor with its grid and the shadow of the cell.
 * @param {View} view
 * @param {Uniforms} shared
 */
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
