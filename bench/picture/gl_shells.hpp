// Layers of shells on the graphics card: the skin's triangles, drawn once for each shell.
#pragma once

#include <vector>

#include "bench/picture/gl_objects.hpp"
#include "bench/picture/picture_scene.hpp"

namespace pelt {

class GlShells {
 public:
  GlShells(const GlApi& gl, const PictureScene& scene);

  bool Has(size_t layer) const { return layers_[layer].corners > 0; }
  // By GlPrograms' shell, in use: from the skin up, over what is there.
  void Draw(const GlProgram& program, size_t layer, std::span<const Shell> shells) const;
  // By GlPrograms' shell_shadow, in use.
  void DrawShadow(const GlProgram& program, size_t layer) const;

  bool HasFins(size_t layer) const { return layers_[layer].fin_count > 0; }
  // By GlPrograms' fin, in use: over what is there.
  void DrawFins(const GlProgram& program, size_t layer, const ShellDraw& shells) const;

 private:
  struct Layer {
    GlMesh mesh;
    GlTexture texture;
    GLsizei corners;
    GlMesh fins;  // an instance each
    GLsizei fin_count;
    GlTexture covers;            // ShadowShell::covers, a row each
    std::vector<float> heights;  // and what they are of
    GlTexture growth;
    float growth_scale;  // passes/stencil.glsl has it
  };
  Layer Upload(const LayerDraw& draw, const FurTexture& texture, const ShellGrowth& growth) const;
  void BindTextures(const GlProgram& program, const Layer& layer) const;

  const GlApi& gl_;
  GlVertexArray nothing_;
  std::vector<Layer> layers_;
};

}  // namespace pelt
