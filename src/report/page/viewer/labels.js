// Names in the picture as HTML, placed where they cover least.

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "class") made.className = value;
    else if (key in made && key !== "list") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

/** A layer of labels that are made once and moved, lines that lead to them, and the world axes. */
function makeLabels(stage) {
  const layer = element("div", { class: "ss-labels" });
  const leads = drawn("g", { class: "ss-leads" });
  const triad = ["x", "y", "z"].map((name) => drawn("line", { class: `ss-${name}` }));
  stage.append(drawn("svg", { class: "ss-over", "aria-hidden": "true" }, leads, ...triad), layer);
  layer.setAttribute("aria-hidden", "true");
  return { layer, leads, triad, pool: [], places: new Map() };
}

function showLabels(labels, wanted) {
  while (labels.pool.length < wanted.length) {
    const [span, lead] = [element("span"), drawn("path", {})];
    labels.layer.append(span);
    labels.leads.append(lead);
    labels.pool.push({ span, lead });
  }
  labels.pool.forEach(({ span, lead }, k) => {
    const want = wanted[k];
    span.hidden = !want;
    lead.setAttribute("d", (want && want.lead) || "");
    if (!want) return;
    if (span.textContent !== want.text) span.textContent = want.text;
    span.className = `ss-label ss-${want.kind}`;
    lead.setAttribute("class", `ss-lead-${want.kind}`);
    span.style.transform = `translate(${want.x.toFixed(1)}px, ${want.y.toFixed(1)}px)`;
  });
}

const overlap = (a, b) =>
  Math.max(0, Math.min(a.x + a.w, b.x + b.w) - Math.max(a.x, b.x)) *
  Math.max(0, Math.min(a.y + a.h, b.y + b.h) - Math.max(a.y, b.y));

/** Puts boxes one after another where they cover fewest points and no box before them. */
function arrange(labels, boxes, points, width, height) {
  const [taken, placed] = [[], []];
  for (const box of boxes) {
    let best = null;
    box.places.forEach(([x, y, own = 0], k) => {
      const [wx, wy] = [x - box.w / 2, y - box.h / 2];
      const inside = (v, room) => clamp(v, 3, Math.max(room - 3, 3));
      const at = { x: inside(wx, width - box.w), y: inside(wy, height - box.h), w: box.w, h: box.h };
      const pushed = Math.hypot(at.x - wx, at.y - wy);
      let cost = k * 0.4 + own + pushed * 0.1 - (labels.places.get(box.key) === k ? 2.5 : 0);
      for (const other of taken) cost += overlap(at, other) > 0 ? 30 : 0;
      for (const [px, py, weight] of points) {
        if (px > at.x - 5 && px < at.x + at.w + 5 && py > at.y - 5 && py < at.y + at.h + 5) cost += weight;
      }
      if (!best || cost < best.cost) best = { at, cost, k };
    });
    if (!best || (best.cost >= 28 && !box.must)) continue;
    labels.places.set(box.key, best.k);
    taken.push(best.at);
    placed.push({ text: box.text, kind: box.kind, x: best.at.x, y: best.at.y, lead: leadTo(best.at, box.anchors) });
  }
  return placed;
}

/** A line from the edge of a label to the nearest of its anchors, unless that is close by. */
function leadTo(at, anchors) {
  const ends = anchors.map(([x, y]) => {
    const from = [clamp(x, at.x + 8, at.x + at.w - 8), clamp(y, at.y, at.y + at.h)];
    return { x, y, from, far: Math.hypot(x - from[0], y - from[1]) };
  });
  const end = ends.reduce((a, b) => (b.far < a.far ? b : a));
  return end.far < 9 ? "" : `M${end.from.map((v) => v.toFixed(1)).join(" ")}L${end.x.toFixed(1)} ${end.y.toFixed(1)}`;
}

const textWidth = (text, px) => [...text].length * px * 0.56 + 14;

function labelBoxes(view) {
  const boxes = [];
  const { drawing } = view;
  for (const field of shownFields(drawing, view.state.operation)) {
    const spot = spotOf(view, field);
    const at = spot && seenAt(view, spot);
    if (!spot || !at.visible) continue;
    const name = drawing.operations[field.operation].name;
    const text = `${short(name)}  ${spotValue(view, field)}`;
    const [w, h] = [textWidth(text, 15) + 4, 24]; // it is bold
    const places = [1, 2.2, 3.6, 5.4, 7.5].flatMap((f) =>
      [[1, -1], [-1, -1], [1, 1], [-1, 1], [0, -1.3], [0, 1.3]].map(([x, y]) => [at.x + x * (w / 2 + 12 * f), at.y + y * (8 + 15 * f), f]));
    boxes.push({ key: `o${field.operation}`, text, kind: "spot", must: true, w, h, places, anchors: [[at.x, at.y]] });
  }
  const named = drawing.equipment.map((e, k) => ({ name: e.name, parts: drawing.parts.filter((p) => p.equipment === k) }));
  for (const part of drawing.parts) if (part.kind === "keep-out") named.push({ name: part.name, parts: [part] });
  const rooms = named.map(({ parts }) => roomOf(view, parts));
  named.forEach(({ name }, k) => {
    const w = textWidth(short(name), 12);
    if (!rooms[k]) return;
    const inOther = ([x, y]) => rooms.filter((r, n) => r && n !== k && x > r.left && x < r.right && y > r.top && y < r.bottom).length;
    const places = rooms[k].places.map((p) => [...p, 4 * inOther(p)]);
    boxes.push({ key: `e${k}`, text: short(name), kind: "name", w, h: 18, places, anchors: rooms[k].anchors });
  });
  return boxes;
}

