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

/** A layer of labels that are made once and moved. */
function makeLabels(stage) {
  const layer = element("div", { class: "ss-labels" });
  layer.setAttribute("aria-hidden", "true");
  stage.append(layer);
  return { layer, pool: [], places: new Map() };
}

function showLabels(labels, wanted) {
  while (labels.pool.length < wanted.length) {
    const made = element("span");
    labels.layer.append(made);
    labels.pool.push(made);
  }
  labels.pool.forEach((span, k) => {
    const want = wanted[k];
    span.hidden = !want;
    if (!want) return;
    if (span.textContent !== want.text) span.textContent = want.text;
    span.className = `ss-label ss-${want.kind}`;
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
    box.places.forEach(([x, y], k) => {
      const at = { x: x - box.w / 2, y: y - box.h / 2, w: box.w, h: box.h };
      const outside = at.x < 2 || at.y < 2 || at.x + at.w > width - 2 || at.y + at.h > height - 2;
      let cost = k * 0.4 + (outside ? 60 : 0) - (labels.places.get(box.key) === k ? 2.5 : 0);
      for (const other of taken) cost += overlap(at, other) > 0 ? 30 : 0;
      for (const p of points) {
        if (p[0] > at.x - 4 && p[0] < at.x + at.w + 4 && p[1] > at.y - 4 && p[1] < at.y + at.h + 4) cost += 1.5;
      }
      if (!best || cost < best.cost) best = { at, cost, k };
    });
    if (!best || (best.cost >= 28 && !box.must)) continue;
    labels.places.set(box.key, best.k);
    taken.push(best.at);
    placed.push({ text: box.text, kind: box.kind, x: best.at.x, y: best.at.y });
  }
  return placed;
}

const textWidth = (text, px) => [...text].length * px * 0.56 + 14;

function labelBoxes(view) {
  const boxes = [];
  const { drawing } = view;
  for (const field of shownFields(drawing, view.state.operation)) {
    const spot = spotOf(view, field);
    if (!spot) continue;
    const at = view.project(...spot);
    const name = drawing.operations[field.operation].name;
    const text = `${short(name)}  ${spotValue(view, field)}`;
    const [w, h] = [textWidth(text, 13), 22];
    const away = [[1, -1], [-1, -1], [1, 1], [-1, 1]].flatMap(([x, y]) =>
      [1, 2].map((f) => [at.x + x * (w / 2 + 10 * f), at.y + y * 20 * f]));
    if (at.visible) boxes.push({ key: `o${field.operation}`, text, kind: "spot", must: true, w, h, places: away });
  }
  drawing.equipment.forEach((e, k) => {
    const places = equipmentPlaces(view, k);
    const w = textWidth(short(e.name), 12);
    if (places) boxes.push({ key: `e${k}`, text: short(e.name), kind: "name", w, h: 18, places });
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

/** Round the outline of an equipment on the screen: below it, beside it, above it, on it. */
function equipmentPlaces(view, k) {
  let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const part of view.drawing.parts) {
    if (part.equipment !== k) continue;
    const at = view.poseOf(part);
    const { low, high } = part.mesh;
    for (let c = 0; c < 8; c++) {
      const corner = [0, 1, 2].map((a) => ((c >> a) & 1 ? high[a] : low[a]));
      const p = view.project(...moved(at, corner));
      if (!p.visible) return null;
      [left, right] = [Math.min(left, p.x), Math.max(right, p.x)];
      [top, bottom] = [Math.min(top, p.y), Math.max(bottom, p.y)];
    }
  }
  if (left > right) return null;
  const [x, y] = [(left + right) / 2, (top + bottom) / 2];
  return [[x, bottom - 14], [x, bottom + 10], [x, top - 10], [mix(x, left, 0.5), bottom - 18],
    [mix(x, right, 0.5), bottom - 18], [left, y], [right, y], [x, y]];
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
    const a = view.project(...point(low));
    const b = view.project(...point(high));
    const room = Math.hypot(a.x - b.x, a.y - b.y) / Math.max(high - low, 1);
    const step = [500, 1000, 2000, 5000, 10000].find((s) => s * room > 46);
    if (!step) return;
    const inwards = view.project(...times(add(add([x0, y0, z], [x1, y1, z]), [0, 0, 0]), 0.5));
    for (let v = Math.ceil(low / step) * step; v <= high; v += step) {
      const p = view.project(...point(v));
      const away = [p.x - inwards.x, p.y - inwards.y];
      const far = Math.hypot(...away) || 1;
      const text = v + step > high ? `${word} ${v} mm` : String(v);
      const [px, py] = [p.x + (away[0] / far) * 16, p.y + (away[1] / far) * 12];
      const w = textWidth(text, 10) - 14;
      if (p.visible && px > w / 2 && px < view.width - w / 2 && py > 6 && py < view.height - 6) {
        out.push({ text, kind: "tick", x: px - w / 2, y: py - 7 });
      }
    }
  };
  along(x0, x1, (v) => [v, y, z], "x");
  along(y0, y1, (v) => [x, v, z], "y");
  return out;
}
