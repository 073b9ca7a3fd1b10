// The graphics card: programs, buffers, and one function per kind of thing drawn.

const SHADOW_SIZE = 2048;

function canvasContext(canvas) {
  return canvas.getContext("webgl2", { alpha: true, antialias: true, premultipliedAlpha: true,
    preserveDrawingBuffer: true, powerPreference: "low-power" });
}

function compiled(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
      throw new Error(`shader: ${gl.getShaderInfoLog(shader)}`);
    }
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`program: ${gl.getProgramInfoLog(program)}`);
  }
  const made = { program, attributes: {}, uniforms: {} };
  const count = gl.getProgramParameter(program, gl.ACTIVE_ATTRIBUTES) || 0;
  for (let k = 0; k < count; k++) {
    const { name } = gl.getActiveAttrib(program, k);
    made.attributes[name] = gl.getAttribLocation(program, name);
  }
  const uniforms = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) || 0;
  for (let k = 0; k < uniforms; k++) {
    const { name, type } = gl.getActiveUniform(program, k);
    made.uniforms[name] = { at: gl.getUniformLocation(program, name), type };
  }
  return made;
}

/** Everything that lives on the graphics card; made anew after its loss. */
function makeCard(gl) {
  const programs = {
    solid: compiled(gl, SOLID_VERTEX, SOLID_FRAGMENT),
    shadow: compiled(gl, SOLID_VERTEX, SHADOW_FRAGMENT),
    line: compiled(gl, LINE_VERTEX, LINE_FRAGMENT),
    arrow: compiled(gl, ARROW_VERTEX, ARROW_FRAGMENT),
    glyph: compiled(gl, GLYPH_VERTEX, GLYPH_FRAGMENT),
    floor: compiled(gl, FLOOR_VERTEX, FLOOR_FRAGMENT),
  };
  const card = { gl, programs, buffers: {} };
  const fixed = (data) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data), gl.STATIC_DRAW);
    return buffer;
  };
  card.fixed = fixed;
  card.stripe = fixed([0, -1, 1, -1, 0, 1, 1, 1]);
  card.square = fixed([-1, -1, 1, -1, -1, 1, 1, 1]);
  card.quarter = fixed([0, 0, 1, 0, 0, 1, 1, 1]);
  card.arrow = arrowForm(fixed);
  card.shadow = shadowTarget(gl);
  return card;
}

function shadowTarget(gl) {
  const map = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, map);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW_SIZE, SHADOW_SIZE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
  for (const way of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, way, gl.LINEAR);
  for (const way of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, way, gl.CLAMP_TO_EDGE);
  const target = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, map, 0);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return { map, target };
}

/** Rings of an arrow: on its shaft (form 0 or 1, 0), at the base (1, 1) and the point (1, 1, 0, 1) of its head. */
function arrowForm(fixed) {
  const SIDES = 12;
  const rings = [[0, 0, 0, 0], [0, 0, 1, 0], [1, 0, 1, 0], [1, 1, 1, 0], [1, 1, 0, 1]];
  const [round, form] = [[], []];
  const corner = (ring, k) => {
    const turn = (2 * Math.PI * k) / SIDES;
    round.push(Math.cos(turn), Math.sin(turn));
    form.push(...ring);
  };
  for (let r = 0; r + 1 < rings.length; r++) {
    for (let k = 0; k < SIDES; k++) {
      const [a, b] = [rings[r], rings[r + 1]];
      for (const [ring, at] of [[a, k], [b, k + 1], [b, k], [a, k], [a, k + 1], [b, k + 1]]) corner(ring, at);
    }
  }
  return { round: fixed(round), form: fixed(form), count: form.length / 4 };
}

function use(card, name, values) {
  const { gl } = card;
  const { program, uniforms } = card.programs[name];
  gl.useProgram(program);
  for (const [key, value] of Object.entries(values)) {
    const uniform = uniforms[key];
    if (!uniform) continue;
    if (uniform.type === gl.FLOAT_MAT4) gl.uniformMatrix4fv(uniform.at, false, value);
    else if (uniform.type === gl.FLOAT_VEC2) gl.uniform2fv(uniform.at, value);
    else if (uniform.type === gl.FLOAT_VEC3) gl.uniform3fv(uniform.at, value);
    else if (uniform.type === gl.FLOAT_VEC4) gl.uniform4fv(uniform.at, value);
    else if (uniform.type === gl.FLOAT) gl.uniform1f(uniform.at, value);
    else gl.uniform1i(uniform.at, value);
  }
  return card.programs[name];
}