const short = (name) => ([...name].length > 32 ? `${[...name].slice(0, 31).join("")}\u2026` : name);

function spotValue(view, field) {
  const s = senseIn(field, view.state.sense);
  const take = field.takes[view.lens];
  const best = take ? take.best : null;
  return best === null ? "" : `${figure(take.values[s][best])} ${field.senses[s].unit}`;
}

/** The outline of parts on the screen, places round it for a name, and what a line may lead to. */
function roomOf(view, parts) {
  const [xs, ys, anchors] = [[], [], []];
  for (const part of parts) {
    const at = view.poseOf(part);
    for (const point of part.mesh.marks) {
      const p = seenAt(view, moved(at, point));
      if (!p.visible) return null;
      xs.push(p.x);
      ys.push(p.y);
      anchors.push([p.x, p.y]);
    }
  }
  if (!xs.length) return null;
  const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const [x, y] = [(left + right) / 2, (top + bottom) / 2];
  const places = [[x, top - 12], [x, bottom + 12], [x, bottom - 16], [right + 34, y], [left - 34, y], [mix(x, left, 0.6), bottom - 14],
    [mix(x, right, 0.6), bottom - 14], [left, top - 10], [right, top - 10], [left, bottom + 8], [right, bottom + 8], [x, y]];
  return { left, right, top, bottom, anchors, places };
}

/** What labels should not cover: nodes, and more so the arm. */
function keepClear(view) {
  const points = [];
  for (const field of shownFields(view.drawing, view.state.operation)) {
    const step = Math.ceil(field.count / 600);
    for (let k = 0; k < field.count; k += step) {
      const p = seenAt(view, placeOf(view, field, nodeAt(field, k)));
      points.push([p.x, p.y, 1.5]);
    }
  }
  const joints = view.frames.map((m) => seenAt(view, [m[12], m[13], m[14]]));
  joints.forEach((p, k) => {
    const next = joints[k + 1] || p;
    for (let s = 0; s < 6; s++) points.push([mix(p.x, next.x, s / 6), mix(p.y, next.y, s / 6), 2]);
  });
  return points;
}

function drawLabels(view, labels) {
  const names = arrange(labels, labelBoxes(view), keepClear(view), view.width, view.height);
  showLabels(labels, [...floorNumbers(view), ...axisLabels(view, labels), ...names]);
}

/** The world axes in the corner. */
function axisLabels(view, labels) {
  const { right, up } = view.optics;
  const [x, y] = [38, view.height - 40];
  const ends = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((a) => [x + 26 * dot(a, right), y - 26 * dot(a, up)]);
  labels.triad.forEach((line, k) => {
    const at = { x1: x, y1: y, x2: ends[k][0].toFixed(1), y2: ends[k][1].toFixed(1) };
    for (const [key, value] of Object.entries(at)) line.setAttribute(key, value);
  });
  return ends.map(([ex, ey], k) => {
    const hides = Math.hypot(ex - x, ey - y) < 5;
    return { text: hides ? "" : "xyz"[k], kind: `axis ss-axis-${"xyz"[k]}`, x: x + (ex - x) * 1.35 - 4, y: y + (ey - y) * 1.35 - 8 };
  });
}

/** Millimetres along the two edges of the floor that are nearest to the eye. */
function floorNumbers(view) {
  const [x0, y0, x1, y1] = view.floorBounds;
  const { eye } = view.optics;
  const z = view.drawing.floor_mm;
  const y = Math.abs(eye[1] - y0) < Math.abs(eye[1] - y1) ? y0 : y1;
  const x = Math.abs(eye[0] - x0) < Math.abs(eye[0] - x1) ? x0 : x1;
  const out = [];
  const along = (low, high, point, word) => {
    const a = seenAt(view, point(low));
    const b = seenAt(view, point(high));
    const room = Math.hypot(a.x - b.x, a.y - b.y) / Math.max(high - low, 1);
    const step = [500, 1000, 2000, 5000, 10000].find((s) => s * room > 46);
    if (!step) return;
    let last = null;
    const inwards = seenAt(view, times(add([x0, y0, z], [x1, y1, z]), 0.5));
    for (let v = Math.ceil(low / step) * step; v <= high; v += step) {
      const p = seenAt(view, point(v));
      const away = [p.x - inwards.x, p.y - inwards.y];
      const far = Math.hypot(...away) || 1;
      const text = String(v).replace("-", "\u2212");
      const [px, py] = [p.x + (away[0] / far) * 16, p.y + (away[1] / far) * 12];
      const w = textWidth(text, 10) - 14;
      if (p.visible && px > w / 2 && px < view.width - w / 2 && py > 6 && py < view.height - 6) {
        last = { text, kind: "tick", x: px - w / 2, y: py - 7 };
        out.push(last);
      }
    }
    // The last to be seen says of what.
    if (last) last.text = `${word} ${last.text} mm`;
  };
  along(x0, x1, (v) => [v, y, z], "x");
  along(y0, y1, (v) => [x, v, z], "y");
  return out;
}
