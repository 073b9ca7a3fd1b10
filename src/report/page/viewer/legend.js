// What the colours, arrows and signs mean.

const NS = "http://www.w3.org/2000/svg";

function drawn(name, attributes, ...children) {
  const made = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const icon = (...children) => drawn("svg", { viewBox: "0 0 20 20", width: "18", height: "18", "aria-hidden": "true" }, ...children);

const ICONS = {
  spot: () => icon(drawn("circle", { cx: 10, cy: 10, r: 7, class: "ss-pink" })),
  diamond: () => icon(drawn("path", { d: "M10 2.5l7.5 7.5l-7.5 7.5l-7.5 -7.5z", class: "ss-pink" })),
  envelope: () => icon(drawn("path", { d: "M1 13q9 -13 18 0", class: "ss-blue" })),
  around: () => icon(drawn("path", { d: "M1 13q9 -13 18 0", class: "ss-blue ss-faint" })),
  fence: () => icon(drawn("rect", { x: 2, y: 4, width: 16, height: 12, class: "ss-fence" })),
  "keep-out": () => icon(drawn("rect", { x: 2, y: 4, width: 16, height: 12, class: "ss-keep-out" })),
  ghost: () => icon(drawn("rect", { x: 2.5, y: 4.5, width: 15, height: 11, class: "ss-ghost" })),
};

const WORDS = {
  spot: "chosen spot",
  diamond: "spot between the nodes",
  envelope: "reach at the height of the work",
  around: "reach elsewhere",
  fence: "fence",
  "keep-out": "to be kept free",
  ghost: "equipment in the other layout",
};

for (const [name, { label, glyph }] of Object.entries(NODE_SIGNS)) {
  WORDS[name] = label;
  ICONS[name] = () => icon(glyph
    ? drawn("path", { d: glyphPath(glyph, 10, 10, 7), class: `ss-${glyph.tone}`, "stroke-dasharray": glyph.ring === "dashed" ? "3.4 3.4" : "none" })
    : drawn("circle", { cx: 10, cy: 10, r: 4.5, class: "ss-dot" }));
}

function makeLegend(host) {
  const box = element("div", { class: "ss-legend" });
  host.append(box);
  return box;
}

function showLegend(box, view) {
  box.replaceChildren(colourKey(view), arrowKey(view), signKey(view));
}

/** Name of the sense looked at: one, or those of the operations. */
function senseWords(view) {
  if (view.state.sense !== null) return view.state.sense;
  const own = shownFields(view.drawing, view.state.operation).map((f) => f.senses[f.sense].name);
  return [...new Set(own)].join(", ");
}

function colourKey(view) {
  const lens = view.drawing.lenses[view.lens];
  const box = element("div", { class: "ss-key" });
  if (view.lens < 0) {
    box.append(element("p", { textContent: "This layout has no answer under this reading and model." }));
    return box;
  }
  const { scale } = view;
  if (scale.other) {
    box.append(element("p", { textContent: `Against ${short(scale.other.name)} in ${senseWords(view)}, ${lens.reading}, ${lens.model}` }));
    box.append(bar(DIVERGING, `${figure(scale.most)} ${scale.unit} better`, `${figure(scale.most)} ${scale.unit} worse`));
    return box;
  }
  box.append(element("p", { textContent: `Error in ${senseWords(view)}, ${lens.reading}, ${lens.model}` }));
  for (const [word, range] of Object.entries(scale.ranges)) {
    box.append(bar(VIRIDIS, `${figure(range.low)} ${word}`, `${figure(range.high)} ${word}`));
  }
  if (!Object.keys(scale.ranges).length) box.append(element("p", { textContent: "no usable node" }));
  return box;
}

function bar(scale, low, high) {
  const strip = element("div", { class: "ss-bar" });
  strip.style.background = gradient(scale);
  const ends = element("div", { class: "ss-ends" }, element("span", { textContent: low }), element("span", { textContent: high }));
  return element("div", {}, strip, ends);
}

/** The bar is as long in the picture as an arrow of so much error, at the distance of its middle. */
function arrowKey(view) {
  const box = element("div", { class: "ss-key" });
  if (view.state.arrows === "none" || view.lens < 0) return box;
  const signed = view.drawing.lenses[view.lens].signed;
  const what = view.state.arrows === "resultant" ? "resultant error" : view.state.arrows === "components" ? "x, y and z error" : `${view.state.arrows} error`;
  const sides = signed ? "" : view.state.arrows === "resultant" ? ", towards its worst corner" : ", to both sides (plus or minus)";
  const word = view.times >= 1 ? String(view.times) : figure(view.times);
  box.append(element("p", { textContent: `Arrows: ${what}${sides}, ${word} \u00d7 enlarged` }));
  const px = view.optics.pxPerMm * view.times;
  const length = roundDown(110 / px);
  const line = element("span", { class: "ss-scale" });
  line.style.width = `${(length * px).toFixed(1)}px`;
  const where = view.camera.parallel ? "" : " (mid-picture)";
  box.append(element("div", { class: "ss-scalebar" }, line, element("span", { textContent: `${figureOf(length)} mm of error${where}` })));
  const mm = roundDown(110 / view.optics.pxPerMm);
  const real = element("span", { class: "ss-scale" });
  real.style.width = `${(mm * view.optics.pxPerMm).toFixed(1)}px`;
  box.append(element("div", { class: "ss-scalebar" }, real, element("span", { textContent: `${figureOf(mm)} mm of cell${where}` })));
  return box;
}

const figureOf = (value) => String(Number(value.toPrecision(2)));

/** Only signs that are to be seen. */
function signKey(view) {
  const fields = shownFields(view.drawing, view.state.operation);
  const seen = new Set(fields.flatMap((f) => f.status));
  if (fields.some((f) => spotOf(view, f))) seen.add("spot");
  if (view.lens === 0 && fields.some((f) => f.refined_mm)) seen.add("diamond");
  if (view.state.envelope && view.drawing.envelopes.length) seen.add("envelope").add("around");
  for (const part of view.drawing.parts) if (part.kind === "fence" || part.kind === "keep-out") seen.add(part.kind);
  if (view.scale.other) seen.add("ghost");
  const order = [...Object.keys(NODE_SIGNS), ...Object.keys(WORDS).filter((sign) => !(sign in NODE_SIGNS))];
  const items = order.filter((sign) => seen.has(sign));
  return element("ul", { class: "ss-signs" }, ...items.map((sign) =>
    element("li", {}, ICONS[sign](), element("span", { textContent: WORDS[sign] }))));
}
