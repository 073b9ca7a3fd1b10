// The tip beside the node under the pointer.

/**
 * Makes the tip.
 * @param {Element} stage
 */
function makeTip(stage) {
  const box = element("div", { class: "ss-tip", role: "status" });
  box.hidden = true;
  stage.append(box);
  return box;
}

/**
 * Shows the tip beside the picked node.
 * @param {HTMLElement} box
 * @param {View} view
 */
function showTip(box, view) {
  const { picked, width, height } = view;
  box.hidden = !picked;
  if (!picked) return;
  const at = seenAt(view, displaced(view, picked.field, nodeAt(picked.field, picked.index)));
  box.replaceChildren(...nodeLines(view, picked).map((line) => element("div", { textContent: line })));
  const [boxWidth, boxHeight] = [box.offsetWidth, box.offsetHeight];
  const x = at.x + 16 + boxWidth > width ? at.x - 16 - boxWidth : at.x + 16;
  const y = clamp(at.y - boxHeight / 2, 4, Math.max(height - boxHeight - 4, 4));
  box.style.transform = `translate(${Math.max(x, 4).toFixed(0)}px, ${y.toFixed(0)}px)`;
}

/**
 * Describes a node, line by line.
 * @param {View} view
 * @param {NodeReference} node
 */
function nodeLines(view, { field, index }) {
  const { drawing } = view;
  const place = nodeAt(field, index).map((value) => value.toFixed(0));
  const [i, j] = field.nodes[index];
  const lines = [
    `${drawing.operations[field.operation].name}, node (${i}, ${j})`,
    `at ${place.join(", ")} mm`,
  ];
  const status = field.status[index];
  if (status === "ok") lines.push(...errorLines(view, field, index));
  else lines.push(field.reason[index] || NODE_SIGNS[status].text);
  const joints = field.joints[index];
  if (joints) lines.push(joints.map((value, k) => jointWords(drawing.joints[k], value)).join("  "));
  return lines;
}

/**
 * Describes values and error of a usable node.
 * @param {View} view
 * @param {Field} field
 * @param {number} index
 */
function errorLines(view, field, index) {
  const { drawing, lens, scale } = view;
  const { reading, model, signed } = drawing.lenses[lens];
  const lines = [`${reading}, ${model}:`];
  const shown = senseIn(field, view.state.sense);
  field.senses.forEach(({ name, unit }, sense) => {
    const value = field.takes[lens].values[sense][index];
    const marker = sense === shown ? "\u25b8 " : "   ";
    if (!Number.isNaN(value)) lines.push(`${marker}${name}  ${figure(value)} ${unit}`);
  });
  const error = errorAt(field, lens, index);
  if (error && signed) lines.push(`error ${error.map(figure).join(", ")} mm`);
  const difference = scale.comparison ? differenceAt(view, field, index) : null;
  if (scale.comparison && difference !== null) {
    const { other, unit } = scale.comparison;
    const word = difference > 0 ? "worse" : "better";
    lines.push(`${figure(Math.abs(difference))} ${unit} ${word} than in ${other.name}`);
  }
  return lines;
}

/**
 * Formats the name and the value of a joint.
 * @param {JointRecord} joint
 * @param {number} value
 */
const jointWords = ({ name, unit }, value) =>
  `${name} ${value.toFixed(1)}${unit === "deg" ? "\u00b0" : " mm"}`;
