// The cell in plan: what stands there, the map over it, and hands to move things with.

// viridis (M. Bigot, S. van der Walt and N. Smith; CC0) at equal steps.
const COLOURS = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81], [253, 231, 37]];
const colour = (t) => {
  const place = Math.min(Math.max(t, 0), 1) * (COLOURS.length - 1);
  const k = Math.min(Math.floor(place), COLOURS.length - 2);
  const mix = COLOURS[k].map((a, i) => Math.round(a + (COLOURS[k + 1][i] - a) * (place - k)));
  return `rgb(${mix.join(" ")})`;
};
const svg = (tag, attributes = {}) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
};
const turned = ([x, y], deg) => {
  const a = (deg * Math.PI) / 180;
  return [x * Math.cos(a) - y * Math.sin(a), x * Math.sin(a) + y * Math.cos(a)];
};
// A placement in the frame of another, and back.
const seenFrom = (at, base) => {
  const [x, y] = turned([at[0] - base[0], at[1] - base[1]], -base[3]);
  return [x, y, at[2] - base[2], at[3] - base[3]];
};
const carried = (own, base) => {
  const [x, y] = turned([own[0], own[1]], base[3]);
  return [base[0] + x, base[1] + y, base[2] + own[2], base[3] + own[3]];
};

// Sign of a node that cannot be used, as SVG.
const glyphMarkup = (status, x, y, r) => {
  const { glyph } = NODE_SIGNS[status];
  return glyph ? `<path class="sign ${glyph.tone} ${glyph.ring}" d="${glyphPath(glyph, x, y, r)}"/>` : "";
};
// Entry of the legend: markup of a sign round the origin, and its label.
const legendItem = (markup, label) => {
  const box = svg("svg", { width: 16, height: 14, viewBox: "-8 -7 16 14" });
  box.innerHTML = markup;
  return make("span", {}, box, ` ${label}`);
};

// How far the nodes of an operation are apart, mm.
const spacing = ({ nodes: { at } }) => {
  const apart = at.slice(1, 60).map((p, k) => Math.hypot(p[0] - at[k][0], p[1] - at[k][1]));
  return Math.min(...apart.filter((d) => d > 0), 1000);
};

class Plan {
  // `moved(index, world, settled)`: an equipment (-1: the robot base) was taken to a placement in the world.
  constructor(element, cell, moved) {
    Object.assign(this, { element, cell, moved, held: null, pieces: [], answer: null });
    this.layers = ["floor", "stands", "reaches", "nodes", "hands"].map((name) => {
      const group = svg("g", { class: name });
      element.append(group);
      return group;
    });
    cell.equipment.forEach((piece, k) => this.pieces.push(this.piece(piece, k)));
    this.base = this.robot();
    element.addEventListener("pointermove", (e) => this.drag(e));
    element.addEventListener("pointerup", (e) => this.drop(e));
    element.addEventListener("pointercancel", (e) => this.drop(e));
    element.addEventListener("pointerleave", () => this.told(""));
  }

  piece(piece, index) {
    const movable = !piece.obstacle;
    const group = svg("g", { class: `piece${piece.obstacle ? " obstacle" : " movable"}` });
    const [cx, cy, w, h] = piece.footprint;
    group.append(svg("rect", { class: "foot", x: cx - w / 2, y: cy - h / 2, width: w, height: h, rx: 8 }));
    const title = svg("title");
    title.textContent = piece.name;
    group.append(title);
    const hand = svg("g", { class: "piece" });
    const text = svg("text");
    text.textContent = piece.name;
    hand.append(text);
    this.layers[1].append(group);
    this.layers[4].append(hand);
    const all = { group, hand, text, piece, top: cy + h / 2, turn: null };
    if (!movable) return all;
    group.setAttribute("tabindex", "0");
    group.setAttribute("role", "button");
    group.setAttribute("aria-label", `${piece.name}: arrow keys move it, [ and ] turn it`);
    all.arm = svg("line", { class: "arm" });
    all.turn = svg("circle", { class: "turn" });
    hand.append(all.arm, all.turn);
    group.addEventListener("pointerdown", (e) => this.grip(e, index, false));
    all.turn.addEventListener("pointerdown", (e) => this.grip(e, index, true));
    group.addEventListener("keydown", (e) => this.key(e, index));
    return all;
  }

  robot() {
    const [cx, cy, w, h] = this.cell.base_footprint;
    const group = svg("g", { class: "base" });
    group.append(svg("rect", { x: cx - w / 2, y: cy - h / 2, width: w, height: h }));
    group.append(svg("circle", { r: 30 }));
    this.layers[1].append(group);
    return group;
  }

