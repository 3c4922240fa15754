#include "bench/picture/shells.hpp"

#include <cmath>

#include "bench/view/shell_shading.hpp"
#include "bench/view/strand_shading.hpp"

namespace pelt {
namespace {

class ShellPainter {
 public:
  ShellPainter(const PictureLook& look, const LayerDraw& draw, const FurTexture& texture,
               const SunShare& sun, const Projection& projection, Canvas& canvas)
      : look_(look),
        projection_(projection),
        canvas_(canvas),
        vertices_(draw.As<ShellVertex>()),
        texture_(texture) {
    indices_.resize(WriteShellIndices(draw.shells, {}));
    WriteShellIndices(draw.shells, indices_);
    // Of vertices that no triangle has nothing is known.
    corners_.resize(vertices_.size());
    for (const uint32_t i : indices_) {
      Corner& corner = corners_[i];
      if (corner.known) continue;
      const ShellVertex& vertex = vertices_[i];
      const ShellSkinBlock& skin = draw.shells.skin[i / kVerticesPerChunk];
      const float(&uv)[2] = skin.uv[i % kVerticesPerChunk];
      corner.known = true;
      corner.uv = glm::vec2(uv[0], uv[1]) * draw.shells.texture_repeat;
      corner.stencil = float(vertex.base_colour >> 24) / 255.0f;
      corner.normal = OctahedralNormal(vertex.normal);
      corner.sun = sun(VecOf(vertex.position), corner.normal);
    }
  }

  void Draw(const Shell& shell) {
    for (size_t i = 0; i < corners_.size(); ++i)
      if (corners_[i].known) Shade(shell, vertices_[i], corners_[i]);
    for (size_t t = 0; t < indices_.size(); t += 3)
      DrawTriangle(shell, corners_[indices_[t]], corners_[indices_[t + 1]],
                   corners_[indices_[t + 2]]);
  }

 private:
  struct Corner {
    bool known = false;
    glm::vec2 uv;
    float stencil, sun;
    glm::vec3 normal;
    glm::vec3 screen, colour;  // at the shell that is drawn
  };

  void Shade(const Shell& shell, const ShellVertex& vertex, Corner& corner) const {
    const glm::vec3 groom = VecOf(vertex.groom), force = VecOf(vertex.force);
    const glm::vec3 at = ShellPosition(VecOf(vertex.position), groom, force, shell.height);
    constexpr float kNoNoise = 0.5f;
    const HairPoint point{.colour = glm::mix(LinearColour(vertex.base_colour),
                                             LinearColour(vertex.tip_colour), shell.height),
                          .tangent = ShellDirection(groom, force, shell.height),
                          .normal = corner.normal,
                          .to_eye = glm::normalize(projection_.eye() - at),
                          .depth_light = shell.shadow,
                          .sun_share = corner.sun,
                          .noise = kNoNoise};
    corner.screen = projection_.Project(at);
    corner.colour = ShadeHair(look_.light, look_.hair, point);
  }

  void DrawTriangle(const Shell& shell, const Corner& a, const Corner& b, const Corner& c) const {
    canvas_.DrawCutTriangle(a.screen, b.screen, c.screen, [&](const glm::vec3& bary) {
      const glm::vec2 uv = a.uv * bary.x + b.uv * bary.y + c.uv * bary.z;
      const float stencil = a.stencil * bary.x + b.stencil * bary.y + c.stencil * bary.z;
      const float covered = ShellCoverage(HairAt(uv), stencil, shell.threshold);
      const glm::vec3 colour = a.colour * bary.x + b.colour * bary.y + c.colour * bary.z;
      return glm::vec4(colour, covered * shell.fade);
    });
  }

  float HairAt(const glm::vec2& uv) const {
    const glm::vec2 part = uv - glm::floor(uv);
    const auto texel = [&](float share) {
      return std::min(uint32_t(share * float(texture_.side)), texture_.side - 1);
    };
    return float(texture_.texels[size_t(texel(part.y)) * texture_.side + texel(part.x)]) / 255.0f;
  }

  const PictureLook& look_;
  const Projection& projection_;
  Canvas& canvas_;
  std::span<const ShellVertex> vertices_;
  const FurTexture& texture_;
  std::vector<uint32_t> indices_;
  std::vector<Corner> corners_;
};

}  // namespace

void DrawShells(const PictureScene& scene, size_t draw, const SunShare& sun,
                const Projection& projection, Canvas& canvas) {
  const LayerDraw& layer = scene.draws[draw];
  if (layer.shells.shell.empty()) return;
  ShellPainter painter(scene.layer_looks[draw], layer, scene.textures[draw], sun, projection,
                       canvas);
  for (const Shell& shell : layer.shells.shell) painter.Draw(shell);
}

}  // namespace pelt
