// WebGL: programs, buffers, and one function for each kind of thing that is drawn.

const SHADOW_SIZE = 2048;

/** Numbers of an instance: of a segment its two ends, of an arrow or a glyph nine. */
const SEGMENT_STRIDE = 6;
const INSTANCE_STRIDE = 9;

/** @param {HTMLCanvasElement} canvas */
function contextOf(canvas) {
  const context = canvas.getContext("webgl2", {
    alpha: true,
    antialias: true,
    premultipliedAlpha: true,
    preserveDrawingBuffer: true,
    powerPreference: "low-power",
  });
  if (!context) throw new Error("WebGL 2 is not available");
  return context;
}

/**
 * Compiles and links a program.
 * @param {WebGL2RenderingContext} gl
 * @param {string} vertex
 * @param {string} fragment
 * @returns {Program}
 */
function compiled(gl, vertex, fragment) {
  const program = gl.createProgram();
  gl.attachShader(program, compiledShader(gl, gl.VERTEX_SHADER, vertex));
  gl.attachShader(program, compiledShader(gl, gl.FRAGMENT_SHADER, fragment));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`program: ${gl.getProgramInfoLog(program)}`);
  }
  /** @type {Program} */
  const made = { program, attributes: {}, uniforms: {} };
  const attributes = gl.getProgramParameter(program, gl.ACTIVE_ATTRIBUTES) || 0;
  for (let k = 0; k < attributes; k++) {
    const attribute = gl.getActiveAttrib(program, k);
    if (attribute) made.attributes[attribute.name] = gl.getAttribLocation(program, attribute.name);
  }
  const uniforms = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) || 0;
  for (let k = 0; k < uniforms; k++) {
    const uniform = gl.getActiveUniform(program, k);
    const location = uniform && gl.getUniformLocation(program, uniform.name);
    if (uniform && location) made.uniforms[uniform.name] = { location, type: uniform.type };
  }
  return made;
}

/** @param {WebGL2RenderingContext} gl @param {number} kind @param {string} text */
function compiledShader(gl, kind, text) {
  const shader = gl.createShader(kind);
  // A lost context makes no shader; the program is made anew when the context comes back.
  if (!shader) throw new Error("shader: the graphics card is not available");
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
    throw new Error(`shader: ${gl.getShaderInfoLog(shader)}`);
  }
  return shader;
}

/**
 * Makes everything that lives on the graphics card. It is made anew after a loss of the context.
 * @param {WebGL2RenderingContext} gl
 * @returns {Graphics}
 */
function makeGraphics(gl) {
  const programs = {
    solid: compiled(gl, SOLID_VERTEX, SOLID_FRAGMENT),
    shadow: compiled(gl, SOLID_VERTEX, SHADOW_FRAGMENT),
    line: compiled(gl, LINE_VERTEX, LINE_FRAGMENT),
    arrow: compiled(gl, ARROW_VERTEX, ARROW_FRAGMENT),
    glyph: compiled(gl, GLYPH_VERTEX, GLYPH_FRAGMENT),
    floor: compiled(gl, FLOOR_VERTEX, FLOOR_FRAGMENT),
  };
  const quarter = fixedBuffer(gl, [0, 0, 1, 0, 0, 1, 1, 1]);
  return {
    gl,
    programs,
    stripe: fixedBuffer(gl, [0, -1, 1, -1, 0, 1, 1, 1]),
    square: fixedBuffer(gl, [-1, -1, 1, -1, -1, 1, 1, 1]),
    quarter,
    arrow: arrowForm(gl),
    shadow: shadowTarget(gl),
    floor: vertexArray(gl, programs.floor, { corner: { buffer: quarter, count: 2 } }),
    batches: {},
  };
}

/** @param {WebGL2RenderingContext} gl @param {ArrayLike<number>} data */
function fixedBuffer(gl, data) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data), gl.STATIC_DRAW);
  return buffer;
}

/** Makes the depth texture of the shadow map. @param {WebGL2RenderingContext} gl */
function shadowTarget(gl) {
  const map = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, map);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW_SIZE, SHADOW_SIZE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
  }
  for (const direction of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) {
    gl.texParameteri(gl.TEXTURE_2D, direction, gl.CLAMP_TO_EDGE);
  }
  const target = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, map, 0);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return { map, target };
}

