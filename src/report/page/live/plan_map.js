// The error map over the plan, and its legend.

/** Longest arrow, px. */
const LONGEST_ARROW = 34;

/** Distance from the pointer within which a node is described, px. */
const HOVER_RADIUS = 9;

/** Angle from the direction of an arrow to the two sides of its head, rad. */
const HEAD_ANGLE = 2.7;

class PlanMap {
  /** @param {SVGGElement} layer */
  constructor(layer) {
    this.layer = layer;
    this.key = byId("key");
    this.scale = make("span");
    this.arrows = make("span");
    this.signs = make("span", { className: "signs" });
    this.key.append(make("span", {}, colourBar(), " ", this.scale), this.arrows, this.signs);
  }

  /**
   * @param {AnswerRecord} answer
   * @param {number} unit length of a pixel, mm
   */
  draw(answer, unit) {
    const values = answer.operations.flatMap(({ nodes }) => nodes.value.filter((value) => value !== null));
    const low = values.reduce((a, b) => Math.min(a, b), Infinity);
    const high = values.reduce((a, b) => Math.max(a, b), -Infinity);
    const magnification = magnificationOf(answer.operations, unit);
    const shapes = answer.operations.flatMap((operation) => {
      const marks = nodeMarks(operation, { low, high }, magnification, unit);
      const best = bestMark(operation, unit);
      return best ? [...marks, best] : marks;
    });
    this.layer.replaceChildren(...shapes);
    const hasValues = low <= high;
    this.scale.textContent = hasValues
      ? `${errorFigure(low)} to ${errorFigure(high)} ${answer.unit}`
      : "no usable node";
    const factor = Number(magnification.toPrecision(2));
    this.arrows.textContent = hasValues ? `arrows: error in x and y, magnified ${factor} times` : "";
    this.showSigns(answer);
  }

  /**
   * Shows the meaning of the marks that are in the plan.
   * @param {AnswerRecord} answer
   */
  showSigns({ operations }) {
    const statuses = new Set(operations.flatMap(({ nodes }) => nodes.status));
    const signs = Object.entries(sweetspotViewer.nodeSigns).filter(
      ([status]) => status !== "ok" && statuses.has(/** @type {NodeStatus} */ (status)),
    );
    const items = signs.map(([, { mark, text }]) => legendItem(markShape(mark, [0, 0], 4.4), text));
    const spot = svg("circle", { class: "best", r: 5.5, "stroke-width": 2 });
    const reach = svg("path", { class: "reach", d: "M-8 0H8" });
    this.signs.replaceChildren(...items, legendItem(spot, "spot"), legendItem(reach, "reach"));
  }

  /**
   * Describes the node under the pointer.
   * @param {AnswerRecord} answer
   * @param {number[]} point mm
   * @param {number} unit mm
   */
  describe({ operations, unit: valueUnit }, [x, y], unit) {
    let nearestDistance = HOVER_RADIUS * unit;
    let text = `x ${shortNumber(x, 0)}, y ${shortNumber(y, 0)} mm`;
    for (const { name, nodes } of operations) {
      nodes.at.forEach((at, k) => {
        const distance = Math.hypot(at[0] - x, at[1] - y);
        if (distance >= nearestDistance) return;
        nearestDistance = distance;
        text = `${name} (${nodes.ij[k].join(", ")}): ${nodeWords(nodes, k, valueUnit)}`;
      });
    }
    return text;
  }
}

/**
 * Describes a node: its value and error, or the reason why it has no value.
 * @param {NodesRecord} nodes
 * @param {number} k
 * @param {string} unit
 */
function nodeWords(nodes, k, unit) {
  const [value, error] = [nodes.value[k], nodes.error[k]];
  if (value === null || error === null) return nodes.reasons[nodes.why[k]] || nodes.status[k];
  const [x, y, z] = error.map(errorFigure);
  return `${errorFigure(value)} ${unit}; error x ${x}, y ${y}, z ${z} mm`;
}

/**
 * Returns the magnification of the error arrows, a number with one significant digit.
 * @param {OperationAnswer[]} operations
 * @param {number} unit mm
 */
