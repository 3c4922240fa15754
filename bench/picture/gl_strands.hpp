// A frame's draw list on the graphics card: vertices as they are, and the roots that they do not know of.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/picture/gl_objects.hpp"
#include "bench/picture/picture_scene.hpp"

namespace pelt {

// Film strips on the graphics card: strip_texture.hpp's levels, a layer of one texture for each strip.

class GlStrips {
 public:
  explicit GlStrips(const GlApi& gl) : gl_(&gl), texture_(gl) {}

  // At least so many strips, where passes look for them. Those that there are stay for the next picture.
  void Bind(uint32_t strips);

 private:
  const GlApi* gl_;
  GlTexture texture_;
  uint32_t strips_ = 0;
};

class GlStrands {
 public:
  GlStrands(const GlApi& gl, const PictureScene& scene);

  size_t layers() const { return layers_.size(); }
  // By a program of the layer's output, in use from here on: strips of two corners at each knot, or lines.
  void DrawStrips(const std::vector<GlProgram>& programs, size_t layer) const;
  void DrawLines(const std::vector<GlProgram>& programs, size_t layer) const;

 private:
  struct Layer {
    GlTexture vertices, roots, looks;
    size_t output = 0;  // its place in GlPrograms' lists
    GLsizei strands = 0, knots = 0;
    uint32_t actor = 0, first_strand = 0;
    float tip_width = 1.0f;
    bool is_lit = false;
    PaintLook paint = kDefaultPaint;
  };
  Layer Upload(const LayerDraw& draw, const std::vector<Hair>& hairs) const;
  void Bind(const std::vector<GlProgram>& programs, const Layer& layer) const;

  const GlApi& gl_;
  bool in_strand_order_;
  std::vector<Layer> layers_;
};

}  // namespace pelt
