// Signs and arrows of the error map as instances for the graphics card.

// Numbers of the signs in GLYPH_FRAGMENT: three of its own, then those of NODE_SIGNS.
const SIGN = { dot: 0, spot: 1, diamond: 2 };
Object.keys(NODE_SIGNS).forEach((name, k) => { SIGN[name] = FIRST_NODE_SIGN + k; });
const TONES = {
  quiet: { light: hex("#5b6570"), dark: hex("#9aa4af") },
  warning: { light: hex("#b86e00"), dark: hex("#f0b429") },
  alarm: { light: hex("#cf222e"), dark: hex("#ff6b61") },
};
const SPOT = { light: hex("#bf3989"), dark: hex("#ff7ac2") };

/** Which fields are shown: all, or that of one operation. */
const shownFields = (drawing, operation) =>
  drawing.fields.filter((f) => operation === null || f.operation === operation);

/** Where a node is now: with what carries it, moved while it is dragged. */
const placeOf = (view, field, p) => {
  const shift = view.shifts.get(field.equipment);
  return shift ? moved(shift, p) : p;
};

/** Colour of a node under the state; null where it has no value. */
function colourAt(view, field, k) {
  const { lens, scale } = view;
  const s = senseIn(field, view.state.sense);
  const value = lens < 0 ? NaN : field.takes[lens].values[s][k];
  if (isNaN(value)) return null;
  if (scale.other) {
    const far = differenceAt(view, field, k);
    return far === null ? null : colourOn(DIVERGING, 0.5 + (0.5 * far) / scale.most);
  }
  const range = scale.ranges[field.senses[s].unit];
  return range ? colourOn(VIRIDIS, (value - range.low) / Math.max(range.high - range.low, 1e-12)) : null;
}

/** How much worse (positive) a node is than the same node of the layout compared with. */
function differenceAt(view, field, k) {
  const { other } = view.scale;
  const theirs = other && other.fields.find((f) => f.operation === field.operation);
  const lens = theirs ? lensIn(other, view.drawing.lenses[view.lens]) : -1;
  if (lens < 0 || String(theirs.size) !== String(field.size) || theirs.count !== field.count) return null;
  const own = field.senses[senseIn(field, view.state.sense)].name;
  const far = valueOf(field, view.lens, own, k) - valueOf(theirs, lens, own, k);
  return isNaN(far) ? null : far;
}

function glyphInstances(view) {
  const out = [];
  const { theme, drawing, state } = view;
  const push = (p, colour, alpha, sign, big) => out.push(...p, ...colour, alpha, SIGN[sign], big);
  for (const field of shownFields(drawing, state.operation)) {
    for (let k = 0; k < field.count; k++) {
      const p = placeOf(view, field, nodeAt(field, k));
      const { glyph } = NODE_SIGNS[field.status[k]];
      if (glyph) push(p, TONES[glyph.tone][theme], 1, field.status[k], 1.15);
      else push(p, colourAt(view, field, k) || TONES.quiet[theme], 1, "dot", 0.8);
    }
  }
  return new Float32Array(out);
}

/** The spots, drawn last and over everything. */
function spotInstances(view) {
  const out = [];
  const { theme, drawing, state } = view;
  for (const field of shownFields(drawing, state.operation)) {
    const spot = spotOf(view, field);
    if (spot) out.push(...spot, ...SPOT[theme], 1, SIGN.spot, 2.1);
    if (field.refined_mm && isOwnLens(view)) {
      out.push(...placeOf(view, field, field.refined_mm), ...SPOT[theme], 1, SIGN.diamond, 1.35);
    }
  }
  return new Float32Array(out);
}

const isOwnLens = (view) => view.lens === 0;

/** The spot under the lens looked through. */
function spotOf(view, field) {
  if (isOwnLens(view) && field.spot_mm) return placeOf(view, field, field.spot_mm);
  const take = field.takes[view.lens];
  const best = take ? take.best : null;
  return best === null ? null : placeOf(view, field, nodeAt(field, best));
}

function arrowInstances(view) {
  const out = [];
  const { drawing, state, lens, times: enlarged } = view;
  if (state.arrows === "none" || lens < 0) return new Float32Array();
  const { signed } = drawing.lenses[lens];
  const axes = { x: [0], y: [1], z: [2], components: [0, 1, 2] }[state.arrows];
  for (const field of shownFields(drawing, state.operation)) {
    for (let k = 0; k < field.count; k++) {
      const colour = field.status[k] === "ok" ? colourAt(view, field, k) : null;
      if (!colour) continue;
      const p = placeOf(view, field, nodeAt(field, k));
      const push = (way) => {
        if (size(way) > 1e-9) out.push(...p, ...times(way, enlarged), ...colour);
      };
      if (!axes) push(resultant(field, lens, k, signed));
      else {
        const along = components(field, lens, k, signed);
        for (const axis of axes) {
          const way = [0, 0, 0];
          way[axis] = along[axis];
          push(way);
          if (!signed) push(times(way, -1));
        }
      }
    }
  }
  return new Float32Array(out);
}

/** The net of the grid, faint; and a pin from each spot down to the surface. */
function netInstances(view) {
  const out = [];
  for (const field of shownFields(view.drawing, view.state.operation)) {
    const [across] = field.size;
    if (field.size[1] < 2) continue;
    for (let k = 0; k < field.count; k++) {
      const p = placeOf(view, field, nodeAt(field, k));
      if ((k + 1) % across) out.push(...p, ...placeOf(view, field, nodeAt(field, k + 1)));
      if (k + across < field.count) out.push(...p, ...placeOf(view, field, nodeAt(field, k + across)));
    }
  }
  return new Float32Array(out);
}

function pinInstances(view) {
  const out = [];
  for (const field of shownFields(view.drawing, view.state.operation)) {
    const spot = spotOf(view, field);
    const deep = view.drawing.operations[field.operation].standoff_mm;
    if (spot && deep > 0) out.push(...spot, spot[0], spot[1], spot[2] - deep);
  }
  return new Float32Array(out);
}

function ringInstances(rings) {
  const out = [];
  for (const ring of rings) {
    const count = ring.length / 3;
    for (let k = 0; k < count; k++) {
      const next = (k + 1) % count;
      out.push(ring[3 * k], ring[3 * k + 1], ring[3 * k + 2], ring[3 * next], ring[3 * next + 1], ring[3 * next + 2]);
    }
  }
  return new Float32Array(out);
}
