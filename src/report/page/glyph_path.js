// Glyphs of nodes as SVG, for the legend of the viewer and for the live page.

/** Path data of a glyph of NODE_SIGNS round a point; y points down. */
function glyphPath({ ring, strokes }, x, y, r) {
  const n = (v) => +v.toFixed(2);
  const circle = ring === "none" ? "" : `M${n(x - r)} ${n(y)}a${n(r)} ${n(r)} 0 1 0 ${n(2 * r)} 0a${n(r)} ${n(r)} 0 1 0 ${n(-2 * r)} 0`;
  const line = (stroke) => `M${stroke.map(([dx, dy]) => `${n(x + dx * r)} ${n(y + dy * r)}`).join("L")}`;
  return circle + strokes.map(line).join("");
}
