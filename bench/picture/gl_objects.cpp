#include "bench/picture/gl_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "bench/view/gl_program.hpp"

namespace pelt {
namespace {

constexpr GLsizei kTexelsWide = 2048;  // strand.glsl knows it
constexpr size_t kTexelBytes = 16, kRowBytes = kTexelsWide * kTexelBytes;

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

bool GlKeptTexels::Take(std::span<const std::byte> bytes) {
  bytes = bytes.first(bytes.size() / kTexelBytes * kTexelBytes);
  if (rows_ > 0 && std::ranges::equal(bytes, bytes_)) return false;
  const std::vector<std::byte> before =
      std::exchange(bytes_, std::vector<std::byte>(bytes.begin(), bytes.end()));
  const size_t rows = std::max<size_t>((bytes.size() + kRowBytes - 1) / kRowBytes, 1);
  gl_->BindTexture(GL_TEXTURE_2D, texture_);
  if (rows > rows_) {
    texture_ = MakeTexture(*gl_, GL_RGBA32UI, kTexelsWide, GLsizei(rows));
    rows_ = rows;
    Send(0, rows);
    return true;
  }
  const auto row_of = [](std::span<const std::byte> all, size_t row) {
    return all.subspan(std::min(row * kRowBytes, all.size()))
        .first(std::min(kRowBytes, all.size() - std::min(row * kRowBytes, all.size())));
  };
  const auto is_sent = [&](size_t row) {
    return std::ranges::equal(row_of(bytes_, row), row_of(before, row));
  };
  for (size_t row = 0, first = 0; row < rows; first = row) {
    while (row < rows && !is_sent(row)) ++row;
    Send(first, row);
    while (row < rows && is_sent(row)) ++row;
  }
  return true;
}

// Of the texture that is bound.
void GlKeptTexels::Send(size_t first_row, size_t end_row) const {
  if (first_row == end_row) return;
  const size_t whole = std::min(end_row, bytes_.size() / kRowBytes);
  const auto send = [&](size_t row, size_t width, size_t height) {
    if (width > 0 && height > 0)
      gl_->TexSubImage2D(GL_TEXTURE_2D, 0, 0, GLint(row), GLsizei(width), GLsizei(height),
                         GL_RGBA_INTEGER, GL_UNSIGNED_INT, bytes_.data() + row * kRowBytes);
  };
  if (whole > first_row) send(first_row, kTexelsWide, whole - first_row);
  if (end_row > whole) send(whole, bytes_.size() % kRowBytes / kTexelBytes, 1);
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

void ReplaceVertices(const GlApi& gl, const GlMesh& mesh, std::span<const std::byte> vertices) {
  gl.BindBuffer(GL_ARRAY_BUFFER, mesh.vertices);
  gl.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertices.size()), vertices.data(), GL_STREAM_DRAW);
}

Result<GlProgram> GlProgram::Make(const GlApi& gl, const char* name, const std::string& vertex,
                                  const std::string& fragment) {
  const Result<GLuint> program = MakeProgram(gl, vertex, fragment);
  if (!program) return Failure{fmt::format("{}: {}", name, program.error())};
  return GlProgram(gl, *program);
}

}  // namespace pelt
