// The plan of the cell: its objects, and handles to move them.

/**
 * A piece of the plan: a piece of equipment or an obstacle.
 * @typedef {object} Piece
 * @property {CellEquipment} equipment
 * @property {Placement} at
 * @property {SVGGElement} group
 * @property {SVGTextElement} text
 * @property {{ arm: SVGLineElement, knob: SVGCircleElement } | null} handle rotates the piece; `null` for an
 * obstacle
 *
 * A drag of a piece that is under way.
 * @typedef {object} Drag
 * @property {number} index of the piece
 * @property {boolean} turns whether the piece is rotated and not shifted
 * @property {Placement} from
 * @property {number[]} start where the drag began in the world, mm
 * @property {Placement} now
 * @property {number | null} pointer `null` for a drag in the 3-D view
 *
 * Function that is called when a piece is moved. The function returns the allowed placement of the piece.
 * @typedef {(index: number, world: Placement, isSettled: boolean) => Placement} OnMove
 */

/**
 * Steps of the arrow keys, mm, and of the brackets, degrees.
 * @type {Record<string, number[]>}
 */
const KEY_STEPS = {
  ArrowLeft: [-10, 0, 0],
  ArrowRight: [10, 0, 0],
  ArrowUp: [0, 10, 0],
  ArrowDown: [0, -10, 0],
  "[": [0, 0, 1],
  "]": [0, 0, -1],
  "{": [0, 0, 1],
  "}": [0, 0, -1],
};

/** Time without a movement of the pointer after which a dragged piece counts as still, ms. */
const STILL = 200;

class Plan {
  /**
   * @param {SVGSVGElement} element
   * @param {CellRecord} cell
   * @param {OnMove} onMove
   */
  constructor(element, cell, onMove) {
    this.element = element;
    this.cell = cell;
    this.onMove = onMove;
    /** @type {AnswerRecord} */
    this.answer = cell.now.answer;
    /** @type {Drag | null} */
    this.held = null;
    /**
     * Called when a piece is gripped to be moved.
     * @type {(index: number) => void}
     */
    this.onGrip = () => {};
    /** Time of the last movement of the pointer during a drag, ms. */
    this.movedAt = 0;
    const [floor, standing, stands, reaches, nodes, handles] = [
      "floor",
      "standing",
      "stands",
      "reaches",
      "nodes",
      "hands",
    ].map((name) => svg("g", { class: name }));
    this.layers = { standing, stands, reaches, handles };
    element.append(floor, standing, stands, reaches, nodes, handles);
    this.frame = new PlanFrame(element, floor, cell);
    this.map = new PlanMap(nodes);
    this.pieces = cell.equipment.map((equipment, k) => this.makePiece(equipment, k));
    this.base = this.makeBase();
    element.addEventListener("pointermove", (event) => this.drag(event));
    element.addEventListener("pointerup", (event) => this.drop(event));
    element.addEventListener("pointercancel", (event) => this.drop(event));
    element.addEventListener("pointerleave", () => showHover(""));
  }

  /**
   * @param {CellEquipment} equipment
   * @param {number} index
   * @returns {Piece}
   */
  makePiece(equipment, index) {
    const [x, y, width, height] = equipment.footprint;
    const foot = svg("rect", { class: "foot", x: x - width / 2, y: y - height / 2, width, height, rx: 8 });
    const group = svg("g", { class: `piece ${equipment.obstacle ? "obstacle" : "movable"}` }, foot);
    group.append(svg("title", {}, equipment.name));
    const text = svg("text", {}, equipment.name);
    const hand = svg("g", { class: "piece" }, text);
    this.layers.stands.append(group);
    this.layers.handles.append(hand);
    const at = this.answer.placements[index];
    if (equipment.obstacle) return { equipment, at, group, text, handle: null };
    const handle = { arm: svg("line", { class: "arm" }), knob: svg("circle", { class: "turn" }) };
    hand.append(handle.arm, handle.knob);
    group.setAttribute("tabindex", "0");
    group.setAttribute("role", "button");
    group.setAttribute("aria-label", `${equipment.name}: arrow keys move it, [ and ] rotate it`);
    group.addEventListener("pointerdown", (event) => this.grip(event, index, false));
    handle.knob.addEventListener("pointerdown", (event) => this.grip(event, index, true));
    group.addEventListener("keydown", (event) => this.pressKey(event, index));
    return { equipment, at, group, text, handle };
  }

