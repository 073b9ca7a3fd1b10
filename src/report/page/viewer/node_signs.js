// Signs of the nodes of an error map: the mark of every status, its shape and its meaning.

/**
 * Meaning and mark of every status of a node, as in the maps of `sweetspot map`.
 * @type {Record<NodeStatus, NodeSign>}
 */
const NODE_SIGNS = {
  ok: { mark: "dot", text: "usable node" },
  "out-of-reach": { mark: "ring", text: "out of reach" },
  "joint-limit": { mark: "dashed", text: "beyond a joint limit" },
  attitude: { mark: "slashed", text: "orientation not reachable" },
  "not-converged": { mark: "box", text: "no solution found" },
  collision: { mark: "cross", text: "collides" },
  singular: { mark: "plus", text: "nearly singular" },
  approach: { mark: "down", text: "no free approach" },
  retract: { mark: "up", text: "no free retract" },
  unjudged: { mark: "bar", text: "not evaluated" },
};

/**
 * Marks of the spots, which are no status of a node.
 * @type {Record<"spot" | "refined", NodeSign>}
 */
const SPOT_SIGNS = {
  spot: { mark: "spot", text: "chosen spot" },
  refined: { mark: "diamond", text: "spot between the nodes" },
};

/** Outline of a circle of radius 1. */
const CIRCLE = "M1 0A1 1 0 1 1-1 0A1 1 0 1 1 1 0Z";

/**
 * Shape of every mark within a square from -1 to 1 (y downwards), and its tone, a class of the style sheet.
 * @type {Record<Mark, MarkShape>}
 */
const MARKS = {
  dot: { path: CIRCLE, tone: "value" },
  ring: { path: CIRCLE, tone: "grey" },
  dashed: { path: CIRCLE, tone: "grey" },
  slashed: { path: `${CIRCLE}M-.7 .7L.7-.7`, tone: "grey" },
  box: { path: "M-.8-.8H.8V.8H-.8Z", tone: "grey" },
  cross: { path: "M-.8-.8L.8 .8M.8-.8L-.8 .8", tone: "red" },
  plus: { path: "M-1 0H1M0-1V1", tone: "orange" },
  down: { path: "M-1-.6L0 .7L1-.6", tone: "red" },
  up: { path: "M-1 .6L0-.7L1 .6", tone: "red" },
  bar: { path: "M-1 0H1", tone: "grey" },
  spot: { path: CIRCLE, tone: "pink" },
  diamond: { path: "M0-1L1 0L0 1L-1 0Z", tone: "pink" },
};

/** Marks in the order of their codes in the shader. */
const MARK_NAMES = /** @type {Mark[]} */ (Object.keys(MARKS));

/**
 * Code of a mark in the shader.
 * @param {Mark} mark
 */
const markCode = (mark) => MARK_NAMES.indexOf(mark);

/** Declarations of the codes in GLSL. */
const MARK_CODES = MARK_NAMES.map((mark) => `const int ${mark.toUpperCase()} = ${markCode(mark)};`).join(
  "\n",
);

/** @type {Record<Tone, Record<Theme, Colour>>} */
const TONES = {
  value: { light: colourOf("#22a884"), dark: colourOf("#22a884") },
  grey: { light: colourOf("#5b6570"), dark: colourOf("#9aa4af") },
  red: { light: colourOf("#cf222e"), dark: colourOf("#ff6b61") },
  orange: { light: colourOf("#b35900"), dark: colourOf("#f0a04b") },
  pink: { light: colourOf("#bf3989"), dark: colourOf("#ff7ac2") },
};

/**
 * Class of a mark in the style sheet: its tone, and whether its line is dashed.
 * @param {Mark} mark
 */
const markClass = (mark) => `ss-${MARKS[mark].tone}${mark === "dashed" ? " ss-dashed" : ""}`;
