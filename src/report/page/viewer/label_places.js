// Places of labels: candidates, and the choice among them.

/**
 * A place for a label: the middle of the label and the cost of this place.
 * @typedef {{ x: number, y: number, cost: number }} LabelPlace
 * A label to be placed.
 * @typedef {object} LabelBox
 * @property {string} key
 * @property {string} text
 * @property {string} kind
 * @property {boolean} [required] whether the label is shown even if it covers something
 * @property {number} width
 * @property {number} height
 * @property {LabelPlace[]} places
 * @property {number[][]} anchors points to which the leader line of the label may lead
 * A label that is placed.
 * @typedef {{ text: string, kind: string, x: number, y: number, leader?: string }} Label
 * @typedef {{ x: number, y: number, width: number, height: number }} Rectangle
 */

/** Cost of covering another label, and the cost from which a label is not shown unless it is required. */
const COST_OF_OVERLAP = 30;
const GREATEST_COST = 28;

/**
 * Returns whether two rectangles overlap.
 * @param {Rectangle} a
 * @param {Rectangle} b
 */
const overlaps = (a, b) =>
  a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;

/**
 * Places labels one after another where they cover the fewest points and no earlier label.
 * @param {Labels} labels
 * @param {LabelBox[]} boxes
 * @param {{ x: number, y: number, cost: number }[]} points
 * @param {{ width: number, height: number }} picture
 * @returns {Label[]}
 */
function arrange(labels, boxes, points, picture) {
  /** @type {Rectangle[]} */
  const taken = [];
  /** @type {Label[]} */
  const placed = [];
  for (const box of boxes) {
    const last = labels.places.get(box.key);
    let [least, chosen] = [Infinity, -1];
    /** @type {Rectangle | undefined} */
    let best;
    box.places.forEach((place, k) => {
      const at = insidePicture(box, place, picture);
      const pushed = Math.hypot(at.x - (place.x - box.width / 2), at.y - (place.y - box.height / 2));
      const covered = taken.filter((other) => overlaps(at, other)).length;
      // A label keeps its place unless another place is clearly better.
      let cost = k * 0.4 + place.cost + pushed * 0.1 + covered * COST_OF_OVERLAP - (last === k ? 2.5 : 0);
      for (const point of points) if (isNear(at, point)) cost += point.cost;
      if (cost < least) [least, chosen, best] = [cost, k, at];
    });
    if (!best || (least >= GREATEST_COST && !box.required)) continue;
    labels.places.set(box.key, chosen);
    taken.push(best);
    placed.push({
      text: box.text,
      kind: box.kind,
      x: best.x,
      y: best.y,
      leader: leaderTo(best, box.anchors),
    });
  }
  return placed;
}

/**
 * Moves a label into the picture.
 * @param {LabelBox} box
 * @param {LabelPlace} place
 * @param {{ width: number, height: number }} picture
 * @returns {Rectangle}
 */
function insidePicture({ width, height }, place, picture) {
  const inside = (/** @type {number} */ value, /** @type {number} */ room) =>
    clamp(value, 3, Math.max(room - 3, 3));
  return {
    x: inside(place.x - width / 2, picture.width - width),
    y: inside(place.y - height / 2, picture.height - height),
    width,
    height,
  };
}

/**
 * Returns whether a point is covered by a label or close to it.
 * @param {Rectangle} at
 * @param {{ x: number, y: number }} point
 */
const isNear = (at, { x, y }) =>
  x > at.x - 5 && x < at.x + at.width + 5 && y > at.y - 5 && y < at.y + at.height + 5;

/**
 * Returns the path of a line from the edge of a label to its nearest anchor. The path is empty if that anchor
 * is close.
 * @param {Rectangle} at
 * @param {number[][]} anchors
 */
function leaderTo(at, anchors) {
  const lines = anchors.map(([x, y]) => {
    const from = [clamp(x, at.x + 8, at.x + at.width - 8), clamp(y, at.y, at.y + at.height)];
    return { from, to: [x, y], length: Math.hypot(x - from[0], y - from[1]) };
  });
  const { from, to, length } = lines.reduce((a, b) => (b.length < a.length ? b : a));
  const words = (/** @type {number[]} */ point) => point.map((value) => value.toFixed(1)).join(" ");
  return length < 9 ? "" : `M${words(from)}L${words(to)}`;
}

/**
 * Estimates the width of a text.
 * @param {string} text
 * @param {number} size px
 */
const textWidth = (text, size) => [...text].length * size * 0.56 + 14;

/**
 * Returns places round a spot, the nearest first.
 * @param {ScreenPoint} at
 * @param {number} width
 * @returns {LabelPlace[]}
 */
function placesRound(at, width) {
  const directions = [
    [1, -1],
    [-1, -1],
    [1, 1],
    [-1, 1],
    [0, -1.3],
    [0, 1.3],
  ];
  return [1, 2.2, 3.6, 5.4, 7.5].flatMap((far) =>
    directions.map(([x, y]) => ({
      x: at.x + x * (width / 2 + 12 * far),
      y: at.y + y * (8 + 15 * far),
      cost: far,
    })),
  );
}

/**
 * Returns whether a point is inside an outline.
 * @param {{ left: number, right: number, top: number, bottom: number }} outline
 * @param {number} x
 * @param {number} y
 */
const isWithin = ({ left, right, top, bottom }, x, y) => x > left && x < right && y > top && y < bottom;

/**
 * Returns the outline of parts on the screen, places round it for a name, and anchors. Returns null if an
 * anchor is behind the camera.
 * @param {View} view
 * @param {Part[]} parts
 */
function outlineOf(view, parts) {
  /** @type {number[][]} */
  const anchors = [];
  for (const part of parts) {
    const pose = poseOf(view, part);
    for (const anchor of part.mesh.anchors) {
      const { x, y, visible } = seenAt(view, moved(pose, anchor));
      if (!visible) return null;
      anchors.push([x, y]);
    }
  }
  if (!anchors.length) return null;
  const [xs, ys] = [0, 1].map((axis) => anchors.map((anchor) => anchor[axis]));
  const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const [x, y] = [(left + right) / 2, (top + bottom) / 2];
  const places = [
    [x, top - 12],
    [x, bottom + 12],
    [x, bottom - 16],
    [right + 34, y],
    [left - 34, y],
    [mix(x, left, 0.6), bottom - 14],
    [mix(x, right, 0.6), bottom - 14],
    [left, top - 10],
    [right, top - 10],
    [left, bottom + 8],
    [right, bottom + 8],
    [x, y],
  ];
  return { left, right, top, bottom, anchors, places };
}

/**
 * Returns the points that labels should not cover: nodes and, at a higher cost, the arm.
 * @param {View} view
 */
function pointsToKeepClear(view) {
  const points = [];
  for (const field of shownFields(view)) {
    const step = Math.ceil(field.count / 600);
    for (let k = 0; k < field.count; k += step) {
      const { x, y } = seenAt(view, displaced(view, field, nodeAt(field, k)));
      points.push({ x, y, cost: 1.5 });
    }
  }
  const joints = view.frames.map((frame) => seenAt(view, frame.slice(12, 15)));
  joints.forEach((joint, k) => {
    const next = joints[k + 1] || joint;
    for (let step = 0; step < 6; step++) {
      const [x, y] = [mix(joint.x, next.x, step / 6), mix(joint.y, next.y, step / 6)];
      points.push({ x, y, cost: 2 });
    }
  });
  return points;
}
