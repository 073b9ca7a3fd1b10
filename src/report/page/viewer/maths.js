// Vectors are arrays of three numbers, matrices 16 numbers column by column, lengths mm.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const size = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => times(a, 1 / (size(a) || 1));
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
const mix = (a, b, t) => a + (b - a) * t;

const UNMOVED = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

function product(a, b) {
  const out = new Array(16);
  for (let c = 0; c < 4; c++) {
    for (let r = 0; r < 4; r++) {
      out[4 * c + r] = a[r] * b[4 * c] + a[4 + r] * b[4 * c + 1] + a[8 + r] * b[4 * c + 2] + a[12 + r] * b[4 * c + 3];
    }
  }
  return out;
}

/** A pose of 12 numbers (columns of the rotation, origin) as a matrix. */
function matrix(p, at = 0) {
  return [p[at], p[at + 1], p[at + 2], 0, p[at + 3], p[at + 4], p[at + 5], 0, p[at + 6], p[at + 7], p[at + 8], 0,
    p[at + 9], p[at + 10], p[at + 11], 1];
}

/** Of a rigid motion. */
function inverse(m) {
  const o = [m[12], m[13], m[14]];
  const back = [0, 4, 8].map((c) => -(m[c] * o[0] + m[c + 1] * o[1] + m[c + 2] * o[2]));
  return [m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, back[0], back[1], back[2], 1];
}

const moved = (m, p) => [0, 1, 2].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
const turned = (m, p) => [0, 1, 2].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2]);

/** With the fourth coordinate, for projections. */
function projected(m, p) {
  return [0, 1, 2, 3].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
}

function upright(x, y, z, yaw) {
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  return [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, x, y, z, 1];
}

function perspective(fov, aspect, near, far) {
  const f = 1 / Math.tan(fov / 2);
  const d = near - far;
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / d, -1, 0, 0, (2 * far * near) / d, 0];
}

function parallel(width, height, near, far) {
  const d = near - far;
  return [2 / width, 0, 0, 0, 0, 2 / height, 0, 0, 0, 0, 2 / d, 0, 0, 0, (far + near) / d, 1];
}

/** From the world to an eye with the axes right, up and back. */
function lookFrom(eye, right, up, back) {
  const row = (k) => [right[k], up[k], back[k], 0];
  return [...row(0), ...row(1), ...row(2), -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
}

function bytes(text) {
  const raw = atob(text);
  const out = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) out[k] = raw.charCodeAt(k);
  return out.buffer;
}
const floats = (text) => new Float32Array(bytes(text));
const integers = (text) => new Uint32Array(bytes(text));

const hex = (text) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16) / 255);

// viridis at equal steps, as in src/report/legend.rs.
const VIRIDIS = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81], [253, 231, 37]];
// Better, the same, worse: blue to vermilion of Okabe and Ito.
const DIVERGING = [[0, 94, 158], [86, 160, 214], [216, 218, 222], [230, 140, 60], [196, 74, 0]];

function colourOn(scale, t) {
  const at = clamp(t, 0, 1) * (scale.length - 1);
  const k = Math.min(Math.floor(at), scale.length - 2);
  return [0, 1, 2].map((c) => mix(scale[k][c], scale[k + 1][c], at - k) / 255);
}

const gradient = (scale) => `linear-gradient(90deg, ${scale.map((c) => `rgb(${c.join(",")})`).join(", ")})`;

/** The largest number of one digit, or of 1.5, 2.5 with tens, that is no larger. */
function roundDown(value) {
  if (!(value > 0) || !isFinite(value)) return 1;
  const ten = 10 ** Math.floor(Math.log10(value));
  const step = [8, 6, 5, 4, 3, 2.5, 2, 1.5, 1].find((s) => s * ten <= value * (1 + 1e-9)) || 1;
  return Number((step * ten).toPrecision(2));
}

/** A figure as it is read: four digits, no exponent. */
function figure(value) {
  if (!isFinite(value)) return "-";
  const digits = value === 0 ? 0 : clamp(3 - Math.floor(Math.log10(Math.abs(value))), 0, 4);
  return value.toFixed(digits);
}
