// Reader of a document (sweetspot/drawing/1): converts encoded arrays to typed arrays and matrices.

/**
 * Reads a document.
 * @param {DrawingDocument} written
 * @param {Map<string, Mesh>} known meshes of an earlier document, which are used again
 * @returns {Model}
 */
function readModel(written, known) {
  if (written.schema !== "sweetspot/drawing/1") throw new Error(`not a drawing: ${written.schema}`);
  const meshes = written.meshes.map((mesh) => readMesh(mesh, known));
  const drawings = written.drawings.map((drawing) => readDrawing(drawing, meshes));
  return { meshes, drawings, ...modelExtent(drawings), points: drawings.flatMap(pointsOf) };
}

/**
 * Reads one layout of a document.
 * @param {DrawingRecord} written
 * @param {Mesh[]} meshes
 * @returns {Drawing}
 */
function readDrawing(written, meshes) {
  const rings = (/** @type {EncodedArray[]} */ all) => all.map(floatsOf);
  return {
    ...written,
    base: matrixOf(written.base),
    parts: written.parts.map((part) => ({
      ...part,
      mesh: meshes[part.mesh],
      at: part.at && matrixOf(part.at),
    })),
    equipment: written.equipment.map((one) => ({ ...one, at: one.at && matrixOf(one.at) })),
    envelopes: written.envelopes.map((one) => ({ atWork: rings(one.at_work), around: rings(one.around) })),
    movement: { ...written.movement, frames: floatsOf(written.movement.frames) },
    fields: written.fields.map(readField),
  };
}

/**
 * Reads an error map.
 * @param {FieldRecord} written
 * @returns {Field}
 */
function readField(written) {
  /** @type {Take[]} */
  const takes = [];
  for (const { lens, error, values, best } of written.takes) {
    takes[lens] = { error: floatsOf(error), values: values.map(floatsOf), best };
  }
  const positions = floatsOf(written.positions);
  const field = { ...written, positions, takes, count: written.nodes.length, spacing: 0 };
  field.spacing = spacingOf(field);
  return field;
}

/**
 * Reads a mesh, or returns the known mesh with the same content.
 * @param {MeshRecord} written
 * @param {Map<string, Mesh>} known
 * @returns {Mesh}
 */
function readMesh(written, known) {
  const key = `${written.positions} ${written.normals} ${written.indices}`;
  const kept = known.get(key);
  if (kept) return kept;
  const positions = floatsOf(written.positions);
  const indices = integersOf(written.indices);
  return {
    key,
    positions,
    normals: floatsOf(written.normals),
    indices,
    edges: featureEdges(positions, indices),
    anchors: anchorsOf(positions, indices),
    ...extentOf(positions),
    buffers: null,
  };
}

/**
 * Returns point `k` of a list of coordinates.
 * @param {ArrayLike<number>} positions
 * @param {number} k
 * @returns {Vector}
 */
const pointAt = (positions, k) => [positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]];

/**
 * Returns the bounding box of a list of coordinates.
 * @param {ArrayLike<number>} positions
 * @returns {Extent}
 */
function extentOf(positions) {
  const extent = emptyExtent();
  for (let k = 0; k < positions.length / 3; k++) enlarge(extent, pointAt(positions, k));
  return extent;
}

/**
 * Returns an empty box.
 * @returns {Extent}
 */
const emptyExtent = () => ({
  low: [Infinity, Infinity, Infinity],
  high: [-Infinity, -Infinity, -Infinity],
});

/**
 * Extends a box to contain a point.
 * @param {Extent} extent
 * @param {Vector} point
 */
function enlarge({ low, high }, point) {
  for (let k = 0; k < 3; k++) {
    low[k] = Math.min(low[k], point[k]);
    high[k] = Math.max(high[k], point[k]);
  }
}

/**
 * Finds creases and borders: edges whose pair of corner indices occurs in only one triangle. The triangles on
 * the two sides of a crease have separate corners.
 * @param {ArrayLike<number>} positions
 * @param {ArrayLike<number>} indices
 */
