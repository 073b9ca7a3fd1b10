// Marks and arrows of the error map as instances for the graphics card.

/**
 * Returns a point of an error map, moved along with its equipment while the equipment is dragged.
 * @param {View} view
 * @param {Field} field
 * @param {Vector} point
 */
function displaced(view, field, point) {
  const shift = field.equipment === null ? undefined : view.shifts.get(field.equipment);
  return shift ? moved(shift, point) : point;
}

/**
 * Returns the colour of a node; null if the node has no value.
 * @param {View} view
 * @param {Field} field
 * @param {number} k
 */
function nodeColour(view, field, k) {
  const { lens, scale } = view;
  const sense = senseIn(field, view.state.sense);
  const value = field.takes[lens].values[sense][k];
  if (Number.isNaN(value)) return null;
  if (scale.comparison) {
    const difference = differenceAt(view, field, k);
    if (difference === null) return null;
    return colourOn(DIVERGING, 0.5 + (0.5 * difference) / scale.comparison.greatest);
  }
  const range = scale.ranges[field.senses[sense].unit];
  return range ? colourOn(VIRIDIS, (value - range.low) / Math.max(range.high - range.low, 1e-12)) : null;
}

/**
 * Returns the marks of the nodes.
 * @param {View} view
 */
function glyphInstances(view) {
  /** @type {number[]} */
  const instances = [];
  const { theme } = view;
  for (const field of shownFields(view)) {
    for (let k = 0; k < field.count; k++) {
      const place = displaced(view, field, nodeAt(field, k));
      const { mark } = NODE_SIGNS[field.status[k]];
      if (mark === "ok") {
        const colour = nodeColour(view, field, k) || TONES.grey[theme];
        instances.push(...place, ...colour, 1, markCode(mark), 0.8);
      } else {
        const { tone } = MARKS[mark];
        instances.push(...place, ...TONES[tone][theme], 1, markCode(mark), 1.15);
      }
    }
  }
  return new Float32Array(instances);
}

/**
 * Returns the marks of the spots, which are drawn last and over everything.
 * @param {View} view
 */
function spotInstances(view) {
  /** @type {number[]} */
  const instances = [];
  const push = (/** @type {Vector} */ place, /** @type {Mark} */ mark, /** @type {number} */ size) =>
    instances.push(...place, ...TONES.pink[view.theme], 1, markCode(mark), size);
  for (const field of shownFields(view)) {
    const spot = spotOf(view, field);
    if (spot) push(spot, SPOT_SIGNS.spot.mark, 2.1);
    const refined = refinedSpotOf(view, field);
    if (refined) push(refined, SPOT_SIGNS.refined.mark, 1.35);
  }
  return new Float32Array(instances);
}

/**
 * Returns whether the lens shown is the lens that the cell states.
 * @param {View} view
 */
const isOwnLens = (view) => view.lens === 0;

/**
 * Returns the spot of a field under the lens shown; null if there is no spot.
 * @param {View} view
 * @param {Field} field
 */
function spotOf(view, field) {
  if (isOwnLens(view) && field.spot_mm) return displaced(view, field, field.spot_mm);
  const best = field.takes[view.lens]?.best ?? null;
  return best === null ? null : displaced(view, field, nodeAt(field, best));
}

/**
 * Returns the spot between the nodes; null if there is no such spot.
 * @param {View} view
 * @param {Field} field
 */
const refinedSpotOf = (view, field) =>
  isOwnLens(view) && field.refined_mm ? displaced(view, field, field.refined_mm) : null;

/**
 * Axes of the component arrows for each choice of arrows.
 * @type {Partial<Record<ArrowChoice, number[]>>}
 */
const ARROW_AXES = { x: [0], y: [1], z: [2], components: [0, 1, 2] };

/**
 * Returns the error arrows of the usable nodes.
 * @param {View} view
 */
function arrowInstances(view) {
  const { drawing, state, lens } = view;
  /** @type {number[]} */
  const instances = [];
  if (state.arrows === "none") return new Float32Array();
  const { signed } = drawing.lenses[lens];
  for (const field of shownFields(view)) {
    for (let k = 0; k < field.count; k++) {
      const colour = field.status[k] === "ok" ? nodeColour(view, field, k) : null;
      if (!colour) continue;
      const place = displaced(view, field, nodeAt(field, k));
      for (const arrow of arrowsOf(field, lens, k, signed, ARROW_AXES[state.arrows])) {
        if (norm(arrow) > 1e-9) instances.push(...place, ...scaled(arrow, view.magnification), ...colour);
      }
    }
  }
  return new Float32Array(instances);
}

/**
 * Returns the error arrows of a node: the resultant, or one arrow for each axis. Components without a sign
 * get two opposite arrows.
 * @param {Field} field
 * @param {number} lens
 * @param {number} k
 * @param {boolean} signed
 * @param {number[] | undefined} axes
 * @returns {Vector[]}
 */
function arrowsOf(field, lens, k, signed, axes) {
  const error = (axes ? components : resultant)(field, lens, k, signed);
  if (!error) return [];
  if (!axes) return [error];
  return axes.flatMap((axis) => {
    const arrow = [0, 0, 0];
    arrow[axis] = error[axis];
    return signed ? [arrow] : [arrow, scaled(arrow, -1)];
  });
}

/**
 * Returns the faint lines between neighbouring nodes.
 * @param {View} view
 */
function netInstances(view) {
  /** @type {number[]} */
  const lines = [];
  for (const field of shownFields(view)) {
    const [across, along] = field.size;
    if (along < 2) continue;
    const place = (/** @type {number} */ k) => displaced(view, field, nodeAt(field, k));
    for (let k = 0; k < field.count; k++) {
      if ((k + 1) % across) lines.push(...place(k), ...place(k + 1));
      if (k + across < field.count) lines.push(...place(k), ...place(k + across));
    }
  }
  return new Float32Array(lines);
}

/**
 * Returns the pins from the spots down to their surfaces.
 * @param {View} view
 */
function pinInstances(view) {
  /** @type {number[]} */
  const lines = [];
  for (const field of shownFields(view)) {
    const spot = spotOf(view, field);
    const depth = view.drawing.operations[field.operation].standoff_mm;
    if (spot && depth > 0) lines.push(...spot, spot[0], spot[1], spot[2] - depth);
  }
  return new Float32Array(lines);
}

/**
 * Returns the segments of closed lines.
 * @param {Float32Array[]} rings
 */
function ringInstances(rings) {
  /** @type {number[]} */
  const lines = [];
  for (const ring of rings) {
    const count = ring.length / 3;
    for (let k = 0; k < count; k++) lines.push(...pointAt(ring, k), ...pointAt(ring, (k + 1) % count));
  }
  return new Float32Array(lines);
}
