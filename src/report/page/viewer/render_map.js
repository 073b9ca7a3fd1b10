// The error map in the picture: its buffers, arrows, lines and marks.

/**
 * Fills the buffers of the error map and the envelope.
 * @param {View} view
 */
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
  // The outlines at other heights differ little between operations, so only the outlines of the first
  // operation are drawn.
  fillLines("around", ringInstances(shown.slice(0, 1).flatMap((one) => one.around)));
}

/**
 * Draws the arrows with a rim that separates them, the lines between nodes, and the reach.
 * @param {View} view
 * @param {Uniforms} shared
 */
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

/**
 * Draws the edges of the equipment at its place in the other layout.
 * @param {View} view
 * @param {Uniforms} shared
 */
function drawGhost(view, shared) {
  const colour = [...colourOf(looksOf(view).ghost), 0.8];
  for (const part of view.scale.comparison?.other.parts ?? []) {
    if (part.kind !== "equipment" || !part.at) continue;
    const values = { ...shared, model: part.at, colour, width: 1.4 * view.ratio, pull: 0.0003 };
    drawInstances(view.graphics, "line", buffersOf(view, part.mesh).edges, values);
  }
}

/** Elevation of the camera below which glyphs tilt up from the surface, rad. */
const RISE_BELOW = 0.61;

/**
 * Draws the marks of nodes and spots.
 * @param {View} view
 * @param {Uniforms} shared
 */
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
  // A mark behind a solid is dimmed; a spot is always drawn in full.
  gl.depthFunc(gl.GREATER);
  drawInstances(graphics, "glyph", batches.glyphs, { ...values, fade: 0.16 });
  gl.depthFunc(gl.ALWAYS);
  drawInstances(graphics, "glyph", batches.spots, { ...values, least: 4.2 * ratio });
  gl.depthFunc(gl.LEQUAL);
}
