// The world axes in the corner, and the numbers along the floor.

/**
 * Draws the world axes and returns their names.
 * @param {View} view
 * @param {Labels} labels
 * @returns {Label[]}
 */
function axisLabels(view, labels) {
  const { right, up } = view.optics;
  const [x, y] = [38, view.height - 40];
  return ["x", "y", "z"].map((name, k) => {
    const [toRight, upwards] = [right[k], up[k]];
    const [endX, endY] = [x + 26 * toRight, y - 26 * upwards];
    const line = { x1: x, y1: y, x2: endX.toFixed(1), y2: endY.toFixed(1) };
    for (const [key, value] of Object.entries(line)) labels.axes[k].setAttribute(key, String(value));
    // An axis that points to the eye has no name.
    const text = Math.hypot(endX - x, endY - y) < 5 ? "" : name;
    return {
      text,
      kind: `axis ss-axis-${name}`,
      x: x + (endX - x) * 1.35 - 4,
      y: y + (endY - y) * 1.35 - 8,
    };
  });
}

/** Steps between the numbers along the floor, mm. */
const FLOOR_STEPS = [500, 1000, 2000, 5000, 10000];

/**
 * Returns the numbers along the two edges of the floor that are nearest to the eye, mm.
 * @param {View} view
 */
function floorNumbers(view) {
  const [x0, y0, x1, y1] = view.floorBounds;
  const { eye } = view.optics;
  const z = view.drawing.floor_mm;
  const y = Math.abs(eye[1] - y0) < Math.abs(eye[1] - y1) ? y0 : y1;
  const x = Math.abs(eye[0] - x0) < Math.abs(eye[0] - x1) ? x0 : x1;
  return [
    ...numbersAlong(view, "x", [x0, x1], (value) => [value, y, z]),
    ...numbersAlong(view, "y", [y0, y1], (value) => [x, value, z]),
  ];
}

/**
 * Returns the numbers along one edge of the floor.
 * @param {View} view
 * @param {string} axis
 * @param {number[]} bounds mm
 * @param {(value: number) => Vector} pointOf
 */
function numbersAlong(view, axis, [low, high], pointOf) {
  /** @type {Label[]} */
  const labels = [];
  const [start, end] = [seenAt(view, pointOf(low)), seenAt(view, pointOf(high))];
  const pixelsPerMm = Math.hypot(start.x - end.x, start.y - end.y) / Math.max(high - low, 1);
  const step = FLOOR_STEPS.find((one) => one * pixelsPerMm > 46);
  if (!step) return labels;
  for (let value = Math.ceil(low / step) * step; value <= high; value += step) {
    const label = floorNumber(view, value, pointOf(value));
    if (label) labels.push(label);
  }
  // The last number also names the axis and the unit.
  const last = labels.at(-1);
  if (last) last.text = `${axis} ${last.text} mm`;
  return labels;
}

/**
 * Returns the label of a number, just outside a point on the edge of the floor. Returns null if the label
 * does not fit into the picture.
 * @param {View} view
 * @param {number} value
 * @param {Vector} point
 */
function floorNumber(view, value, point) {
  const [x0, y0, x1, y1] = view.floorBounds;
  const middle = seenAt(view, [(x0 + x1) / 2, (y0 + y1) / 2, view.drawing.floor_mm]);
  const at = seenAt(view, point);
  const [dx, dy] = [at.x - middle.x, at.y - middle.y];
  const length = Math.hypot(dx, dy) || 1;
  const [x, y] = [at.x + (dx / length) * 16, at.y + (dy / length) * 12];
  const text = String(value).replace("-", "\u2212");
  const half = (textWidth(text, 10) - 14) / 2;
  const isInside = x > half && x < view.width - half && y > 6 && y < view.height - 6;
  return at.visible && isInside ? { text, kind: "tick", x: x - half, y: y - 7 } : null;
}
