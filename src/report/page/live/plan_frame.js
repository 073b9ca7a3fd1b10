// The frame of the plan: the visible part of the world, with grid, keep-out zones and fence.

/** Distance between the lines of the grid, mm. */
const GRID_STEP = 500;

class PlanFrame {
  /**
   * @param {SVGSVGElement} element
   * @param {SVGGElement} layer
   * @param {CellRecord} cell
   */
  constructor(element, layer, cell) {
    this.element = element;
    this.layer = layer;
    this.cell = cell;
    /** Length of a pixel, mm. */
    this.unit = 1;
    /**
     * Least x, least y, width and height of the visible part of the world, mm.
     * @type {number[] | null}
     */
    this.box = null;
  }

  /**
   * Shows all equipment and obstacles, with space to move them.
   * @param {AnswerRecord} answer
   */
  fit(answer) {
    const points = this.pointsOf(answer);
    const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const size = this.element.getBoundingClientRect();
    const shape = size.width / Math.max(size.height, 1) || 1;
    const { box } = this;
    // The frame is kept while everything is inside, so that nothing jumps during a drag.
    const isInside = box && x0 > box[0] && x1 < box[0] + box[2] && y0 > box[1] && y1 < box[1] + box[3];
    if (isInside && Math.abs(box[2] / box[3] - shape) < 0.01 * shape) return;
    const margin = 0.16 * Math.max(x1 - x0, y1 - y0) + 120;
    const width = Math.max(x1 - x0 + 2 * margin, (y1 - y0 + 2 * margin) * shape);
    const height = width / shape;
    const [left, bottom] = [(x0 + x1 - width) / 2, (y0 + y1 - height) / 2];
    this.box = [left, bottom, width, height];
    this.element.setAttribute("viewBox", `${left} ${-bottom - height} ${width} ${height}`);
    this.unit = width / Math.max(size.width, 1);
    this.drawGround(left, bottom, width, height);
  }

  /** @param {AnswerRecord} answer */
  pointsOf({ placements, base }) {
    const corners = this.cell.equipment.flatMap(({ footprint: [x, y, width, height] }, k) =>
      [-1, 1].flatMap((i) =>
        [-1, 1].map((j) => placementFrom([x + (i * width) / 2, y + (j * height) / 2, 0, 0], placements[k])),
      ),
    );
    const [x, y, width, height] = this.cell.base_footprint;
    return [
      ...corners,
      [base[0] + x - width, base[1] + y - height],
      [base[0] + x + width, base[1] + y + height],
      ...(this.cell.fence ?? []),
    ];
  }

  /**
   * @param {number} x
   * @param {number} y
   * @param {number} width
   * @param {number} height
   */
  drawGround(x, y, width, height) {
    const shapes = [];
    for (let k = Math.ceil(x / GRID_STEP); k * GRID_STEP < x + width; k++) {
      shapes.push(svg("path", { class: "grid", d: `M${k * GRID_STEP} ${-y}V${-y - height}` }));
    }
    for (let k = Math.ceil(y / GRID_STEP); k * GRID_STEP < y + height; k++) {
      shapes.push(svg("path", { class: "grid", d: `M${x} ${-k * GRID_STEP}H${x + width}` }));
    }
    for (const [x0, y0, x1, y1] of this.cell.keep_out) {
      shapes.push(svg("rect", { class: "keepout", x: x0, y: -y1, width: x1 - x0, height: y1 - y0 }));
    }
    if (this.cell.fence) {
      const points = this.cell.fence.map(([a, b]) => `${a},${-b}`).join(" ");
      shapes.push(svg("polygon", { class: "fence", points }));
    }
    this.layer.replaceChildren(...shapes);
  }
}
