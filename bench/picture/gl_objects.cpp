#include "bench/picture/gl_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

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

namespace {

// Of GlPrograms::Other, in its order.
constexpr struct {
  const char *vertex, *fragment;
} kOthers[] = {{"body.vert", "body.frag"},     {"body_shadow.vert", "shadow.frag"},
               {"eye.vert", "eye.frag"},       {"lighting.vert", "lighting.frag"},
               {"whole.vert", "soften.frag"},  {"whole.vert", "resolve.frag"},
               {"shell.vert", "shell.frag"},   {"shell_shadow.vert", "shell_shadow.frag"},
               {"relief.vert", "relief.frag"}, {"fin.vert", "fin.frag"}};

std::string PassText(std::string_view file) { return ShaderText(fmt::format("passes/{}", file)); }

// Behind what its first lines name, and before the rest, comes the reader.
std::string StrandText(std::string_view file, std::string_view output) {
  const std::string whole = PassText(file);
  const std::string_view pass = OwnText(fmt::format("passes/{}", file));
  const size_t before = whole.size() - pass.size();
  return whole.substr(0, before) +
         std::string(OwnText(fmt::format("passes/readers/{}.glsl", output))) + whole.substr(before);
}

// Into `to`, unless the driver refuses: then what it says.
std::string Add(const GlApi& gl, std::vector<GlProgram>& to, const char* name,
                const std::string& vertex, const std::string& fragment) {
  Result<GlProgram> program = GlProgram::Make(gl, name, vertex, fragment);
  if (!program) return program.error();
  to.push_back(*std::move(program));
  return {};
}

constexpr size_t kStrandOutputs = size_t(
    std::ranges::count_if(kOutputs, [](const OutputEntry& entry) { return entry.OfStrands(); }));

}  // namespace

std::string GlPrograms::AddStrands(const GlApi& gl, std::string_view defines) {
  const struct {
    std::vector<GlProgram>& to;
    const char *vertex, *fragment;
  } kPasses[] = {{strand_light, "strand_light.vert", "strand.frag"},
                 {strand_buffered, "strand_buffered.vert", "strand_buffered.frag"},
                 {strand_depth, "strand_depth.vert", "strand_depth.frag"},
                 {strand_shadow, "strand_shadow.vert", "shadow.frag"}};
  const std::string before(defines);
  for (const OutputEntry& output : kOutputs) {
    if (!output.OfStrands()) continue;
    for (const auto& [to, vertex, fragment] : kPasses)
      if (std::string fault = Add(gl, to, vertex, before + StrandText(vertex, output.name),
                                  before + PassText(fragment));
          !fault.empty())
        return fault;
  }
  return {};
}

Result<GlPrograms> GlPrograms::Make(const GlApi& gl) {
  GlPrograms programs;
  std::string fault = programs.AddStrands(gl, "");
  for (const auto& other : kOthers)
    if (fault.empty())
      fault = Add(gl, programs.others, other.fragment, PassText(other.vertex),
                  PassText(other.fragment));
  if (!fault.empty()) return Failure{std::move(fault)};
  programs.SetUnits();
  return programs;
}

void GlPrograms::MakeCards(const GlApi& gl) {
  if (strand_light.size() > kStrandOutputs) return;
  if (const std::string fault = AddStrands(gl, "#define CARDS\n"); !fault.empty())
    throw Error("picture: the driver does not take the shaders of cards: " + fault);
  SetUnits();
}

void GlPrograms::SetUnits() const {
  ForEach([](const GlProgram& program) {
    program.Set("vertices", kVerticesUnit);
    program.Set("roots", kRootsUnit);
    program.Set("looks", kLooksUnit);
    program.Set("shadow_maps", kShadowMapsUnit);
    program.Set("characters", kCharactersUnit);
    program.Set("soft_maps", kSoftMapsUnit);
    program.Set("lighting", kLightingUnit);
    program.Set("surface", kSurfaceUnit);
    program.Set("source", kSourceUnit);
    program.Set("drawn", kSourceUnit);
    program.Set("relief_heights", kHeightsUnit);
    program.Set("strips", kStripsUnit);
    program.Set("covers", kCoversUnit);
    program.Set("growth", kGrowthUnit);
    program.BindBlock("Look", 0);
  });
}

void SetPaint(const GlProgram& program, const PaintLook& paint) {
  program.Set("paint_wet_darken", paint.wet_darken);
  program.Set("paint_mud", paint.mud);
  program.Set("paint_snow", paint.snow);
  program.Set("paint_dust", paint.dust);
}

void Soften(const GlApi& gl, const GlProgram& program, GlLayer from, GlLayer to,
            const glm::ivec2& size, int reach, int turns, float scale) {
  gl.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  const GlTexture there = MakeTextureArray(gl, GL_RGBA16F, size, 1),
                  back = MakeTextureArray(gl, GL_RGBA16F, size, 1);
  gl.Viewport(0, 0, size.x, size.y);
  program.Use();
  program.Set("reach", reach);
  const auto turn = [&](GlLayer source, GlLayer target, const glm::ivec2& along) {
    BindTexture(gl, kSourceUnit, GL_TEXTURE_2D_ARRAY, source.texture);
    gl.FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, target.texture, 0,
                               target.layer);
    program.Set("layer", source.layer);
    program.Set("along", along);
    program.Set("scale", scale);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    scale = 1.0f;
  };
  for (int i = 0; i < turns; ++i) {
    turn(i == 0 ? from : GlLayer{back, 0}, {there, 0}, {1, 0});
    turn({there, 0}, i + 1 == turns ? to : GlLayer{back, 0}, {0, 1});
  }
}

}  // namespace pelt
