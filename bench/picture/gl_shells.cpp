#include <algorithm>
#include <array>

#include "bench/picture/canvas.hpp"
#include "bench/picture/gl_parts.hpp"
#include "bench/picture/shadows.hpp"
#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

// The attributes of shell.vert, one behind the other.
struct ShellCorner {
  glm::vec3 position, groom, force, normal, base_colour, tip_colour;
  glm::vec4 place;  // on the texture, the stencil, and the sheet of one that is known per texel
};
constexpr std::array<GLint, 7> kCornerFloats = {3, 3, 3, 3, 3, 3, 4};
static_assert(sizeof(ShellCorner) == 22 * sizeof(float));

ShellCorner CornerOf(const LayerDraw& draw, const ShellGrowth& growth, uint32_t i) {
  const ShellVertex& vertex = draw.As<ShellVertex>()[i];
  const float(&uv)[2] = draw.shells.skin[i / kVerticesPerChunk].uv[i % kVerticesPerChunk];
  return {.position = VecOf(vertex.position),
          .groom = VecOf(vertex.groom),
          .force = VecOf(vertex.force),
          .normal = OctahedralNormal(vertex.normal),
          .base_colour = LinearColour(vertex.base_colour),
          .tip_colour = LinearColour(vertex.tip_colour),
          .place = {uv[0] * draw.shells.texture_repeat, uv[1] * draw.shells.texture_repeat,
                    float(vertex.base_colour >> 24) / 255.0f, float(growth.SheetOf(i))}};
}

std::vector<ShellCorner> CornersOf(const LayerDraw& draw, const ShellGrowth& growth) {
  std::vector<uint32_t> indices(WriteShellIndices(draw.shells, {}));
  WriteShellIndices(draw.shells, indices);
  std::vector<ShellCorner> corners;
  corners.reserve(indices.size());
  for (const uint32_t i : indices) corners.push_back(CornerOf(draw, growth, i));
  return corners;
}

// An instance of fin.vert: the attributes of its ends, and its fade behind them.
struct FinEnds {
  ShellCorner from, to;
  float fade;
};
// 16 attributes are what OpenGL 3.3 has.
constexpr std::array<GLint, 15> kFinFloats = {3, 3, 3, 3, 3, 3, 4, 3, 3, 3, 3, 3, 3, 4, 1};
static_assert(sizeof(FinEnds) == 45 * sizeof(float));

std::vector<FinEnds> FinsOf(const LayerDraw& draw, const ShellGrowth& growth) {
  std::vector<Fin> fins(WriteFins(draw.shells, {}));
  WriteFins(draw.shells, fins);
  std::vector<FinEnds> ends;
  ends.reserve(fins.size());
  const float last = draw.shells.shell.back().fade;
  for (const Fin& fin : fins)
    ends.push_back({CornerOf(draw, growth, fin.from), CornerOf(draw, growth, fin.to),
                    float(fin.fade) / 255.0f * last});
  return ends;
}

GlTexture UploadFur(const GlApi& gl, const FurTexture& fur) {
  GlTexture texture = MakeTexture(gl, GL_R8, 1, 1);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (fur.side)
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, GLsizei(fur.side), GLsizei(fur.side), 0, GL_RED,
                  GL_UNSIGNED_BYTE, fur.texels.data());
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl.TexParameteri(GL_TEXTURE_2D, wrap, GL_REPEAT);
  return texture;
}

std::vector<const ControlMap*> SheetsOf(const ShellGrowth& growth) {
  std::vector<const ControlMap*> sheets;
  if (growth.sheets)
    for (const ControlMap& sheet : growth.sheets->texels()) sheets.push_back(&sheet);
  return sheets;
}

GlTexture UploadCovers(const GlApi& gl, const std::vector<ShadowShell>& shells) {
  const GLsizei columns = GLsizei(std::tuple_size_v<decltype(ShadowShell::covers)>);
  GlTexture texture =
      MakeTexture(gl, GL_R32F, columns, GLsizei(std::max(shells.size(), size_t(1))));
  for (size_t row = 0; row < shells.size(); ++row)
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, GLint(row), columns, 1, GL_RED, GL_FLOAT,
                     shells[row].covers.data());
  return texture;
}

}  // namespace