/** Binds buffers: name -> [buffer, numbers, stride in floats, offset in floats, per instance]. */
function vertexArray(card, program, wanted) {
  const { gl } = card;
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  for (const [name, [buffer, count, stride, offset, each]] of Object.entries(wanted)) {
    const at = card.programs[program].attributes[name];
    if (at === undefined) continue;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, count, gl.FLOAT, false, 4 * (stride || count), 4 * (offset || 0));
    if (each) gl.vertexAttribDivisor(at, 1);
  }
  gl.bindVertexArray(null);
  return array;
}

function uploadMesh(card, mesh) {
  const { gl } = card;
  const [positions, normals] = [card.fixed(mesh.positions), card.fixed(mesh.normals)];
  const wanted = { position: [positions, 3], normal: [normals, 3] };
  const index = gl.createBuffer();
  const [array, shade] = ["solid", "shadow"].map((program) => {
    const made = vertexArray(card, program, wanted);
    gl.bindVertexArray(made);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, index);
    gl.bindVertexArray(null);
    return made;
  });
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, index);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.indices, gl.STATIC_DRAW);
  const edges = uploadLines(card, null, mesh.edges);
  return { array, shade, count: mesh.indices.length, edges, buffers: [positions, normals, index, edges.buffer] };
}

/** A batch of instances that is filled anew whenever what it shows changes. */
function refilled(card, old, data, make) {
  const { gl } = card;
  const batch = old || { buffer: gl.createBuffer(), array: null };
  gl.bindBuffer(gl.ARRAY_BUFFER, batch.buffer);
  gl.bufferData(gl.ARRAY_BUFFER, data, old ? gl.DYNAMIC_DRAW : gl.STATIC_DRAW);
  if (!batch.array) batch.array = make(batch.buffer);
  return batch;
}

function uploadLines(card, old, data) {
  const batch = refilled(card, old, data, (b) => vertexArray(card, "line",
    { corner: [card.stripe, 2], start: [b, 3, 6, 0, true], end: [b, 3, 6, 3, true] }));
  batch.count = data.length / 6;
  return batch;
}

function uploadArrows(card, old, data) {
  const batch = refilled(card, old, data, (b) => vertexArray(card, "arrow", {
    round_: [card.arrow.round, 2], form: [card.arrow.form, 4],
    origin: [b, 3, 9, 0, true], way: [b, 3, 9, 3, true], tint: [b, 3, 9, 6, true] }));
  batch.count = data.length / 9;
  return batch;
}

function uploadGlyphs(card, old, data) {
  const batch = refilled(card, old, data, (b) => vertexArray(card, "glyph", {
    corner: [card.square, 2], centre: [b, 3, 9, 0, true], tint: [b, 4, 9, 3, true], kind: [b, 2, 9, 7, true] }));
  batch.count = data.length / 9;
  return batch;
}

function drawMesh(card, program, mesh, values) {
  use(card, program, values);
  card.gl.bindVertexArray(program === "shadow" ? mesh.shade : mesh.array);
  card.gl.drawElements(card.gl.TRIANGLES, mesh.count, card.gl.UNSIGNED_INT, 0);
}

function drawInstances(card, program, batch, values) {
  if (!batch || !batch.count) return;
  use(card, program, values);
  card.gl.bindVertexArray(batch.array);
  if (program === "arrow") card.gl.drawArraysInstanced(card.gl.TRIANGLES, 0, card.arrow.count, batch.count);
  else card.gl.drawArraysInstanced(card.gl.TRIANGLE_STRIP, 0, 4, batch.count);
}

function drawFloor(card, values) {
  if (!card.floor) card.floor = vertexArray(card, "floor", { corner: [card.quarter, 2] });
  use(card, "floor", values);
  card.gl.bindVertexArray(card.floor);
  card.gl.drawArrays(card.gl.TRIANGLE_STRIP, 0, 4);
}

function dropMesh(card, made) {
  card.gl.deleteVertexArray(made.array);
  card.gl.deleteVertexArray(made.shade);
  made.buffers.forEach((b) => card.gl.deleteBuffer(b));
}
