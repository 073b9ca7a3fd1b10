// Colours, numbers and names as they are shown.

/**
 * Returns a colour as three numbers from 0 to 1.
 * @param {string} text `#rrggbb`
 * @returns {Colour}
 */
const colourOf = (text) => [1, 3, 5].map((k) => Number.parseInt(text.slice(k, k + 2), 16) / 255);

/** Viridis at equal steps, as in src/core/colours.rs. */
const VIRIDIS = [
  [68, 1, 84],
  [65, 68, 135],
  [42, 120, 142],
  [34, 168, 132],
  [122, 209, 81],
  [253, 231, 37],
];

/** Colours from better (blue) through equal (grey) to worse (vermilion). */
const DIVERGING = [
  [0, 94, 158],
  [86, 160, 214],
  [216, 218, 222],
  [230, 140, 60],
  [196, 74, 0],
];

/**
 * Returns the colour at a share from 0 to 1 of a scale.
 * @param {number[][]} scale
 * @param {number} share
 */
function colourOn(scale, share) {
  const at = clamp(share, 0, 1) * (scale.length - 1);
  const k = Math.min(Math.floor(at), scale.length - 2);
  return [0, 1, 2].map((channel) => mix(scale[k][channel], scale[k + 1][channel], at - k) / 255);
}

/**
 * Returns a colour scale as a CSS gradient.
 * @param {number[][]} scale
 */
const gradientOf = (scale) =>
  `linear-gradient(90deg, ${scale.map((channels) => `rgb(${channels.join(",")})`).join(", ")})`;

/**
 * Returns the greatest round number that is not greater than a value.
 * @param {number} value
 */
function roundDown(value) {
  if (!(value > 0) || !Number.isFinite(value)) return 1;
  const ten = 10 ** Math.floor(Math.log10(value));
  const step = [8, 6, 5, 4, 3, 2.5, 2, 1.5, 1].find((s) => s * ten <= value * (1 + 1e-9)) || 1;
  return Number((step * ten).toPrecision(2));
}

/**
 * Formats a value with four significant digits, but at most four decimals, and without an exponent.
 * @param {number} value
 */
function figure(value) {
  if (!Number.isFinite(value)) return "-";
  const digits = value === 0 ? 0 : clamp(3 - Math.floor(Math.log10(Math.abs(value))), 0, 4);
  return value.toFixed(digits);
}

/**
 * Formats a value with two significant digits.
 * @param {number} value
 */
const roundFigure = (value) => String(Number(value.toPrecision(2)));

/**
 * Shortens a long name.
 * @param {string} name
 */
const shortName = (name) => ([...name].length > 32 ? `${[...name].slice(0, 31).join("")}\u2026` : name);