function featureEdges(positions, indices) {
  const count = positions.length / 3;
  /** @type {Map<number, number[] | null>} */
  const edges = new Map();
  for (let k = 0; k < indices.length; k += 3) {
    for (let corner = 0; corner < 3; corner++) {
      const [a, b] = [indices[k + corner], indices[k + ((corner + 1) % 3)]];
      const key = Math.min(a, b) * count + Math.max(a, b);
      edges.set(key, edges.has(key) ? null : [a, b]);
    }
  }
  // Only the long edges of a finely modelled surface are shown, because short edges would blacken it.
  const { low, high } = extentOf(positions);
  const shortest = edges.size > 6000 ? norm(subtract(high, low)) * 0.12 : 0;
  /** @type {number[]} */
  const lines = [];
  const seen = new Set();
  for (const edge of edges.values()) {
    if (!edge) continue;
    const [start, end] = edge.map((k) => pointAt(positions, k));
    if (norm(subtract(start, end)) < shortest) continue;
    const names = [start, end].map((point) => point.map((value) => Math.round(value * 100)).join(","));
    const key = names.sort().join(";");
    if (seen.has(key)) continue;
    seen.add(key);
    lines.push(...start, ...end);
  }
  return new Float32Array(lines);
}

/**
 * Returns points on a mesh to which a leader line may lead: corners and middles of edges, spread over the
 * mesh.
 * @param {ArrayLike<number>} positions
 * @param {ArrayLike<number>} indices
 */
function anchorsOf(positions, indices) {
  const step = 3 * Math.ceil(indices.length / 3 / 24);
  /** @type {Vector[]} */
  const anchors = [];
  for (let k = 0; k + 2 < indices.length; k += step) {
    const [a, b, c] = [0, 1, 2].map((corner) => pointAt(positions, indices[k + corner]));
    anchors.push(a, scaled(add(a, c), 0.5), scaled(add(b, c), 0.5));
  }
  return anchors;
}

/**
 * Returns the position of a node without displacement, mm.
 * @param {Field} field
 * @param {number} k
 */
const nodeAt = (field, k) => pointAt(field.positions, k);

/**
 * Returns the mean distance between neighbouring nodes, mm.
 * @param {Field} field
 */
function spacingOf(field) {
  const [across] = field.size;
  let sum = 0;
  let count = 0;
  for (let k = 0; k < field.count; k++) {
    for (const step of [1, across]) {
      const endsRow = step === 1 && (k + 1) % across === 0;
      if (k + step >= field.count || endsRow) continue;
      sum += norm(subtract(nodeAt(field, k + step), nodeAt(field, k)));
      count += 1;
    }
  }
  return count ? sum / count : 100;
}

/**
 * Returns the bounding box of all layouts.
 * @param {Drawing[]} drawings
 */
function modelExtent(drawings) {
  const extent = emptyExtent();
  for (const drawing of drawings) {
    for (const corner of drawing.extent_mm) enlarge(extent, corner);
    enlarge(extent, [drawing.base[12], drawing.base[13], drawing.floor_mm]);
    for (const field of drawing.fields) {
      for (let k = 0; k < field.count; k++) enlarge(extent, nodeAt(field, k));
    }
  }
  return extent;
}

/**
 * Returns the points that must be in the picture: corners of all parts, and all nodes.
 * @param {Drawing} drawing
 * @returns {Vector[]}
 */
function pointsOf(drawing) {
  const frames = framesAt(drawing.movement, timeOf(drawing, null));
  const points = drawing.parts.flatMap((part) => {
    const pose = part.at || (part.link === null ? drawing.base : frames[part.link] || drawing.base);
    return cornersOf(part.mesh).map((corner) => moved(pose, corner));
  });
  for (const field of drawing.fields) {
    for (let k = 0; k < field.count; k++) points.push(nodeAt(field, k));
  }
  return points;
}

/**
 * Returns the eight corners of a box.
 * @param {Extent} extent
 * @returns {Vector[]}
 */
const cornersOf = ({ low, high }) =>
  [0, 1, 2, 3, 4, 5, 6, 7].map((corner) =>
    [0, 1, 2].map((axis) => ((corner >> axis) & 1 ? high : low)[axis]),
  );