  // World mm to the picture, which has y downwards.
  place(group, [x, y, , yaw]) {
    group.setAttribute("transform", `translate(${x} ${-y}) scale(1 -1) rotate(${yaw})`);
  }

  at(e) {
    const p = new DOMPoint(e.clientX, e.clientY).matrixTransform(this.element.getScreenCTM().inverse());
    return [p.x, -p.y];
  }

  grip(e, index, turns) {
    if (e.button !== 0 || !this.answer) return;
    e.preventDefault();
    e.stopPropagation();
    this.pieces[index].group.focus();
    const [x, y] = this.at(e);
    const from = this.answer.placements[index].slice();
    this.held = { index, turns, from, at: [x, y], now: from, pointer: e.pointerId };
    this.element.setPointerCapture(e.pointerId);
    this.pieces[index].group.classList.add("held");
  }

  drag(e) {
    if (!this.held) return this.point(e);
    const { index, turns, from, at } = this.held;
    const [x, y] = this.at(e);
    const now = from.slice();
    if (turns) {
      const angle = (p) => (Math.atan2(p[1] - from[1], p[0] - from[0]) * 180) / Math.PI;
      const by = angle([x, y]) - angle(at);
      now[3] = Math.round((from[3] + by - 360 * Math.round(by / 360)) * 2) / 2;
    } else {
      now[0] = Math.round(from[0] + x - at[0]);
      now[1] = Math.round(from[1] + y - at[1]);
    }
    this.held.now = now;
    this.held.now = this.moved(index, now, false) || now;
    this.show(index, this.held.now);
  }

  drop(e) {
    if (!this.held || e.pointerId !== this.held.pointer) return;
    const { index, from, now } = this.held;
    this.held = null;
    this.pieces[index].group.classList.remove("held");
    const gone = e.type === "pointercancel";
    if (gone) this.show(index, from);
    else if (now.some((v, k) => v !== from[k])) this.moved(index, now, true);
  }

  key(e, index) {
    const step = e.shiftKey ? 1 : 10;
    const by = { ArrowLeft: [-step, 0, 0], ArrowRight: [step, 0, 0], ArrowUp: [0, step, 0], ArrowDown: [0, -step, 0],
      "[": [0, 0, step / 10], "]": [0, 0, -step / 10], "{": [0, 0, 0.1], "}": [0, 0, -0.1] }[e.key];
    if (!by || !this.answer || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    const at = this.answer.placements[index];
    const round = (v) => +v.toFixed(4);
    this.moved(index, [round(at[0] + by[0]), round(at[1] + by[1]), at[2], round(at[3] + by[2])], true);
  }

  // Where a piece is shown, and what stands on it.
  show(index, at) {
    const before = this.pieces[index].at;
    this.pieces[index].at = at;
    this.place(this.pieces[index].group, at);
    this.label(this.pieces[index], at);
    this.cell.equipment.forEach((other, k) => {
      if (before && other.on === index) this.show(k, carried(seenFrom(this.pieces[k].at, before), at));
    });
  }

  label(piece, at) {
    const [cx, cy] = piece.piece.footprint;
    const [x, y] = turned([cx, cy], at[3]);
    const unit = this.unit || 1;
    // The name stands beside the work surface, which is full of nodes.
    const away = piece.piece.surface ? Math.abs(piece.piece.footprint[3]) / 2 + 18 * unit : 0;
    // Not where the handle is.
    const names = [[0, -1], [1, 0], [-1, 0]].map((side) => {
      const far = side[0] ? piece.piece.footprint[2] / 2 + 26 * unit : away;
      const [dx, dy] = turned([side[0] * far, side[1] * far], at[3]);
      return [at[0] + x + dx, at[1] + y + dy];
    });
    const base = this.answer ? this.answer.base : [0, 0];
    const far = (p) => Math.hypot(p[0] - base[0], p[1] - base[1]);
    const spot = away ? names.reduce((a, b) => (far(b) > far(a) ? b : a)) : [at[0] + x, at[1] + y];
    piece.text.setAttribute("transform", `translate(${spot[0]} ${-spot[1] + 4 * unit}) scale(${unit})`);
    if (!piece.turn) return;
    const [hx, hy] = turned([cx, piece.top + 26 * unit], at[3]);
    const [fx, fy] = turned([cx, piece.top], at[3]);
    piece.turn.setAttribute("cx", at[0] + hx);
    piece.turn.setAttribute("cy", -(at[1] + hy));
    piece.turn.setAttribute("r", 8 * unit);
    for (const [name, value] of Object.entries({ x1: fx, y1: fy, x2: hx, y2: hy })) {
      piece.arm.setAttribute(name, name[0] === "x" ? at[0] + value : -(at[1] + value));
    }
  }
