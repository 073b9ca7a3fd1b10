// Signs of the nodes of an error map: the mark of every status, its shape and its meaning.
// Statuses, labels and glyphs come from NODE_SIGN_TABLE, which the program writes before this script.

/** Outline of a circle of radius 1. */
const CIRCLE = "M1 0A1 1 0 1 1-1 0A1 1 0 1 1 1 0Z";

const TABLE_ENTRIES = /** @type {[NodeStatus, NodeSignRecord][]} */ (Object.entries(NODE_SIGN_TABLE));

/**
 * Meaning and mark of every status of a node, as in the maps of `sweetspot map`.
 * @type {Record<NodeStatus, NodeSign>}
 */
const NODE_SIGNS = /** @type {any} */ (
  Object.fromEntries(TABLE_ENTRIES.map(([status, { label }]) => [status, { mark: status, text: label }]))
);

/**
 * Marks of the spots, which are not statuses of nodes.
 * @type {Record<"spot" | "refined", NodeSign>}
 */
const SPOT_SIGNS = {
  spot: { mark: "spot", text: "chosen spot" },
  refined: { mark: "diamond", text: "spot between the nodes" },
};

/**
 * Returns the path of a glyph.
 * @param {GlyphRecord} glyph
 */
const glyphPath = ({ ring, strokes }) =>
  (ring ? CIRCLE : "") +
  strokes.map((stroke) => `M${stroke.map(([x, y]) => `${x} ${y}`).join("L")}`).join("");

/**
 * Returns the shape of a status: a usable node is a dot.
 * @param {NodeSignRecord} record
 * @returns {MarkShape}
 */
const statusShape = ({ glyph }) =>
  glyph
    ? { path: glyphPath(glyph), tone: glyph.tone, dashed: glyph.dashed }
    : { path: CIRCLE, tone: "value", dashed: false };

/**
 * Shape of every mark within a square from -1 to 1 (y downwards), and its tone. The tone is a style sheet
 * class.
 * @type {Record<Mark, MarkShape>}
 */
const MARKS = /** @type {any} */ ({
  spot: { path: CIRCLE, tone: "pink", dashed: false },
  diamond: { path: "M0-1L1 0L0 1L-1 0Z", tone: "pink", dashed: false },
  ...Object.fromEntries(TABLE_ENTRIES.map(([status, record]) => [status, statusShape(record)])),
});

/** Marks in the order of their codes in the shader. */
const MARK_NAMES = /** @type {Mark[]} */ (Object.keys(MARKS));

/**
 * Returns the code of a mark in the shader.
 * @param {Mark} mark
 */
const markCode = (mark) => MARK_NAMES.indexOf(mark);

/** @param {number} value */
const glslNumber = (value) => value.toFixed(4);

/**
 * Returns the branch of the shader that measures how far (px) a pixel is from the lines of a glyph.
 * @param {NodeStatus} status
 * @param {GlyphRecord} glyph
 */
function glyphBranch(status, { ring, dashed, strokes }) {
  const lines = ring ? ["d = abs(r - px + 1.0);"] : [];
  if (dashed)
    lines.push("part = smoothstep(0.28, 0.42, abs(fract(atan(at.y, at.x) * 0.9549297) - 0.5) * 2.0);");
  for (const stroke of strokes) {
    // The y axis of a glyph points down. A stroke ends a little inside the ring.
    const points = stroke.map(([x, y]) => `vec2(${glslNumber(0.95 * x)}, ${glslNumber(-0.95 * y)})`);
    for (let k = 1; k < points.length; k++) {
      lines.push(`d = min(d, segment(at, ${points[k - 1]}, ${points[k]}) * px);`);
    }
  }
  return `if (sign_ == ${markCode(status)}) { ${lines.join(" ")} }`;
}

/** Branches of the shader for all statuses except "ok": a usable node is a dot. */
const GLYPH_BRANCHES = TABLE_ENTRIES.map(([status, { glyph }]) => (glyph ? glyphBranch(status, glyph) : ""))
  .filter((branch) => branch !== "")
  .join("\n    ");

/** @type {Record<Tone, Record<Theme, Colour>>} */
const TONES = {
  value: { light: colourOf("#22a884"), dark: colourOf("#22a884") },
  grey: { light: colourOf("#5b6570"), dark: colourOf("#9aa4af") },
  red: { light: colourOf("#cf222e"), dark: colourOf("#ff6b61") },
  orange: { light: colourOf("#b35900"), dark: colourOf("#f0a04b") },
  pink: { light: colourOf("#bf3989"), dark: colourOf("#ff7ac2") },
};

/**
 * Returns the style sheet classes of a mark: its tone, and whether its line is dashed.
 * @param {Mark} mark
 */
const markClass = (mark) => `ss-${MARKS[mark].tone}${MARKS[mark].dashed ? " ss-dashed" : ""}`;
