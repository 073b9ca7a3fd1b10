// Vectors and matrices. A vector has three numbers, a matrix 16 numbers column by column; lengths are in mm.

/**
 * Adds two vectors.
 * @param {Vector} a
 * @param {Vector} b
 * @returns {Vector}
 */
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];

/**
 * Subtracts vector `b` from vector `a`.
 * @param {Vector} a
 * @param {Vector} b
 * @returns {Vector}
 */
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

/**
 * Multiplies a vector by a number.
 * @param {Vector} vector
 * @param {number} factor
 * @returns {Vector}
 */
const scaled = (vector, factor) => [vector[0] * factor, vector[1] * factor, vector[2] * factor];

/**
 * Returns the dot product.
 * @param {Vector} a
 * @param {Vector} b
 */
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/**
 * Returns the cross product.
 * @param {Vector} a
 * @param {Vector} b
 * @returns {Vector}
 */
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/**
 * Returns the length of a vector.
 * @param {Vector} vector
 */
const norm = (vector) => Math.hypot(vector[0], vector[1], vector[2]);

/**
 * Returns the unit vector of a direction.
 * @param {Vector} vector
 */
const normalized = (vector) => scaled(vector, 1 / (norm(vector) || 1));

/**
 * Limits a value to a range.
 * @param {number} value
 * @param {number} low
 * @param {number} high
 */
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/**
 * Interpolates linearly.
 * @param {number} a
 * @param {number} b
 * @param {number} share
 */
const mix = (a, b, share) => a + (b - a) * share;

/** @type {Matrix} */
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/**
 * Multiplies two matrices.
 * @param {Matrix} a
 * @param {Matrix} b
 * @returns {Matrix}
 */
function product(a, b) {
  const result = new Array(16);
  for (let column = 0; column < 4; column++) {
    const [x, y, z, w] = b.slice(4 * column, 4 * column + 4);
    for (let row = 0; row < 4; row++) {
      result[4 * column + row] = a[row] * x + a[4 + row] * y + a[8 + row] * z + a[12 + row] * w;
    }
  }
  return result;
}

/**
 * Returns a pose of a document as a matrix.
 * @param {PoseRecord} pose
 * @returns {Matrix}
 */
function matrixOf(pose) {
  const column = (/** @type {number} */ first) => pose.slice(first, first + 3);
  return [...column(0), 0, ...column(3), 0, ...column(6), 0, ...column(9), 1];
}

/**
 * Inverts a rigid motion.
 * @param {Matrix} m
 * @returns {Matrix}
 */
function inverse(m) {
  const origin = [m[12], m[13], m[14]];
  const back = [0, 4, 8].map((column) => -dot(m.slice(column, column + 3), origin));
  return [m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, ...back, 1];
}

/**
 * Rotates a direction by the rotation part of a matrix.
 * @param {Matrix} m
 * @param {Vector} direction
 * @returns {Vector}
 */
const rotated = (m, direction) =>
  [0, 1, 2].map((row) => m[row] * direction[0] + m[4 + row] * direction[1] + m[8 + row] * direction[2]);

/**
 * Moves a point by a rigid motion.
 * @param {Matrix} m
 * @param {Vector} point
 * @returns {Vector}
 */
const moved = (m, point) =>
  [0, 1, 2].map((row) => m[row] * point[0] + m[4 + row] * point[1] + m[8 + row] * point[2] + m[12 + row]);

/**
 * Returns the four homogeneous coordinates of a point.
 * @param {Matrix} m
 * @param {Vector} point
 */
const projected = (m, point) =>
  [0, 1, 2, 3].map((row) => m[row] * point[0] + m[4 + row] * point[1] + m[8 + row] * point[2] + m[12 + row]);

/**
 * Returns the pose of an upright frame.
 * @param {Vector} origin
 * @param {number} yaw rad
 */
function uprightPose(origin, yaw) {
  const [cosine, sine] = [Math.cos(yaw), Math.sin(yaw)];
  return [cosine, sine, 0, 0, -sine, cosine, 0, 0, 0, 0, 1, 0, ...origin, 1];
}

/**
 * Returns a perspective projection.
 * @param {number} fieldOfView vertical, rad
 * @param {number} aspect width divided by height
 * @param {number} near
 * @param {number} far
 * @returns {Matrix}
 */
function perspective(fieldOfView, aspect, near, far) {
  const focal = 1 / Math.tan(fieldOfView / 2);
  const depth = near - far;
  return [
    focal / aspect,
    0,
    0,
    0,
    0,
    focal,
    0,
    0,
    0,
    0,
    (far + near) / depth,
    -1,
    0,
    0,
    (2 * far * near) / depth,
    0,
  ];
}

/**
 * Returns an orthographic projection.
 * @param {number} width mm
 * @param {number} height mm
 * @param {number} near
 * @param {number} far
 * @returns {Matrix}
 */
function orthographic(width, height, near, far) {
  const depth = near - far;
  return [2 / width, 0, 0, 0, 0, 2 / height, 0, 0, 0, 0, 2 / depth, 0, 0, 0, (far + near) / depth, 1];
}

/**
 * Returns the view matrix: from the world to an eye with these axes.
 * @param {Vector} eye
 * @param {Vector} right
 * @param {Vector} up
 * @param {Vector} back
 * @returns {Matrix}
 */
function viewMatrix(eye, right, up, back) {
  const axes = [0, 1, 2].flatMap((k) => [right[k], up[k], back[k], 0]);
  return [...axes, -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
}

/**
 * Decodes base64.
 * @param {EncodedArray} text
 */
function bytesOf(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return bytes.buffer;
}

/**
 * Decodes 32-bit floats.
 * @param {EncodedArray} text
 */
const floatsOf = (text) => new Float32Array(bytesOf(text));

/**
 * Decodes 32-bit unsigned integers.
 * @param {EncodedArray} text
 */
const integersOf = (text) => new Uint32Array(bytesOf(text));