function magnificationOf(operations, unit) {
  let longest = 0;
  for (const { nodes } of operations) {
    for (const error of nodes.error) if (error) longest = Math.max(longest, Math.hypot(error[0], error[1]));
  }
  const room = Math.min(LONGEST_ARROW * unit, 1.6 * Math.min(...operations.map(nodeSpacing)));
  const factor = longest > 0 ? room / longest : 1;
  const ten = 10 ** Math.floor(Math.log10(factor));
  return Math.max(Math.floor(factor / ten), 1) * ten;
}

/**
 * Returns the marks of the nodes of an operation.
 * @param {OperationAnswer} operation
 * @param {{ low: number, high: number }} range
 * @param {number} magnification
 * @param {number} unit mm
 */
function nodeMarks(operation, { low, high }, magnification, unit) {
  const { nodes } = operation;
  // Marks have a fixed size, limited by the distance between the nodes.
  const size = Math.min(unit, nodeSpacing(operation) / 11);
  return nodes.at.flatMap(([x, y], k) => {
    const [value, error] = [nodes.value[k], nodes.error[k]];
    if (value === null || error === null) {
      const { mark } = sweetspotViewer.nodeSigns[nodes.status[k]];
      return [markShape(mark, [x, -y], 4.4 * size)];
    }
    const fill = colourAt((value - low) / (high - low || 1));
    const tip = [error[0] * magnification, -error[1] * magnification];
    return [
      svg("path", { class: "arrow", stroke: fill, d: arrowPath([x, -y], tip, 5 * size) }),
      svg("circle", { class: "dot", cx: x, cy: -y, r: 3.6 * size, fill }),
    ];
  });
}

/**
 * Returns the mark of a node without a value.
 * @param {Mark} mark
 * @param {number[]} at
 * @param {number} radius
 */
function markShape(mark, [x, y], radius) {
  const { path, tone, dashed } = sweetspotViewer.marks[mark];
  const transform = `translate(${x} ${y}) scale(${radius})`;
  return svg("path", { class: `mark ${tone}${dashed ? " dashed" : ""}`, d: path, transform });
}

/**
 * Returns the path of an arrow.
 * @param {number[]} start
 * @param {number[]} tip relative to the start
 * @param {number} headLength
 */
function arrowPath(start, [dx, dy], headLength) {
  const scale = headLength / Math.max(Math.hypot(dx, dy), headLength);
  const barb = (/** @type {number} */ angle) => [
    scale * (Math.cos(angle) * dx - Math.sin(angle) * dy),
    scale * (Math.sin(angle) * dx + Math.cos(angle) * dy),
  ];
  const [left, right] = [barb(HEAD_ANGLE), barb(-HEAD_ANGLE)];
  const words = (/** @type {number[]} */ point) => point.map((value) => value.toFixed(1)).join(" ");
  const back = left.map((value) => -value);
  return `M${start.join(" ")}l${words([dx, dy])}l${words(left)}m${words(back)}l${words(right)}`;
}

/**
 * Returns the ring round the best node; null if there is no best node.
 * @param {OperationAnswer} operation
 * @param {number} unit mm
 */
function bestMark({ nodes, best }, unit) {
  const index = best ? nodes.ij.findIndex(([i, j]) => i === best[0] && j === best[1]) : -1;
  if (index < 0) return null;
  const [x, y] = nodes.at[index];
  return svg("circle", { class: "best", cx: x, cy: -y, r: HOVER_RADIUS * unit });
}

/** Returns the colour scale as a bar. */
function colourBar() {
  const steps = Array.from({ length: 40 }, (_, k) =>
    svg("rect", { x: k * 3, y: 0, width: 3.2, height: 12, fill: colourAt(k / 39) }),
  );
  return svg("svg", { width: 120, height: 12 }, ...steps);
}

/**
 * Makes an entry of the legend.
 * @param {SVGElement} shape
 * @param {string} text
 */
const legendItem = (shape, text) =>
  make("span", {}, svg("svg", { width: 16, height: 14, viewBox: "-8 -7 16 14" }, shape), ` ${text}`);
