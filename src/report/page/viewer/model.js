// The document (sweetspot/drawing/1) read: typed arrays, matrices, and what is asked of them.

/** Edges between faces with a crease, and borders: those that only one triangle has by its corner numbers. */
function featureEdges(positions, indices) {
  const count = positions.length / 3;
  const seen = new Map();
  for (let k = 0; k < indices.length; k += 3) {
    for (let e = 0; e < 3; e++) {
      const [a, b] = [indices[k + e], indices[k + ((e + 1) % 3)]];
      const key = Math.min(a, b) * count + Math.max(a, b);
      seen.set(key, seen.has(key) ? null : [a, b]);
    }
  }
  // Of a finely modelled surface the long edges only: the short ones would blacken it.
  const { low, high } = extentOf(positions);
  const least = seen.size > 6000 ? size(minus(high, low)) * 0.12 : 0;
  const [lines, drawn] = [[], new Set()];
  for (const pair of seen.values()) {
    if (!pair) continue;
    const ends = pair.map((k) => [positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]]);
    if (size(minus(ends[0], ends[1])) < least) continue;
    const names = ends.map((p) => p.map((v) => Math.round(v * 100)).join(","));
    const key = names[0] < names[1] ? names.join(";") : `${names[1]};${names[0]}`;
    if (drawn.has(key)) continue;
    drawn.add(key);
    lines.push(...ends[0], ...ends[1]);
  }
  return new Float32Array(lines);
}

function extentOf(positions) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let k = 0; k < positions.length; k++) {
    low[k % 3] = Math.min(low[k % 3], positions[k]);
    high[k % 3] = Math.max(high[k % 3], positions[k]);
  }
  return { low, high };
}

/** Meshes that an earlier document had as well are kept, and with them what is on the graphics card. */
function readMesh(written, known) {
  const key = `${written.positions} ${written.normals} ${written.indices}`;
  if (known.has(key)) return known.get(key);
  const [positions, normals] = [floats(written.positions), floats(written.normals)];
  const indices = integers(written.indices);
  const mesh = { key, positions, normals, indices, edges: featureEdges(positions, indices), ...extentOf(positions) };
  return { ...mesh, marks: marksOf(mesh) };
}

/** A few points on a mesh to which a line may lead: middles of faces spread over it, and corners. */
function marksOf({ positions, indices }) {
  const corner = (k) => [positions[3 * indices[k]], positions[3 * indices[k] + 1], positions[3 * indices[k] + 2]];
  const step = 3 * Math.ceil(indices.length / 3 / 24);
  const marks = [];
  for (let k = 0; k + 2 < indices.length; k += step) {
    const [a, b, c] = [corner(k), corner(k + 1), corner(k + 2)];
    marks.push(a, times(add(a, c), 0.5), times(add(b, c), 0.5));
  }
  return marks;
}

function readModel(written, known) {
  if (written.schema !== "sweetspot/drawing/1") throw new Error(`not a drawing: ${written.schema}`);
  const meshes = written.meshes.map((m) => readMesh(m, known));
  const drawings = written.drawings.map((d) => readDrawing(d, meshes));
  return { meshes, drawings, ...wholeExtent(drawings), points: drawings.flatMap(pointsOf) };
}

function readDrawing(d, meshes) {
  const parts = d.parts.map((p) => ({ ...p, mesh: meshes[p.mesh], at: p.at && matrix(p.at) }));
  const equipment = d.equipment.map((e) => ({ ...e, at: e.at && matrix(e.at) }));
  const rings = (all) => all.map(floats);
  const envelopes = d.envelopes.map((e) => ({ atWork: rings(e.at_work), around: rings(e.around) }));
  const movement = { ...d.movement, frames: floats(d.movement.frames) };
  const fields = d.fields.map(readField);
  return { ...d, base: matrix(d.base), parts, equipment, envelopes, movement, fields };
}

function readField(f) {
  const takes = [];
  for (const t of f.takes) takes[t.lens] = { error: floats(t.error), values: t.values.map(floats), best: t.best };
  const positions = floats(f.positions);
  const field = { ...f, positions, takes, count: f.nodes.length };
  field.spacing = spacingOf(field);
  return field;
}

const nodeAt = (field, k) => [field.positions[3 * k], field.positions[3 * k + 1], field.positions[3 * k + 2]];

/** Between neighbouring nodes on average, mm. */
function spacingOf(field) {
  let [sum, count] = [0, 0];
  for (let k = 0; k < field.count; k++) {
    for (const step of [1, field.size[0]]) {
      if (k + step >= field.count || (step === 1 && (k + 1) % field.size[0] === 0)) continue;
      sum += size(minus(nodeAt(field, k + step), nodeAt(field, k)));
      count += 1;
    }
  }
  return count ? sum / count : 100;
}

