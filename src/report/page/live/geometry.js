// Geometry of the plan: placements, shapes and colours.

const SVG_NAMESPACE = "http://www.w3.org/2000/svg";

/** Viridis (N. Smith, S. van der Walt and E. Firing; CC0) at equal steps. */
const VIRIDIS = [
  [68, 1, 84],
  [65, 68, 135],
  [42, 120, 142],
  [34, 168, 132],
  [122, 209, 81],
  [253, 231, 37],
];

/**
 * Returns the colour at a share from 0 to 1.
 * @param {number} share
 */
function colourAt(share) {
  const place = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1);
  const k = Math.min(Math.floor(place), VIRIDIS.length - 2);
  const channels = VIRIDIS[k].map((low, i) => Math.round(low + (VIRIDIS[k + 1][i] - low) * (place - k)));
  return `rgb(${channels.join(" ")})`;
}

/**
 * Makes an SVG element.
 * @template {keyof SVGElementTagNameMap} Name
 * @param {Name} name
 * @param {Record<string, string | number>} [attributes]
 * @param {(Node | string)[]} children
 * @returns {SVGElementTagNameMap[Name]}
 */
function svg(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG_NAMESPACE, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  made.append(...children);
  return made;
}

/**
 * Rotates a point of the plane.
 * @param {number[]} point
 * @param {number} angle deg
 */
function rotated([x, y], angle) {
  const [cosine, sine] = [Math.cos((angle * Math.PI) / 180), Math.sin((angle * Math.PI) / 180)];
  return [x * cosine - y * sine, x * sine + y * cosine];
}

/**
 * Returns a placement in the frame of another placement.
 * @param {Placement} at
 * @param {Placement} base
 * @returns {Placement}
 */
function placementIn(at, base) {
  const [x, y] = rotated([at[0] - base[0], at[1] - base[1]], -base[3]);
  return [x, y, at[2] - base[2], at[3] - base[3]];
}

/**
 * Returns the placement in the world of a placement that is given in the frame of another placement.
 * @param {Placement} own
 * @param {Placement} base
 * @returns {Placement}
 */
function placementFrom(own, base) {
  const [x, y] = rotated(own, base[3]);
  return [base[0] + x, base[1] + y, base[2] + own[2], base[3] + own[3]];
}

/**
 * Returns the value of a list that is nearest to a given value.
 * @param {number[]} list
 * @param {number} value
 */
const nearest = (list, value) =>
  list.reduce((best, one) => (Math.abs(one - value) < Math.abs(best - value) ? one : best));

/**
 * Returns the least distance between neighbouring nodes, mm.
 * @param {OperationAnswer} operation
 */
function nodeSpacing({ nodes: { at } }) {
  const distances = at.slice(1, 60).map((point, k) => Math.hypot(point[0] - at[k][0], point[1] - at[k][1]));
  return Math.min(...distances.filter((distance) => distance > 0), 1000);
}