GlShells::GlShells(const GlApi& gl, const PictureScene& scene) : gl_(gl), nothing_(gl) {
  gl_.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  for (size_t i = 0; i < scene.draws.size(); ++i)
    layers_.push_back(Upload(scene.draws[i], scene.textures[i], scene.growth[i]));
}

GlShells::Layer GlShells::Upload(const LayerDraw& draw, const FurTexture& texture,
                                 const ShellGrowth& growth) const {
  std::vector<ShellCorner> corners;
  std::vector<FinEnds> fins;
  if (!draw.shells.shell.empty()) {
    corners = CornersOf(draw, growth);
    fins = FinsOf(draw, growth);
  }
  const std::vector<ShadowShell> shadows = FindShadowShells(draw.shells.shell, texture);
  std::vector<float> heights;
  heights.reserve(shadows.size());
  for (const ShadowShell& shell : shadows) heights.push_back(shell.height);
  return {UploadMesh(gl_, std::as_bytes(std::span(corners)), kCornerFloats),
          GlBuffer(gl_),
          UploadFur(gl_, texture),
          GLsizei(corners.size()),
          UploadMesh(gl_, std::as_bytes(std::span(fins)), kFinFloats, 1),
          GLsizei(fins.size()),
          UploadCovers(gl_, shadows),
          std::move(heights),
          UploadSheets(gl_, SheetsOf(growth)),
          growth.sheets ? 1.0f / draw.shells.texture_repeat : 0.0f};
}

void GlShells::BindTextures(const GlProgram& program, const Layer& layer) const {
  BindTexture(gl_, kSurfaceUnit, GL_TEXTURE_2D, layer.texture);
  BindTexture(gl_, kGrowthUnit, GL_TEXTURE_2D_ARRAY, layer.growth);
  program.Set("growth_scale", layer.growth_scale);
}

void GlShells::Draw(const GlProgram& program, size_t layer, std::span<const Shell> shells,
                    bool one_by_one) const {
  constexpr GLuint kShellAttribute = 7;  // of shell.vert
  const Layer& drawn = layers_[layer];
  gl_.BindVertexArray(drawn.mesh.array);
  BindTextures(program, drawn);
  gl_.BindBuffer(GL_ARRAY_BUFFER, drawn.shells);
  gl_.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(shells.size_bytes()), shells.data(), GL_STREAM_DRAW);
  gl_.EnableVertexAttribArray(kShellAttribute);
  gl_.VertexAttribDivisor(kShellAttribute, 1);
  const size_t step = one_by_one ? 1 : shells.size();
  for (size_t first = 0; first < shells.size(); first += step) {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): OpenGL's way to say an offset.
    const void* from_start = reinterpret_cast<const void*>(first * sizeof(Shell));
    gl_.VertexAttribPointer(kShellAttribute, 4, GL_FLOAT, GL_FALSE, sizeof(Shell), from_start);
    gl_.DrawArraysInstanced(GL_TRIANGLES, 0, drawn.corners, GLsizei(step));
  }
  gl_.BindVertexArray(nothing_);
}

void GlShells::DrawFins(const GlProgram& program, size_t layer, const ShellDraw& shells) const {
  gl_.BindVertexArray(layers_[layer].fins.array);
  BindTextures(program, layers_[layer]);
  program.Set("fur_shadow", shells.shadow);
  program.Set("steps", float(kFinSteps));
  gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, GLsizei(2 * (kFinSteps + 1)),
                          layers_[layer].fin_count);
  gl_.BindVertexArray(nothing_);
}

void GlShells::DrawShadow(const GlProgram& program, size_t layer) const {
  const Layer& drawn = layers_[layer];
  gl_.BindVertexArray(drawn.mesh.array);
  BindTexture(gl_, kCoversUnit, GL_TEXTURE_2D, drawn.covers);
  for (size_t row = 0; row < drawn.heights.size(); ++row) {
    program.Set("row", int(row));
    program.Set("height", drawn.heights[row]);
    gl_.DrawArrays(GL_TRIANGLES, 0, drawn.corners);
  }
  gl_.BindVertexArray(nothing_);
}

}  // namespace pelt
