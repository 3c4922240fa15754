#include "bench/picture/gl_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "bench/view/gl_program.hpp"

namespace pelt {
namespace {

constexpr GLsizei kTexelsWide = 2048;  // strand.glsl knows it

GlTexture Plain(const GlApi& gl, GLenum target) {
  GlTexture texture(gl);
  gl.BindTexture(target, texture);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(target, filter, GL_NEAREST);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl.TexParameteri(target, wrap, GL_CLAMP_TO_EDGE);
  return texture;
}

// Of texels that are given later; what they are read from has to be said all the same.
struct Source {
  GLenum format, type;
};
Source SourceOf(GLenum format) {
  switch (format) {
    case GL_RGBA32UI:
      return {GL_RGBA_INTEGER, GL_UNSIGNED_INT};
    case GL_DEPTH_COMPONENT32F:
      return {GL_DEPTH_COMPONENT, GL_FLOAT};
    case GL_R32F:
      return {GL_RED, GL_FLOAT};
    case GL_R8:
      return {GL_RED, GL_UNSIGNED_BYTE};
    case GL_RGBA8:
      return {GL_RGBA, GL_UNSIGNED_BYTE};
    default:
      return {GL_RGBA, GL_FLOAT};
  }
}

}  // namespace

GlTexture MakeTexture(const GlApi& gl, GLenum format, GLsizei width, GLsizei height) {
  GlTexture texture = Plain(gl, GL_TEXTURE_2D);
  const Source source = SourceOf(format);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GLint(format), width, height, 0, source.format, source.type,
                nullptr);
  return texture;
}

GlTexture MakeTextureArray(const GlApi& gl, GLenum format, const glm::ivec2& size, GLsizei layers) {
  GlTexture texture = Plain(gl, GL_TEXTURE_2D_ARRAY);
  const Source source = SourceOf(format);
  gl.TexImage3D(GL_TEXTURE_2D_ARRAY, 0, GLint(format), size.x, size.y, layers, 0, source.format,
                source.type, nullptr);
  return texture;
}

GlTexture UploadTexels(const GlApi& gl, std::span<const std::byte> bytes) {
  const GLsizei texels = GLsizei(bytes.size() / 16), rows = texels / kTexelsWide;
  const GLsizei rest = texels % kTexelsWide;
  GlTexture texture = MakeTexture(gl, GL_RGBA32UI, kTexelsWide, std::max(rows + (rest > 0), 1));
  const auto fill = [&](GLsizei row, GLsizei width, GLsizei height) {
    if (width > 0 && height > 0)
      gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, row, width, height, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                       bytes.data() + size_t(row) * kTexelsWide * 16);
  };
  fill(0, kTexelsWide, rows);
  fill(rows, rest, 1);
  return texture;
}

GlTexture UploadImage(const GlApi& gl, GLenum format, const glm::ivec2& size, const void* texels) {
  GlTexture texture = Plain(gl, GL_TEXTURE_2D);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GLint(format), size.x, size.y, 0,
                format == GL_R8 ? GL_RED : GL_RGBA, GL_UNSIGNED_BYTE, texels);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl.TexParameteri(GL_TEXTURE_2D, wrap, GL_REPEAT);
  return texture;
}

GlTexture UploadSheets(const GlApi& gl, std::span<const ControlMap* const> sheets) {
  std::vector<uint8_t> texels(1, 255);
  const GLsizei width = sheets.empty() ? 1 : GLsizei(sheets[0]->width),
                height = sheets.empty() ? 1 : GLsizei(sheets[0]->height);
  if (!sheets.empty()) texels.clear();
  for (const ControlMap* sheet : sheets)
    for (size_t i = 0; i < sheet->rgba.size(); i += 4) texels.push_back(sheet->rgba[i]);
  GlTexture texture = Plain(gl, GL_TEXTURE_2D_ARRAY);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R8, width, height,
                GLsizei(std::max(sheets.size(), size_t(1))), 0, GL_RED, GL_UNSIGNED_BYTE,
                texels.data());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, wrap, GL_REPEAT);
  return texture;
}

void BindTexture(const GlApi& gl, GLint unit, GLenum target, GLuint texture) {
  gl.ActiveTexture(GL_TEXTURE0 + GLenum(unit));
  gl.BindTexture(target, texture);
}

GlMesh UploadMesh(const GlApi& gl, std::span<const std::byte> vertices,
                  std::span<const GLint> floats, GLuint divisor) {
  GlMesh mesh{GlVertexArray(gl), GlBuffer(gl)};
  const GLint stride = std::accumulate(floats.begin(), floats.end(), 0);
  gl.BindVertexArray(mesh.array);
  gl.BindBuffer(GL_ARRAY_BUFFER, mesh.vertices);
  gl.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertices.size()), vertices.data(), GL_STATIC_DRAW);
  size_t offset = 0;
  for (size_t i = 0; i < floats.size(); ++i) {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): OpenGL's way to say an offset.
    const void* from_start = reinterpret_cast<const void*>(offset);
    gl.VertexAttribPointer(GLuint(i), floats[i], GL_FLOAT, GL_FALSE, stride * GLint(sizeof(float)),
                           from_start);
    gl.VertexAttribDivisor(GLuint(i), divisor);
    gl.EnableVertexAttribArray(GLuint(i));
    offset += size_t(floats[i]) * sizeof(float);
  }
  gl.BindVertexArray(0);
  return mesh;
}

Result<GlProgram> GlProgram::Make(const GlApi& gl, const char* name, const std::string& vertex,
                                  const std::string& fragment) {
  const Result<GLuint> program = MakeProgram(gl, vertex, fragment);
  if (!program) return Failure{fmt::format("{}: {}", name, program.error())};
  return GlProgram(gl, *program);
}

}  // namespace pelt
