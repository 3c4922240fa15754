#include "bench/picture/gl_shells.hpp"

#include <array>

#include "bench/picture/canvas.hpp"
#include "bench/view/strand_shading.hpp"

namespace pelt {
namespace {

// The attributes of shell.vert, one behind the other.
struct ShellCorner {
  glm::vec3 position, groom, force, normal, base_colour, tip_colour;
  glm::vec3 place;  // on the texture, and the stencil
};
constexpr std::array<GLint, 7> kCornerFloats = {3, 3, 3, 3, 3, 3, 3};
static_assert(sizeof(ShellCorner) == 21 * sizeof(float));

std::vector<ShellCorner> CornersOf(const LayerDraw& draw) {
  std::vector<uint32_t> indices(WriteShellIndices(draw.shells, {}));
  WriteShellIndices(draw.shells, indices);
  const std::span<const ShellVertex> vertices = draw.As<ShellVertex>();
  std::vector<ShellCorner> corners;
  corners.reserve(indices.size());
  for (const uint32_t i : indices) {
    const ShellVertex& vertex = vertices[i];
    const float(&uv)[2] = draw.shells.skin[i / kVerticesPerChunk].uv[i % kVerticesPerChunk];
    corners.push_back(
        {.position = VecOf(vertex.position),
         .groom = VecOf(vertex.groom),
         .force = VecOf(vertex.force),
         .normal = OctahedralNormal(vertex.normal),
         .base_colour = LinearColour(vertex.base_colour),
         .tip_colour = LinearColour(vertex.tip_colour),
         .place = {uv[0] * draw.shells.texture_repeat, uv[1] * draw.shells.texture_repeat,
                   float(vertex.base_colour >> 24) / 255.0f}});
  }
  return corners;
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

}  // namespace

GlShells::GlShells(const GlApi& gl, const PictureScene& scene) : gl_(gl), nothing_(gl) {
  gl_.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  for (size_t i = 0; i < scene.draws.size(); ++i)
    layers_.push_back(Upload(scene.draws[i], scene.textures[i]));
}

GlShells::Layer GlShells::Upload(const LayerDraw& draw, const FurTexture& texture) const {
  std::vector<ShellCorner> corners;
  if (!draw.shells.shell.empty()) corners = CornersOf(draw);
  return {UploadMesh(gl_, std::as_bytes(std::span(corners)), kCornerFloats),
          UploadFur(gl_, texture), GLsizei(corners.size())};
}

void GlShells::Draw(const GlProgram& program, size_t layer, std::span<const Shell> shells) const {
  gl_.BindVertexArray(layers_[layer].mesh.array);
  BindTexture(gl_, kSurfaceUnit, GL_TEXTURE_2D, layers_[layer].texture);
  for (const Shell& shell : shells) {
    program.Set("shell", glm::vec4(shell.height, shell.shadow, shell.threshold, shell.fade));
    gl_.DrawArrays(GL_TRIANGLES, 0, layers_[layer].corners);
  }
  gl_.BindVertexArray(nothing_);
}

}  // namespace pelt
