'use strict';
// The functions of bench/shading/gl_context.hpp over a WebGL2 context: objects become numbers, pointers become views of
// the module's memory.
function WebGl(gl, memory) {
  for (const name of ['EXT_color_buffer_float', 'EXT_float_blend', 'OES_texture_float_linear']) gl.getExtension(name);
  const objects = [null], names = new Map(), locations = new Map();
  const nameOf = (object) => {
    if (!object) return 0;
    if (!names.has(object)) names.set(object, objects.push(object) - 1);
    return names.get(object);
  };
  const forget = (name) => {
    const object = objects[name];
    names.delete(object);
    objects[name] = null;
    return object;
  };
  const heap = () => memory().buffer;
  const floats = (at, count) => new Float32Array(heap(), at, count);
  const ints = (at, count) => new Int32Array(heap(), at, count);
  const bytes = (at, count) => new Uint8Array(heap(), at, count);
  const decoder = new TextDecoder();
  function string(at, size) {
    const all = new Uint8Array(heap());
    let end = at + (size ?? 0);
    if (size === undefined) for (end = at; all[end]; ++end);
    return decoder.decode(all.subarray(at, end));
  }
  // From `at` to the end of memory, as elements of an OpenGL type; null stays null.
  function texels(type, at) {
    if (!at) return null;
    if (type === gl.UNSIGNED_BYTE) return new Uint8Array(heap(), at);
    const rest = (heap().byteLength - at) >> 2;
    return type === gl.FLOAT ? new Float32Array(heap(), at, rest) : new Uint32Array(heap(), at, rest);
  }
  const generate = (make) => (count, at) => {
    for (let i = 0; i < count; ++i) ints(at, count)[i] = nameOf(make());
  };
  const remove = (drop) => (count, at) => {
    for (const name of ints(at, count)) drop(forget(name));
  };
  const bind = (call) => (target, name) => call(target, objects[name]);
  const putLog = (log, size, length, at) => {
    const to = bytes(at, size);
    to.fill(0);
    new TextEncoder().encodeInto(log, to.subarray(0, size - 1));
  };
  const query = (value, log) => (what, at) => {
    ints(at, 1)[0] = what === gl.INFO_LOG_LENGTH ? (log() ?? '').length * 4 + 1 : Number(value(what));
  };
  // Sources wait for compiling; a location is asked for once.
  const api = {
    AttachShader: (program, shader) => gl.attachShader(objects[program], objects[shader]),
    BindBuffer: bind((target, object) => gl.bindBuffer(target, object)),
    BindBufferBase: (target, index, buffer) => gl.bindBufferBase(target, index, objects[buffer]),
    BindFramebuffer: bind((target, object) => gl.bindFramebuffer(target, object)),
    BindTexture: bind((target, object) => gl.bindTexture(target, object)),
    BindVertexArray: (name) => gl.bindVertexArray(objects[name]),
    BufferData: (target, size, at, usage) =>
      at ? gl.bufferData(target, bytes(at, size), usage) : gl.bufferData(target, size, usage),
    ClearBufferfv: (buffer, index, at) => gl.clearBufferfv(buffer, index, floats(at, buffer === gl.COLOR ? 4 : 1)),
    CompileShader: (shader) => gl.compileShader(objects[shader]),
    CreateProgram: () => nameOf(gl.createProgram()),
    CreateShader: (kind) => nameOf(gl.createShader(kind)),
    DeleteBuffers: remove((object) => gl.deleteBuffer(object)),
    DeleteFramebuffers: remove((object) => gl.deleteFramebuffer(object)),
    DeleteTextures: remove((object) => gl.deleteTexture(object)),
    DeleteVertexArrays: remove((object) => gl.deleteVertexArray(object)),
    DeleteProgram: (program) => gl.deleteProgram(forget(program)),
    // It lives on with its program, and is not named again.
    DeleteShader: (shader) => gl.deleteShader(objects[shader]),
    FramebufferTexture2D: (target, attachment, kind, texture, level) =>
      gl.framebufferTexture2D(target, attachment, kind, objects[texture], level),
    FramebufferTextureLayer: (target, attachment, texture, level, layer) =>
      gl.framebufferTextureLayer(target, attachment, objects[texture], level, layer),
    GenBuffers: generate(() => gl.createBuffer()),
    GenFramebuffers: generate(() => gl.createFramebuffer()),
    GenTextures: generate(() => gl.createTexture()),
    GenVertexArrays: generate(() => gl.createVertexArray()),
    GetIntegerv: (what, at) => {
      ints(at, 1)[0] = gl.getParameter(what);
    },
    GetProgramInfoLog: (program, size, length, at) => putLog(gl.getProgramInfoLog(objects[program]) ?? '', size, length, at),
    GetProgramiv: (program, what, at) =>
      query((w) => gl.getProgramParameter(objects[program], w), () => gl.getProgramInfoLog(objects[program]))(what, at),
    GetShaderInfoLog: (shader, size, length, at) => putLog(gl.getShaderInfoLog(objects[shader]) ?? '', size, length, at),
    GetShaderiv: (shader, what, at) =>
      query((w) => gl.getShaderParameter(objects[shader], w), () => gl.getShaderInfoLog(objects[shader]))(what, at),
    GetString: () => 0,
    GetUniformBlockIndex: (program, at) => gl.getUniformBlockIndex(objects[program], string(at)),
    GetUniformLocation: (program, at) => {
      const key = `${program} ${string(at)}`;
      if (!locations.has(key)) {
        const found = gl.getUniformLocation(objects[program], string(at));
        locations.set(key, found ? objects.push(found) - 1 : -1);
      }
      return locations.get(key);
    },
    LinkProgram: (program) => gl.linkProgram(objects[program]),
    ReadPixels: (x, y, width, height, format, type, at) => gl.readPixels(x, y, width, height, format, type, texels(type, at)),
    ShaderSource: (shader, count, texts, lengths) => {
      let source = '';
      for (let i = 0; i < count; ++i) source += string(ints(texts, count)[i], ints(lengths, count)[i]);
      gl.shaderSource(objects[shader], source);
    },
    TexImage2D: (target, level, internal, width, height, border, format, type, at) =>
      gl.texImage2D(target, level, internal, width, height, border, format, type, texels(type, at)),
    TexImage3D: (target, level, internal, width, height, depth, border, format, type, at) =>
      gl.texImage3D(target, level, internal, width, height, depth, border, format, type, texels(type, at)),
    TexSubImage2D: (target, level, x, y, width, height, format, type, at) =>
      gl.texSubImage2D(target, level, x, y, width, height, format, type, texels(type, at)),
    UniformBlockBinding: (program, block, point) => gl.uniformBlockBinding(objects[program], block, point),
    UseProgram: (program) => gl.useProgram(objects[program]),
    VertexAttribPointer: (index, size, type, normalised, stride, offset) =>
      gl.vertexAttribPointer(index, size, type, Boolean(normalised), stride, offset),
  };
  const kinds = {Texture: WebGLTexture, Buffer: WebGLBuffer, Framebuffer: WebGLFramebuffer, VertexArray: WebGLVertexArrayObject, Program: WebGLProgram};
  api.DeleteAll = () => {
    for (const [kind, type] of Object.entries(kinds))
      for (const object of objects) if (object instanceof type) gl[`delete${kind}`](object);
  };
  const location = (name) => (name < 0 ? null : objects[name]);
  for (const name of ['1f', '1i', '2i']) api[`Uniform${name}`] = (at, ...values) => gl[`uniform${name}`](location(at), ...values);
  for (const size of [2, 3, 4])
    api[`Uniform${size}fv`] = (at, count, from) => gl[`uniform${size}fv`](location(at), floats(from, size * count));
  for (const size of [3, 4])
    api[`UniformMatrix${size}fv`] = (at, count, transposed, from) =>
      gl[`uniformMatrix${size}fv`](location(at), Boolean(transposed), floats(from, size * size * count));
  // All others take numbers alone.
  return new Proxy(api, {
    get: (known, name) => known[name] ?? ((...numbers) => gl[name[0].toLowerCase() + name.slice(1)](...numbers)),
  });
}
