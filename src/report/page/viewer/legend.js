// The legend: what colours, arrows and marks mean.

/** Length of the bars in the legend, px. */
const BAR_LENGTH = 110;

/**
 * Marks of solids and lines, which are not nodes.
 * @type {Record<string, { text: string, shape: () => SVGElement }>}
 */
const OTHER_SIGNS = {
  envelope: {
    text: "reach at the height of the work",
    shape: () => drawn("path", { d: "M1 13q9 -13 18 0", class: "ss-blue" }),
  },
  around: {
    text: "reach at other heights",
    shape: () => drawn("path", { d: "M1 13q9 -13 18 0", class: "ss-blue ss-faint" }),
  },
  fence: {
    text: "fence",
    shape: () => drawn("rect", { x: 2, y: 4, width: 16, height: 12, class: "ss-fence" }),
  },
  "keep-out": {
    text: "keep-out zone",
    shape: () => drawn("rect", { x: 2, y: 4, width: 16, height: 12, class: "ss-keep-out" }),
  },
  ghost: {
    text: "equipment in the other layout",
    shape: () => drawn("rect", { x: 2.5, y: 4.5, width: 15, height: 11, class: "ss-ghost" }),
  },
};

/**
 * Makes the legend.
 * @param {Element} host
 */
function makeLegend(host) {
  const box = element("div", { class: "ss-legend" });
  host.append(box);
  return box;
}

/**
 * Shows the legend of a view.
 * @param {Element} box
 * @param {View} view
 */
function showLegend(box, view) {
  box.replaceChildren(colourKey(view), arrowKey(view), signKey(view));
}

/**
 * Makes a paragraph.
 * @param {string} text
 */
const paragraph = (text) => element("p", { textContent: text });

/**
 * Makes a span.
 * @param {string} text
 */
const span = (text) => element("span", { textContent: text });

/**
 * Returns the name of the sense shown or, if none is chosen, the names of the operations' own senses.
 * @param {View} view
 */
function senseWords(view) {
  if (view.state.sense !== null) return view.state.sense;
  const own = shownFields(view).map((field) => field.senses[field.sense].name);
  return [...new Set(own)].join(", ");
}

/**
 * Explains the colours.
 * @param {View} view
 */
function colourKey(view) {
  const { scale } = view;
  const { reading, model } = view.drawing.lenses[view.lens];
  const box = element("div", { class: "ss-key" });
  const what = `${senseWords(view)}, ${reading}, ${model}`;
  if (scale.comparison) {
    const { other, greatest, unit } = scale.comparison;
    box.append(paragraph(`Compared with ${shortName(other.name)}: error in ${what}`));
    box.append(
      colourBar(DIVERGING, `${figure(greatest)} ${unit} better`, `${figure(greatest)} ${unit} worse`),
    );
    return box;
  }
  box.append(paragraph(`Error in ${what}`));
  const ranges = Object.entries(scale.ranges);
  for (const [unit, { low, high }] of ranges) {
    box.append(colourBar(VIRIDIS, `${figure(low)} ${unit}`, `${figure(high)} ${unit}`));
  }
  if (!ranges.length) box.append(paragraph("no usable node"));
  return box;
}

/**
 * Makes the bar of a colour scale.
 * @param {number[][]} scale
 * @param {string} low
 * @param {string} high
 */
function colourBar(scale, low, high) {
  const strip = element("div", { class: "ss-bar" });
  strip.style.background = gradientOf(scale);
  return element("div", {}, strip, element("div", { class: "ss-ends" }, span(low), span(high)));
}

/**
 * Returns the scale bars of the arrows and of the cell. The lengths of the bars hold at the distance of the
 * camera's target.
 * @param {View} view
 */
function arrowKey(view) {
  const box = element("div", { class: "ss-key" });
  if (view.state.arrows === "none") return box;
  const { pixelsPerMm } = view.optics;
  const { magnification } = view;
  const factor = magnification >= 1 ? String(magnification) : figure(magnification);
  box.append(paragraph(`Arrows: ${arrowWords(view)}, magnified ${factor} \u00d7`));
  const where = view.camera.parallel ? "" : " (picture centre)";
  box.append(scaleBar(pixelsPerMm * magnification, `error${where}`));
  box.append(scaleBar(pixelsPerMm, `in the cell${where}`));
  return box;
}

/**
 * Describes what the arrows show.
 * @param {View} view
 */
function arrowWords(view) {
  const { arrows } = view.state;
  const { signed } = view.drawing.lenses[view.lens];
  if (arrows === "resultant") return signed ? "resultant error" : "resultant error at the worst corner";
  const what = arrows === "components" ? "x, y and z error" : `${arrows} error`;
  return signed ? what : `${what}, in both directions (plus or minus)`;
}

/**
 * Makes a scale bar of a round length.
 * @param {number} pixelsPerMm
 * @param {string} what
 */
function scaleBar(pixelsPerMm, what) {
  const length = roundDown(BAR_LENGTH / pixelsPerMm);
  const line = element("span", { class: "ss-scale" });
  line.style.width = `${(length * pixelsPerMm).toFixed(1)}px`;
  return element("div", { class: "ss-scalebar" }, line, span(`${roundFigure(length)} mm ${what}`));
}

/**
 * Returns the list of the signs that are in the picture.
 * @param {View} view
 */
function signKey(view) {
  const fields = shownFields(view);
  const statuses = new Set(fields.flatMap((field) => field.status));
  /** @type {{ mark: Mark, text: string }[]} */
  const signs = Object.entries(NODE_SIGNS).flatMap(([status, sign]) =>
    statuses.has(/** @type {NodeStatus} */ (status)) ? [sign] : [],
  );
  if (fields.some((field) => spotOf(view, field))) signs.push(SPOT_SIGNS.spot);
  if (fields.some((field) => refinedSpotOf(view, field))) signs.push(SPOT_SIGNS.refined);
  /** @type {Set<string>} */
  const others = new Set(view.drawing.parts.map((part) => part.kind));
  if (view.state.envelope && view.drawing.envelopes.length) others.add("envelope").add("around");
  if (view.scale.comparison) others.add("ghost");
  const items = signs.map(({ mark, text }) => signItem(markShape(mark), text));
  for (const [name, { text, shape }] of Object.entries(OTHER_SIGNS)) {
    if (others.has(name)) items.push(signItem(shape(), text));
  }
  return element("ul", { class: "ss-signs" }, ...items);
}

/**
 * Makes an entry of the list of signs.
 * @param {SVGElement} shape
 * @param {string} text
 */
function signItem(shape, text) {
  const size = { viewBox: "0 0 20 20", width: 18, height: 18, "aria-hidden": "true" };
  return element("li", {}, drawn("svg", size, shape), span(text));
}

/**
 * Returns a mark in the middle of a square of 20 units.
 * @param {Mark} mark
 */
function markShape(mark) {
  const { path } = MARKS[mark];
  const radius = mark === "ok" ? 4.5 : 6.5;
  const shape = drawn("path", { d: path, class: markClass(mark) });
  shape.setAttribute("transform", `translate(10 10) scale(${radius})`);
  return shape;
}
