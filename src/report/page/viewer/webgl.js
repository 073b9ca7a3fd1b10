// WebGL: context, programs, fixed buffers, shadow map and vertex arrays.

const SHADOW_SIZE = 2048;

/**
 * Returns the WebGL 2 context of a canvas.
 * @param {HTMLCanvasElement} canvas
 */
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

/**
 * Compiles a shader.
 * @param {WebGL2RenderingContext} gl
 * @param {number} kind
 * @param {string} text
 */
function compiledShader(gl, kind, text) {
  const shader = gl.createShader(kind);
  // A lost context creates no shader; the programs are compiled again when the context is restored.
  if (!shader) throw new Error("shader: the graphics card is not available");
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
    throw new Error(`shader: ${gl.getShaderInfoLog(shader)}`);
  }
  return shader;
}

/**
 * Makes all objects on the graphics card, at the start and again after a loss of the context.
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

/**
 * Makes a buffer whose content never changes.
 * @param {WebGL2RenderingContext} gl
 * @param {ArrayLike<number>} data
 */
function fixedBuffer(gl, data) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data), gl.STATIC_DRAW);
  return buffer;
}

/**
 * Makes the depth texture of the shadow map.
 * @param {WebGL2RenderingContext} gl
 */
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
 * Makes the rings of an arrow: centre and rim of its tail, end of its shaft, base and point of its head. A
 * ring has four numbers: end of the shaft (0 or 1), part of the head (0 or 1), width, and point of the head
 * (0 or 1).
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

/**
 * Selects a program and sets its uniforms.
 * @param {Graphics} graphics
 * @param {Program} program
 * @param {Uniforms} values
 */
function selectProgram({ gl }, program, values) {
  gl.useProgram(program.program);
  for (const [key, value] of Object.entries(values)) {
    const uniform = program.uniforms[key];
    if (uniform) setUniform(gl, uniform, value);
  }
}

/**
 * Sets a uniform by its type.
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
 * Makes a vertex array that binds buffers to the attributes of a program. Stride and offset count floats.
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
