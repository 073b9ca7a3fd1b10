// Look-ups in a document: values and errors of nodes, and the pose of the robot at a time.

/**
 * Returns the error maps shown: all maps, or the map of one operation.
 * @param {View} view
 * @returns {Field[]}
 */
const shownFields = ({ drawing, state }) =>
  drawing.fields.filter((field) => state.operation === null || field.operation === state.operation);

/**
 * Returns the index of the lens of a drawing with the model and reading of another lens, or -1.
 * @param {Drawing} drawing
 * @param {LensRecord} lens
 */
const lensIn = (drawing, lens) =>
  drawing.lenses.findIndex((own) => own.model === lens.model && own.reading === lens.reading);

/**
 * Returns the index of a sense in a field.
 * @param {Field} field
 * @param {string | null} name `null` selects the sense of the operation
 */
function senseIn(field, name) {
  const index = name === null ? -1 : field.senses.findIndex((sense) => sense.name === name);
  return index < 0 ? field.sense : index;
}

/**
 * Returns the sense that is shown for a field.
 * @param {View} view
 * @param {Field} field
 */
const shownSense = (view, field) => field.senses[senseIn(field, view.state.sense)];

/**
 * Returns the value of a node in a sense; NaN if the node has no value.
 * @param {Field} field
 * @param {number} lens
 * @param {string} sense
 * @param {number} k
 */
function valueAt(field, lens, sense, k) {
  const index = field.senses.findIndex((one) => one.name === sense);
  return index < 0 ? Number.NaN : field.takes[lens].values[index][k];
}

/**
 * Visits the error maps of every drawing that has the model and the reading of a lens.
 * @param {Model} model
 * @param {LensRecord} lens
 * @param {(field: Field, lens: number) => void} visit
 */
function visitFields(model, lens, visit) {
  for (const drawing of model.drawings) {
    const index = lensIn(drawing, lens);
    if (index < 0) continue;
    for (const field of drawing.fields) visit(field, index);
  }
}

/**
 * Returns the range of the values over all drawings and operations that share a unit.
 * @param {Model} model
 * @param {LensRecord} lens
 * @param {string | null} sense
 * @param {string} unit
 * @returns {ValueRange | null}
 */
function rangeOf(model, lens, sense, unit) {
  const range = { low: Infinity, high: -Infinity };
  visitFields(model, lens, (field, index) => {
    const own = senseIn(field, sense);
    if (field.senses[own].unit !== unit) return;
    for (const value of field.takes[index].values[own]) {
      // Comparisons with NaN are false.
      if (value < range.low) range.low = value;
      if (value > range.high) range.high = value;
    }
  });
  return range.low <= range.high ? range : null;
}

/**
 * Returns the length of the longest arrow of the chosen kind over all drawings, mm of error.
 * @param {Model} model
 * @param {LensRecord} lens
 * @param {ArrowChoice} arrows
 */
function longestError(model, lens, arrows) {
  const axis = "xyz".indexOf(arrows);
  const errorOf = arrows.length > 1 ? resultant : components;
  let longest = 0;
  visitFields(model, lens, (field, index) => {
    for (let k = 0; k < field.count; k++) {
      const error = errorOf(field, index, k, lens.signed);
      if (error) longest = Math.max(longest, axis < 0 ? norm(error) : Math.abs(error[axis]));
    }
  });
  return longest;
}

/**
 * Returns the error of a node; null if the node has no error.
 * @param {Field} field
 * @param {number} lens
 * @param {number} k
 */
function errorAt(field, lens, k) {
  const error = pointAt(field.takes[lens].error, k);
  return Number.isNaN(error[0]) ? null : error;
}

/**
 * Returns the resultant error. Under an unsigned reading, the resultant has the direction of the worst corner
 * and the length of the value in xyz.
 * @param {Field} field
 * @param {number} lens
 * @param {number} k
 * @param {boolean} signed
 */
function resultant(field, lens, k, signed) {
  const error = errorAt(field, lens, k);
  if (!error || signed) return error;
  const value = valueAt(field, lens, "xyz", k);
  return Number.isNaN(value) ? error : scaled(normalized(error), value);
}

/**
 * Returns the errors along x, y and z. Under an unsigned reading, the errors apply in both directions.
 * @param {Field} field
 * @param {number} lens
 * @param {number} k
 * @param {boolean} signed
 */
function components(field, lens, k, signed) {
  const error = errorAt(field, lens, k);
  if (!error || signed) return error;
  return ["x", "y", "z"].map((name, axis) => {
    const value = valueAt(field, lens, name, k);
    return Number.isNaN(value) ? Math.abs(error[axis]) : value;
  });
}

/**
 * Returns the value of a node minus the value of the same node in the compared layout. A positive difference
 * is worse. Returns null if one of the two nodes has no value.
 * @param {View} view
 * @param {Field} field
 * @param {number} k
 */
function differenceAt(view, field, k) {
  const other = view.scale.comparison?.other;
  const theirs = other?.fields.find((one) => one.operation === field.operation);
  if (!other || !theirs) return null;
  const lens = lensIn(other, view.drawing.lenses[view.lens]);
  if (lens < 0 || String(theirs.size) !== String(field.size) || theirs.count !== field.count) return null;
  const { name } = shownSense(view, field);
  const difference = valueAt(field, view.lens, name, k) - valueAt(theirs, lens, name, k);
  return Number.isNaN(difference) ? null : difference;
}

/**
 * Returns the poses of the robot links at a time, interpolated between the two nearest times.
 * @param {Movement} movement
 * @param {number} time s
 * @returns {Matrix[]}
 */
function framesAt(movement, time) {
  const { times_s: moments, frames, links } = movement;
  if (!moments.length) return [];
  let [low, high] = [0, moments.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (moments[middle] <= time) low = middle;
    else high = middle;
  }
  const span = moments[high] - moments[low];
  const share = span > 0 ? clamp((time - moments[low]) / span, 0, 1) : 0;
  const stride = 12 * links;
  return Array.from({ length: links }, (_, link) => {
    const [from, to] = [low * stride + 12 * link, high * stride + 12 * link];
    return matrixOf(Array.from({ length: 12 }, (_, k) => mix(frames[from + k], frames[to + k], share)));
  });
}

/**
 * Returns the operation whose part the robot holds at a time; null if the robot holds no part.
 * @param {Movement} movement
 * @param {number} time
 */
function heldAt({ times_s: moments, holding }, time) {
  const next = moments.findIndex((moment) => moment > time);
  const index = next < 0 ? moments.length - 1 : Math.max(next - 1, 0);
  return holding.length ? holding[index] : null;
}

/** Time after the start of a stop at which the robot is certainly shown there, s. */
const REST = 0.3;

/**
 * Returns a time at which the robot is at the spot of an operation, s. Returns 0 if there is no such time.
 * @param {Drawing} drawing
 * @param {number | null} operation `null` selects the first spot
 */
function timeOf(drawing, operation) {
  const stops = drawing.movement.stops.filter((stop) => stop.operation !== null);
  const stop = operation === null ? stops[0] : stops.find((one) => one.operation === operation);
  return stop ? stop.time_s + REST : 0;
}
