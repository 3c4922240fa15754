#include <fmt/format.h>

#include <vector>

#include "bench/shading/gl_context.hpp"

namespace pelt {
namespace {

constexpr std::string_view kAfter = "// After: ";

Result<GLuint> Compile(const GlApi& gl, GLenum kind, const std::string& text) {
  const std::string_view version = GlContext::ShaderVersion();
  const GLchar* parts[] = {version.data(), text.c_str()};
  const GLint lengths[] = {GLint(version.size()), GLint(text.size())};
  const GLuint shader = gl.CreateShader(kind);
  gl.ShaderSource(shader, 2, parts, lengths);
  gl.CompileShader(shader);
  GLint compiled = 0, length = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled) return shader;
  gl.GetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::vector<GLchar> log(size_t(length) + 1);
  gl.GetShaderInfoLog(shader, GLsizei(log.size()), nullptr, log.data());
  gl.DeleteShader(shader);
  return Failure{
      fmt::format("{} shader: {}", kind == GL_VERTEX_SHADER ? "vertex" : "fragment", log.data())};
}

}  // namespace

std::string_view OwnText(std::string_view file) {
  for (const ShaderFile& known : EmbeddedShaders())
    if (known.name == file) return known.text;
  return {};
}

std::string ShaderText(std::string_view file) {
  const std::string_view text = OwnText(file);
  std::string whole;
  if (!text.empty()) whole.append(OwnText("dialect.glsl")).append(OwnText("fur_vertex.glsl"));
  for (size_t at = text.find(kAfter); at != text.npos; at = text.find(kAfter, at)) {
    at += kAfter.size();
    whole += OwnText(text.substr(at, text.find('\n', at) - at));
  }
  return whole.append(text);
}

Result<GLuint> MakeProgram(const GlApi& gl, const std::string& vertex,
                           const std::string& fragment) {
  const Result<GLuint> first = Compile(gl, GL_VERTEX_SHADER, vertex);
  if (!first) return Failure{first.error()};
  const Result<GLuint> second = Compile(gl, GL_FRAGMENT_SHADER, fragment);
  if (!second) {
    gl.DeleteShader(*first);
    return Failure{second.error()};
  }
  const GLuint program = gl.CreateProgram();
  for (const GLuint shader : {*first, *second}) {
    gl.AttachShader(program, shader);
    gl.DeleteShader(shader);  // lives as long as the program
  }
  gl.LinkProgram(program);
  GLint linked = 0, length = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked) return program;
  gl.GetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
  std::vector<GLchar> log(size_t(length) + 1);
  gl.GetProgramInfoLog(program, GLsizei(log.size()), nullptr, log.data());
  gl.DeleteProgram(program);
  return Failure{fmt::format("linking: {}", log.data())};
}

}  // namespace pelt
