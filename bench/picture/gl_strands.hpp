// A frame's draw list on the graphics card: vertices as they are, and the roots that they do not know of. What is as it
// was in the picture before is not sent again.
#pragma once

#include <vector>

#include "bench/picture/gl_programs.hpp"
#include "bench/picture/picture_scene.hpp"

namespace pelt {

class GlStrands {
 public:
  explicit GlStrands(const GlApi& gl) : gl_(gl) {}

  // Whether anything is other than before.
  bool Take(const PictureScene& scene);
  size_t layers() const { return layers_.size(); }
  // By a program of the layer's output, in use from here on: strips of two corners at each knot, or lines.
  void DrawStrips(const std::vector<GlProgram>& programs, size_t layer) const;
  void DrawLines(const std::vector<GlProgram>& programs, size_t layer) const;

 private:
  struct Layer {
    GlKeptTexels vertices, roots, looks;
    size_t output = 0;  // its place in GlPrograms' lists
    GLsizei strands = 0, knots = 0;
    uint32_t actor = 0, first_strand = 0;
    float tip_width = 1.0f;
    bool is_lit = false;
    PaintLook paint = kDefaultPaint;

    bool Take(const LayerDraw& draw, const std::vector<Hair>& hairs);
  };
  void Bind(const std::vector<GlProgram>& programs, const Layer& layer) const;

  const GlApi& gl_;
  bool in_strand_order_ = false;
  std::vector<Layer> layers_;
};

}  // namespace pelt
