// Meshes and batches of instances on the graphics card: how they are uploaded and drawn.

/** Numbers per instance: six for a segment (its two ends), nine for an arrow or a glyph. */
const SEGMENT_STRIDE = 6;
const INSTANCE_STRIDE = 9;

/**
 * Uploads a mesh to the graphics card.
 * @param {Graphics} graphics
 * @param {Mesh} mesh
 * @returns {MeshBuffers}
 */
function uploadMesh(graphics, mesh) {
  const { gl, programs } = graphics;
  const [positions, normals] = [fixedBuffer(gl, mesh.positions), fixedBuffer(gl, mesh.normals)];
  const sources = { position: { buffer: positions, count: 3 }, normal: { buffer: normals, count: 3 } };
  const index = gl.createBuffer();
  const [array, shadowArray] = [programs.solid, programs.shadow].map((program) => {
    const made = vertexArray(gl, program, sources);
    gl.bindVertexArray(made);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, index);
    gl.bindVertexArray(null);
    return made;
  });
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, index);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.indices, gl.STATIC_DRAW);
  const edges = uploadLines(graphics, undefined, mesh.edges);
  const buffers = [positions, normals, index, edges.buffer];
  return { array, shadowArray, count: mesh.indices.length, edges, buffers };
}

/**
 * Fills a batch of instances with new data; makes the batch if there is no old one.
 * @param {Graphics} graphics
 * @param {Batch | undefined} old
 * @param {Float32Array<ArrayBuffer>} data
 * @param {number} stride
 * @param {(buffer: WebGLBuffer) => WebGLVertexArrayObject} makeArray
 * @returns {Batch}
 */
function refilled({ gl }, old, data, stride, makeArray) {
  const buffer = old ? old.buffer : gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, data, old ? gl.DYNAMIC_DRAW : gl.STATIC_DRAW);
  return { buffer, array: old ? old.array : makeArray(buffer), count: data.length / stride };
}

/**
 * Uploads segments: six numbers each.
 * @param {Graphics} graphics
 * @param {Batch | undefined} old
 * @param {Float32Array<ArrayBuffer>} data
 */
function uploadLines(graphics, old, data) {
  const stride = SEGMENT_STRIDE;
  return refilled(graphics, old, data, stride, (buffer) =>
    vertexArray(
      graphics.gl,
      graphics.programs.line,
      { corner: { buffer: graphics.stripe, count: 2 } },
      { start: { buffer, count: 3, stride }, end: { buffer, count: 3, stride, offset: 3 } },
    ),
  );
}

/**
 * Uploads arrows: origin, vector and colour.
 * @param {Graphics} graphics
 * @param {Batch | undefined} old
 * @param {Float32Array<ArrayBuffer>} data
 */
function uploadArrows(graphics, old, data) {
  const stride = INSTANCE_STRIDE;
  const { round, form } = graphics.arrow;
  return refilled(graphics, old, data, stride, (buffer) =>
    vertexArray(
      graphics.gl,
      graphics.programs.arrow,
      { round_: { buffer: round, count: 2 }, form: { buffer: form, count: 4 } },
      {
        origin: { buffer, count: 3, stride },
        way: { buffer, count: 3, stride, offset: 3 },
        tint: { buffer, count: 3, stride, offset: 6 },
      },
    ),
  );
}

/**
 * Uploads glyphs: centre, colour with alpha, code of the mark and size.
 * @param {Graphics} graphics
 * @param {Batch | undefined} old
 * @param {Float32Array<ArrayBuffer>} data
 */
function uploadGlyphs(graphics, old, data) {
  const stride = INSTANCE_STRIDE;
  return refilled(graphics, old, data, stride, (buffer) =>
    vertexArray(
      graphics.gl,
      graphics.programs.glyph,
      { corner: { buffer: graphics.square, count: 2 } },
      {
        centre: { buffer, count: 3, stride },
        tint: { buffer, count: 4, stride, offset: 3 },
        kind: { buffer, count: 2, stride, offset: 7 },
      },
    ),
  );
}

/**
 * Draws a mesh with a program.
 * @param {Graphics} graphics
 * @param {"solid" | "shadow"} name
 * @param {MeshBuffers} mesh
 * @param {Uniforms} values
 */
function drawMesh(graphics, name, mesh, values) {
  const { gl, programs } = graphics;
  selectProgram(graphics, programs[name], values);
  gl.bindVertexArray(name === "shadow" ? mesh.shadowArray : mesh.array);
  gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_INT, 0);
}

/**
 * Draws a batch of segments, arrows or glyphs.
 * @param {Graphics} graphics
 * @param {"line" | "arrow" | "glyph"} name
 * @param {Batch | undefined} batch
 * @param {Uniforms} values
 */
function drawInstances(graphics, name, batch, values) {
  if (!batch?.count) return;
  const { gl, programs } = graphics;
  selectProgram(graphics, programs[name], values);
  gl.bindVertexArray(batch.array);
  if (name === "arrow") gl.drawArraysInstanced(gl.TRIANGLES, 0, graphics.arrow.count, batch.count);
  else gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, batch.count);
}

/**
 * Draws the floor.
 * @param {Graphics} graphics
 * @param {Uniforms} values
 */
function drawFloor(graphics, values) {
  const { gl, programs, floor } = graphics;
  selectProgram(graphics, programs.floor, values);
  gl.bindVertexArray(floor);
  gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
}

/**
 * Frees a mesh on the graphics card.
 * @param {Graphics} graphics
 * @param {MeshBuffers} mesh
 */
function dropMesh({ gl }, mesh) {
  gl.deleteVertexArray(mesh.array);
  gl.deleteVertexArray(mesh.shadowArray);
  for (const buffer of mesh.buffers) gl.deleteBuffer(buffer);
}