function wholeExtent(drawings) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  const take = (p) => p.forEach((v, k) => {
    low[k] = Math.min(low[k], v);
    high[k] = Math.max(high[k], v);
  });
  for (const d of drawings) {
    d.extent_mm.forEach(take);
    take([d.base[12], d.base[13], d.floor_mm]);
    for (const f of d.fields) for (let k = 0; k < f.count; k++) take(nodeAt(f, k));
  }
  return { low, high };
}

/** What must be in the picture: corners of everything that stands and moves, nodes. */
function pointsOf(d) {
  const frames = framesAt(d.movement, timeOf(d, null));
  const corners = d.parts.flatMap((p) => [0, 1, 2, 3, 4, 5, 6, 7].map((c) => {
    const corner = [0, 1, 2].map((a) => ((c >> a) & 1 ? p.mesh.high[a] : p.mesh.low[a]));
    return moved(p.at || frames[p.link] || d.base, corner);
  }));
  return corners.concat(d.fields.flatMap((f) => Array.from({ length: f.count }, (_, k) => nodeAt(f, k))));
}

/** Which take of a field answers a lens of another drawing; -1 if none does. */
const lensIn = (drawing, lens) =>
  drawing.lenses.findIndex((l) => l.model === lens.model && l.reading === lens.reading);

/** Index of a sense in a field: null means the operation's own. */
function senseIn(field, name) {
  const at = name === null ? -1 : field.senses.findIndex((s) => s.name === name);
  return at < 0 ? field.sense : at;
}

/** Least and greatest value over all drawings and operations that share a unit. */
function rangeOf(model, lens, sense, wordOfUnit) {
  let [low, high] = [Infinity, -Infinity];
  for (const d of model.drawings) {
    const at = lensIn(d, lens);
    for (const f of at < 0 ? [] : d.fields) {
      const s = senseIn(f, sense);
      if (f.senses[s].unit !== wordOfUnit) continue;
      for (const v of f.takes[at].values[s]) {
        if (v < low) low = v;
        if (v > high) high = v;
      }
    }
  }
  return low <= high ? { low, high } : null;
}

/** The longest of the arrows wanted over all drawings under a lens, mm of error. */
function longestError(model, lens, arrows) {
  const axis = "xyz".indexOf(arrows);
  let longest = 0;
  for (const d of model.drawings) {
    const at = lensIn(d, lens);
    for (const f of at < 0 ? [] : d.fields) {
      for (let k = 0; k < f.count; k++) {
        const e = (arrows.length > 1 ? resultant : components)(f, at, k, lens.signed);
        if (e) longest = Math.max(longest, axis < 0 ? size(e) : Math.abs(e[axis]));
      }
    }
  }
  return longest;
}

function errorAt(field, lens, k) {
  const { error } = field.takes[lens];
  return isNaN(error[3 * k]) ? null : [error[3 * k], error[3 * k + 1], error[3 * k + 2]];
}

function valueOf(field, lens, name, k) {
  const at = field.senses.findIndex((s) => s.name === name);
  return at < 0 ? NaN : field.takes[lens].values[at][k];
}

/** The error, or without a sign the direction of the worst corner scaled to the value in xyz. */
function resultant(field, lens, k, signed) {
  const error = errorAt(field, lens, k);
  if (!error || signed) return error;
  const value = valueOf(field, lens, "xyz", k);
  return isNaN(value) ? error : times(unit(error), value);
}

/** The error along x, y and z; without a sign how far to both sides. */
function components(field, lens, k, signed) {
  const error = errorAt(field, lens, k);
  if (!error || signed) return error;
  return ["x", "y", "z"].map((name, c) => {
    const value = valueOf(field, lens, name, k);
    return isNaN(value) ? Math.abs(error[c]) : value;
  });
}

/** Frames of the robot at a time, matrices; between two pictures in proportion. */
function framesAt(movement, time) {
  const { times_s: moments, frames, links } = movement;
  if (!moments.length) return [];
  let [low, high] = [0, moments.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (moments[middle] <= time) low = middle;
    else high = middle;
  }
  const span = moments[high] - moments[low];
  const share = span > 0 ? clamp((time - moments[low]) / span, 0, 1) : 0;
  const stride = 12 * links;
  const out = [];
  for (let k = 0; k < links; k++) {
    const pose = [];
    for (let c = 0; c < 12; c++) {
      pose.push(mix(frames[low * stride + 12 * k + c], frames[high * stride + 12 * k + c], share));
    }
    out.push(matrix(pose));
  }
  return out;
}

/** Whose part is held at a time; null: nobody's. */
function heldAt(movement, time) {
  const { times_s: moments, holding } = movement;
  let at = moments.findIndex((t) => t > time);
  at = at < 0 ? moments.length - 1 : Math.max(at - 1, 0);
  return holding.length ? holding[at] : null;
}

/** When the robot is at the spot of an operation; of the first for null; 0 if there is none. */
function timeOf(drawing, operation) {
  const stops = drawing.movement.stops.filter((s) => s.operation !== null);
  const stop = operation === null ? stops[0] : stops.find((s) => s.operation === operation);
  return stop ? stop.time_s + 0.3 : 0;
}
