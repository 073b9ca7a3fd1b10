// Scales of the picture: colours, arrows and the floor, from the document and the state.

/**
 * Makes the state valid for the document, and derives the data that depend on both.
 * @param {View} view
 */
function settle(view) {
  const { model, state } = view;
  state.drawing = clamp(Math.round(state.drawing) || 0, 0, model.drawings.length - 1);
  const drawing = model.drawings[state.drawing];
  view.drawing = drawing;
  if (state.operation !== null && !drawing.operations[state.operation]) state.operation = null;
  const comparesItself = state.compareTo === state.drawing;
  if (state.compareTo !== null && (comparesItself || !model.drawings[state.compareTo]))
    state.compareTo = null;
  view.lens = drawing.lenses[state.lens] ? state.lens : 0;
  view.scale = colourScale(view);
  const extent = norm(subtract(model.high, model.low));
  view.spacing = Math.min(...drawing.fields.map((field) => field.spacing), extent / 8);
  view.magnification = magnificationOf(view, extent);
  view.floorBounds = floorBounds(model, extent);
}

/**
 * Returns the ranges of the colours, and the comparison with another layout.
 * @param {View} view
 * @returns {ColourScale}
 */
function colourScale(view) {
  const { model, state, drawing } = view;
  /** @type {ColourScale} */
  const scale = { ranges: {}, comparison: null };
  for (const { unit } of drawing.fields.map((field) => shownSense(view, field))) {
    const range = rangeOf(model, drawing.lenses[view.lens], state.sense, unit);
    if (range) scale.ranges[unit] = range;
  }
  if (state.compareTo === null) return scale;
  const fields = shownFields(view);
  const unit = fields.length ? shownSense(view, fields[0]).unit : "";
  const comparison = { other: model.drawings[state.compareTo], greatest: 0, unit };
  const compared = { ...view, scale: { ...scale, comparison } };
  for (const field of fields) {
    for (let k = 0; k < field.count; k++) {
      const difference = Math.abs(differenceAt(compared, field, k) || 0);
      comparison.greatest = Math.max(comparison.greatest, difference);
    }
  }
  return { ...scale, comparison: { ...comparison, greatest: comparison.greatest || 1 } };
}

/**
 * Returns the magnification of the error arrows. The longest arrow spans about one to two and a half node
 * distances.
 * @param {View} view
 * @param {number} extent mm
 */
function magnificationOf({ model, state, drawing, lens: index, spacing }, extent) {
  const lens = drawing.lenses[index];
  // Span of the longest arrow in node distances. Unsigned components at one node need shorter arrows.
  let nodes = 2;
  if (lens.signed || state.arrows.length === 1) nodes = 2.4;
  else if (state.arrows === "components") nodes = 1.2;
  const longest = longestError(model, lens, state.arrows) || 1;
  return roundDown(clamp(spacing * nodes, extent * 0.02 * nodes, extent * 0.13) / longest);
}

/**
 * Returns the bounds of the floor: the cell with a margin, rounded outwards to multiples of 500 mm.
 * @param {Extent} box
 * @param {number} extent mm
 */
function floorBounds({ low, high }, extent) {
  const STEP = 500;
  const margin = Math.max(300, extent * 0.1);
  const down = (/** @type {number} */ value) => Math.floor((value - margin) / STEP) * STEP;
  const up = (/** @type {number} */ value) => Math.ceil((value + margin) / STEP) * STEP;
  return [down(low[0]), down(low[1]), up(high[0]), up(high[1])];
}
