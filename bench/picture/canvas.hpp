// The software renderer's surface: colour and depth samples, triangles, hair segments.
//
// Within a layer hairs are painted in the order they come, over each other, as a GPU without depth
// writes would: a wrong sort shows. Between layers, and against the body, depth decides.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "bench/picture/hair_samples.hpp"
#include "bench/picture/strip_texture.hpp"
#include "bench/picture/triangle_samples.hpp"
#include "core/view.hpp"

namespace pelt {

// World to samples: x and y in samples from the upper left, z the distance along the view, m.
class Projection {
 public:
  Projection(const Camera& camera, uint32_t width, uint32_t height);
  glm::vec3 Project(const glm::vec3& world) const;
  float SamplesPerMetre(float depth_m) const { return focal_ / depth_m; }
  glm::vec3 RayThrough(float x, float y) const;  // unit, world
  const glm::vec3& eye() const { return eye_; }

 private:
  glm::vec3 eye_, right_, up_, forward_;
  float focal_, centre_x_, centre_y_;
};

// A piece of a card of hairs.
struct CardPiece {
  const StripTexture* texture;
  uint32_t strip;
  float from, to;  // share of the card's length

  // What hairs cover of a sample at this share across and along the piece, where it is so many samples wide.
  float Cover(const glm::vec2& place, float width) const;
};

class Canvas {
 public:
  Canvas(uint32_t width, uint32_t height);

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  // Of a square of samples.
  void SetBackground(uint32_t x, uint32_t y, uint32_t side, const glm::vec3& colour);

  // Of projected corners; shade(shares of the corners) is the colour of a place.
  template <class Shade>
  void DrawTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, Shade shade);

  // Before the shells of a layer.
  void BeginShells();
  // The same of one that has holes: shade(shares, colour) says whether it covers the place, and with what; how much in w.
  // Where two are as far off, the lower `shell`, 1 or more, is seen: opaque ones may come in any order, and nearest first
  // most that is hidden is never shaded.
  template <class Shade>
  void DrawShellTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, uint8_t shell,
                         Shade shade);

  // The same, of what is thinner than its samples: what lies behind it is still drawn. shade(bary)
  // returns colour and coverage.
  template <class Shade>
  void DrawThinTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, Shade shade);

  void DrawPoint(uint32_t x, uint32_t y, float depth, const glm::vec3& colour);

  // A tapering piece of a hair, painted with coverage `alpha`; of a card, if there is one.
  void DrawHair(const HairEnd& a, const HairEnd& b, float alpha, const CardPiece* card = nullptr);
  // Hairs drawn so far hide what lies behind them from now on.
  void FinishLayer();

  // Averages blocks of samples x samples into 8-bit sRGB, rows from the top.
  std::vector<uint8_t> Resolve(uint32_t samples) const;

 private:
  size_t Place(uint32_t x, uint32_t y) const { return size_t(y) * width_ + x; }

  uint32_t width_, height_;
  std::vector<glm::vec3> colour_;
  std::vector<float> depth_, layer_depth_;
  std::vector<uint8_t> shell_;  // that was drawn there; 0: none of this layer
  uint32_t touched_from_, touched_to_ = 0;
};

template <class Shade>
void Canvas::DrawTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, Shade shade) {
  TriangleSamples(a, b, c, width_, height_)
      .ForEach(
          depth_, [&](uint32_t x, uint32_t y, float depth) { return depth < depth_[Place(x, y)]; },
          [&](uint32_t x, uint32_t y, float depth, const glm::vec3& nearness) {
            const size_t i = Place(x, y);
            depth_[i] = depth;
            colour_[i] = shade(nearness * depth);
          });
}

template <class Shade>
void Canvas::DrawShellTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                               uint8_t shell, Shade shade) {
  TriangleSamples(a, b, c, width_, height_)
      .ForEach(
          depth_,
          [&](uint32_t x, uint32_t y, float depth) {
            const size_t i = Place(x, y);
            return depth < depth_[i] || (depth == depth_[i] && shell_[i] > shell);
          },
          [&](uint32_t x, uint32_t y, float depth, const glm::vec3& nearness) {
            glm::vec4 colour;
            if (!shade(nearness * depth, colour)) return;
            const size_t i = Place(x, y);
            depth_[i] = depth;
            shell_[i] = shell;
            colour_[i] = colour.w == 1.0f ? glm::vec3(colour)
                                          : glm::mix(colour_[i], glm::vec3(colour), colour.w);
          });
}

template <class Shade>
void Canvas::DrawThinTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                              Shade shade) {
  TriangleSamples(a, b, c, width_, height_)
      .ForEach(
          depth_, [&](uint32_t x, uint32_t y, float depth) { return depth < depth_[Place(x, y)]; },
          [&](uint32_t x, uint32_t y, float depth, const glm::vec3& nearness) {
            const glm::vec4 colour = shade(nearness * depth);
            glm::vec3& under = colour_[Place(x, y)];
            under = glm::mix(under, glm::vec3(colour), colour.w);
          });
}

inline glm::vec3 VecOf(const float* v) { return {v[0], v[1], v[2]}; }

// Linear light of sRGB bytes.
glm::vec3 LinearColour(uint32_t aabbggrr);

}  // namespace pelt