/**
 * Makes the rings of an arrow: two on its shaft, then the base and the point of its head. A ring has four
 * numbers: end of the shaft (0 or 1), whether it belongs to the head, its width, whether it is the point.
 * @param {WebGL2RenderingContext} gl
 */
function arrowForm(gl) {
  const SIDES = 12;
  const rings = [
    [0, 0, 0, 0],
    [0, 0, 1, 0],
    [1, 0, 1, 0],
    [1, 1, 1, 0],
    [1, 1, 0, 1],
  ];
  /** @type {number[]} */
  const round = [];
  /** @type {number[]} */
  const form = [];
  for (let r = 0; r + 1 < rings.length; r++) {
    const [a, b] = [rings[r], rings[r + 1]];
    for (let side = 0; side < SIDES; side++) {
      /** @type {[number[], number][]} */
      const corners = [
        [a, side],
        [b, side + 1],
        [b, side],
        [a, side],
        [a, side + 1],
        [b, side + 1],
      ];
      for (const [ring, k] of corners) {
        const angle = (2 * Math.PI * k) / SIDES;
        round.push(Math.cos(angle), Math.sin(angle));
        form.push(...ring);
      }
    }
  }
  return { round: fixedBuffer(gl, round), form: fixedBuffer(gl, form), count: form.length / 4 };
}

/** Selects a program and sets its uniforms. @param {Graphics} graphics @param {Program} program @param {Uniforms} values */
function selectProgram({ gl }, program, values) {
  gl.useProgram(program.program);
  for (const [key, value] of Object.entries(values)) {
    const uniform = program.uniforms[key];
    if (uniform) setUniform(gl, uniform, value);
  }
}

/**
 * @param {WebGL2RenderingContext} gl
 * @param {{ location: WebGLUniformLocation, type: number }} uniform
 * @param {number | number[]} value
 */
function setUniform(gl, { location, type }, value) {
  if (typeof value === "number") {
    if (type === gl.FLOAT) gl.uniform1f(location, value);
    else gl.uniform1i(location, value);
  } else if (type === gl.FLOAT_MAT4) gl.uniformMatrix4fv(location, false, value);
  else if (type === gl.FLOAT_VEC2) gl.uniform2fv(location, value);
  else if (type === gl.FLOAT_VEC3) gl.uniform3fv(location, value);
  else gl.uniform4fv(location, value);
}

/**
 * Binds buffers to the attributes of a program. Stride and offset count floats.
 * @typedef {{ buffer: WebGLBuffer, count: number, stride?: number, offset?: number }} AttributeSource
 * @param {WebGL2RenderingContext} gl
 * @param {Program} program
 * @param {Record<string, AttributeSource>} perVertex
 * @param {Record<string, AttributeSource>} [perInstance]
 */
function vertexArray(gl, program, perVertex, perInstance = {}) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  for (const [name, { buffer, count, stride, offset }] of Object.entries({ ...perVertex, ...perInstance })) {
    const location = program.attributes[name];
    if (location === undefined) continue;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, count, gl.FLOAT, false, 4 * (stride || count), 4 * (offset || 0));
    if (name in perInstance) gl.vertexAttribDivisor(location, 1);
  }
  gl.bindVertexArray(null);
  return array;
}

/** Brings a mesh to the graphics card. @param {Graphics} graphics @param {Mesh} mesh @returns {MeshBuffers} */
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
 * Fills a batch of instances anew.
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

/** @param {Graphics} graphics @param {Batch | undefined} old @param {Float32Array<ArrayBuffer>} data */
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

/** @param {Graphics} graphics @param {Batch | undefined} old @param {Float32Array<ArrayBuffer>} data */
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

/** @param {Graphics} graphics @param {Batch | undefined} old @param {Float32Array<ArrayBuffer>} data */
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

/** @param {Graphics} graphics @param {"solid" | "shadow"} name @param {MeshBuffers} mesh @param {Uniforms} values */
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

/** @param {Graphics} graphics @param {Uniforms} values */
function drawFloor(graphics, values) {
  const { gl, programs, floor } = graphics;
  selectProgram(graphics, programs.floor, values);
  gl.bindVertexArray(floor);
  gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
}

/** Frees a mesh on the graphics card. @param {Graphics} graphics @param {MeshBuffers} mesh */
function dropMesh({ gl }, mesh) {
  gl.deleteVertexArray(mesh.array);
  gl.deleteVertexArray(mesh.shadowArray);
  for (const buffer of mesh.buffers) gl.deleteBuffer(buffer);
}
