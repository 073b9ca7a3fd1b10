// Labels in the picture as HTML, placed where they cover the least.

/**
 * Makes the layer of labels, the lines that lead to them, and the world axes.
 * @param {Element} stage
 */
function makeLabels(stage) {
  const layer = element("div", { class: "ss-labels", "aria-hidden": "true" });
  const leaders = drawn("g", { class: "ss-leads" });
  const axes = ["x", "y", "z"].map((name) => drawn("line", { class: `ss-${name}` }));
  stage.append(drawn("svg", { class: "ss-over", "aria-hidden": "true" }, leaders, ...axes), layer);
  return {
    layer,
    leaders,
    axes,
    /**
     * Elements that are made once and used again.
     * @type {{ text: HTMLSpanElement, leader: SVGPathElement }[]}
     */
    pool: [],
    /**
     * Index of the last place of each label.
     * @type {Map<string, number>}
     */
    places: new Map(),
  };
}

/** @typedef {ReturnType<typeof makeLabels>} Labels */

/**
 * Places and shows all labels of a picture.
 * @param {View} view
 * @param {Labels} labels
 */
function drawLabels(view, labels) {
  const names = arrange(labels, labelBoxes(view), pointsToKeepClear(view), view);
  showLabels(labels, [...floorNumbers(view), ...axisLabels(view, labels), ...names]);
}

/**
 * Shows labels in the elements of the pool.
 * @param {Labels} labels
 * @param {Label[]} wanted
 */
function showLabels(labels, wanted) {
  while (labels.pool.length < wanted.length) {
    const [text, leader] = [element("span"), drawn("path")];
    labels.layer.append(text);
    labels.leaders.append(leader);
    labels.pool.push({ text, leader });
  }
  labels.pool.forEach(({ text, leader }, k) => {
    const label = wanted[k];
    text.hidden = !label;
    leader.setAttribute("d", label?.leader || "");
    if (!label) return;
    if (text.textContent !== label.text) text.textContent = label.text;
    text.className = `ss-label ss-${label.kind}`;
    leader.setAttribute("class", `ss-lead-${label.kind}`);
    text.style.transform = `translate(${label.x.toFixed(1)}px, ${label.y.toFixed(1)}px)`;
  });
}

/**
 * Returns the labels to be placed, the most important first.
 * @param {View} view
 * @returns {LabelBox[]}
 */
const labelBoxes = (view) => [...spotLabels(view), ...equipmentLabels(view)];

/**
 * Returns the labels of the spots: name of the operation and value.
 * @param {View} view
 */
function spotLabels(view) {
  /** @type {LabelBox[]} */
  const boxes = [];
  for (const field of shownFields(view)) {
    const spot = spotOf(view, field);
    const at = spot && seenAt(view, spot);
    if (!at?.visible) continue;
    const name = view.drawing.operations[field.operation].name;
    const text = `${shortName(name)}  ${spotValue(view, field)}`;
    // The text is bold.
    const width = textWidth(text, 15) + 4;
    const places = placesRound(at, width);
    const key = `operation ${field.operation}`;
    boxes.push({
      key,
      text,
      kind: "spot",
      required: true,
      width,
      height: 24,
      places,
      anchors: [[at.x, at.y]],
    });
  }
  return boxes;
}

/**
 * Returns the labels of equipment and keep-out zones.
 * @param {View} view
 */
function equipmentLabels(view) {
  const { drawing } = view;
  const named = drawing.equipment.map(({ name }, k) => ({
    name,
    parts: drawing.parts.filter((part) => part.equipment === k),
  }));
  for (const part of drawing.parts) {
    if (part.kind === "keep-out") named.push({ name: part.name, parts: [part] });
  }
  const outlines = named.map(({ parts }) => outlineOf(view, parts));
  /** @type {LabelBox[]} */
  const boxes = [];
  outlines.forEach((outline, k) => {
    if (!outline) return;
    const text = shortName(named[k].name);
    const others = outlines.filter((other, n) => other && n !== k);
    const places = outline.places.map(([x, y]) => ({
      x,
      y,
      cost: 4 * others.filter((other) => other && isWithin(other, x, y)).length,
    }));
    const width = textWidth(text, 12);
    const { anchors } = outline;
    boxes.push({ key: `equipment ${k}`, text, kind: "name", width, height: 18, places, anchors });
  });
  return boxes;
}

/**
 * Formats the value of an error map at its spot.
 * @param {View} view
 * @param {Field} field
 */
function spotValue(view, field) {
  const sense = senseIn(field, view.state.sense);
  const take = field.takes[view.lens];
  if (!take || take.best === null) return "";
  return `${figure(take.values[sense][take.best])} ${field.senses[sense].unit}`;
}