  makeBase() {
    const [x, y, width, height] = this.cell.base_footprint;
    const foot = svg("rect", { x: x - width / 2, y: y - height / 2, width, height });
    const group = svg("g", { class: "base" }, foot, svg("circle", { r: 30 }));
    this.layers.stands.append(group);
    return group;
  }

  /**
   * Returns the position of an event in the world, mm.
   * @param {MouseEvent} event
   */
  placeOf(event) {
    const matrix = this.element.getScreenCTM();
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix?.inverse());
    return [point.x, -point.y];
  }

  /**
   * @param {PointerEvent} event
   * @param {number} index
   * @param {boolean} turns
   */
  grip(event, index, turns) {
    if (event.button !== 0) return;
    event.preventDefault();
    event.stopPropagation();
    this.pieces[index].group.focus();
    const from = this.answer.placements[index].slice();
    this.held = { index, turns, from, start: this.placeOf(event), now: from, pointer: event.pointerId };
    this.element.setPointerCapture(event.pointerId);
    this.pieces[index].group.classList.add("held");
    if (!turns) this.onGrip(index);
  }

  /** @param {PointerEvent} event */
  drag(event) {
    if (!this.held) {
      showHover(this.map.describe(this.answer, this.placeOf(event), this.frame.unit));
      return;
    }
    this.movedAt = performance.now();
    const { index, turns, from, start } = this.held;
    const [x, y] = this.placeOf(event);
    const now = from.slice();
    if (turns) {
      const angleOf = (/** @type {number[]} */ point) =>
        (Math.atan2(point[1] - from[1], point[0] - from[0]) * 180) / Math.PI;
      const angle = angleOf([x, y]) - angleOf(start);
      now[3] = Math.round((from[3] + angle - 360 * Math.round(angle / 360)) * 2) / 2;
    } else {
      now[0] = Math.round(from[0] + x - start[0]);
      now[1] = Math.round(from[1] + y - start[1]);
    }
    this.held.now = this.onMove(index, now, false);
    this.show(index, this.held.now);
  }

  /** @param {PointerEvent} event */
  drop(event) {
    if (!this.held || event.pointerId !== this.held.pointer) return;
    const { index, from, now } = this.held;
    this.held = null;
    this.pieces[index].group.classList.remove("held");
    this.layers.standing.replaceChildren();
    if (event.type === "pointercancel") this.show(index, from);
    else if (now.some((value, k) => value !== from[k])) this.onMove(index, now, true);
  }

  /**
   * @param {KeyboardEvent} event
   * @param {number} index
   */
  pressKey(event, index) {
    const step = KEY_STEPS[event.key];
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    // With the shift key, which turns brackets into braces, a step is a tenth as large.
    const share = event.shiftKey || "{}".includes(event.key) ? 0.1 : 1;
    const [x, y, z, yaw] = this.answer.placements[index];
    const moved = [x + share * step[0], y + share * step[1], z, yaw + share * step[2]];
    const [newX, newY, , newYaw] = moved.map((value) => Number(value.toFixed(4)));
    this.onMove(index, [newX, newY, z, newYaw], true);
  }

  /**
   * Draws an evaluated layout: the placements and the error map.
   * @param {AnswerRecord} answer
   */
  draw(answer) {
    this.answer = answer;
    if (!this.held) this.frame.fit(answer);
    this.pieces.forEach((piece, k) => {
      if (this.held && this.rides(k, this.held.index)) return;
      this.put(piece, answer.placements[k]);
    });
    transform(this.base, answer.base);
    this.map.draw(answer, this.frame.unit);
  }

  /**
   * Returns whether a piece is the piece `under` or stands on it, directly or on other pieces.
   * @param {number} index
   * @param {number} under
   * @returns {boolean}
   */
  rides(index, under) {
    const { on } = this.cell.equipment[index];
    return index === under || (on !== null && this.rides(on, under));
  }

  /**
   * Shows a piece at a placement, and moves all pieces that stand on the piece.
   * @param {number} index
   * @param {Placement} at
   */
  show(index, at) {
    const before = this.pieces[index].at;
    this.put(this.pieces[index], at);
    this.cell.equipment.forEach(({ on }, k) => {
      if (on === index) this.show(k, placementFrom(placementIn(this.pieces[k].at, before), at));
    });
  }

  /**
   * @param {Piece} piece
   * @param {Placement} at
   */
  put(piece, at) {
    piece.at = at;
    transform(piece.group, at);
    this.placeName(piece);
    this.placeHandle(piece);
  }

  /**
   * Places the name of a piece. The name of a piece with a work surface is beside its floor space, because
   * nodes would cover a name on the surface. Of the sides without a handle, the side farthest from the robot
   * is used.
   * @param {Piece} piece
   */
  placeName({ equipment, at, text }) {
    const [x, y, width, height] = equipment.footprint;
    const { unit } = this.frame;
    const spots = equipment.surface
      ? [
          [x, y - Math.abs(height) / 2 - 18 * unit],
          [x + width / 2 + 26 * unit, y],
          [x - width / 2 - 26 * unit, y],
        ]
      : [[x, y]];
    const places = spots.map((spot) => placementFrom([...spot, 0, 0], at));
    const distance = (/** @type {Placement} */ place) =>
      Math.hypot(place[0] - this.answer.base[0], place[1] - this.answer.base[1]);
    const [left, top] = places.reduce((best, place) => (distance(place) > distance(best) ? place : best));
    text.setAttribute("transform", `translate(${left} ${-top + 4 * unit}) scale(${unit})`);
  }

  /** @param {Piece} piece */
  placeHandle({ equipment, at, handle }) {
    if (!handle) return;
    const [x, y, , height] = equipment.footprint;
    const { unit } = this.frame;
    const edge = y + height / 2;
    const [footX, footY] = placementFrom([x, edge, 0, 0], at);
    const [knobX, knobY] = placementFrom([x, edge + 26 * unit, 0, 0], at);
    setAttributes(handle.knob, { cx: knobX, cy: -knobY, r: 8 * unit });
    setAttributes(handle.arm, { x1: footX, y1: -footY, x2: knobX, y2: -knobY });
  }

  /**
   * Shows where the origin of the held piece may stand.
   * @param {number[][][]} rings
   */
  showStanding(rings) {
    const ring = (/** @type {number[][]} */ points) => `M${points.map(([x, y]) => `${x} ${-y}`).join("L")}Z`;
    this.layers.standing.replaceChildren(svg("path", { d: rings.map(ring).join("") }));
  }

  /** Waits until the pointer has been still for a while, or until the drag has ended. */
  async stillness() {
    while (this.held && performance.now() - this.movedAt < STILL) {
      await new Promise((done) => setTimeout(done, STILL / 4));
    }
  }

  /**
   * Shows how far the arm reaches at the height of the work.
   * @param {number[][][][]} outlines
   */
  showReach(outlines) {
    const ring = (/** @type {number[][]} */ points) => `M${points.map(([x, y]) => `${x} ${-y}`).join("L")}Z`;
    const paths = new Set(outlines.map((rings) => rings.map(ring).join("")));
    const shapes = [...paths].filter(Boolean).map((d) => svg("path", { class: "reach", d }));
    this.layers.reaches.replaceChildren(...shapes);
  }
}

/**
 * Places a group at a placement in the world. The y axis of the picture points down.
 * @param {Element} group
 * @param {Placement} at
 */
function transform(group, [x, y, , yaw]) {
  group.setAttribute("transform", `translate(${x} ${-y}) scale(1 -1) rotate(${yaw})`);
}

/**
 * Sets attributes of an element.
 * @param {Element} element
 * @param {Record<string, number>} attributes
 */
function setAttributes(element, attributes) {
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
}

/**
 * Shows a description of what is under the pointer.
 * @param {string} text
 */
function showHover(text) {
  byId("hover").textContent = text;
}
