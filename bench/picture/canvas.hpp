// The software renderer's surface: colour and depth samples, triangles, hair segments.
//
// Within a layer hairs are painted in the order they come, over each other, as a GPU without depth
// writes would: a wrong sort shows. Between layers, and against the body, depth decides.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

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

class Canvas {
 public:
  Canvas(uint32_t width, uint32_t height);

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  // Of a square of samples.
  void SetBackground(uint32_t x, uint32_t y, uint32_t side, const glm::vec3& colour);

  struct Corner {
    glm::vec3 at;  // projected
    glm::vec3 colour;
  };
  void DrawTriangle(const Corner& a, const Corner& b, const Corner& c);

  void DrawPoint(uint32_t x, uint32_t y, float depth, const glm::vec3& colour);

  // A tapering segment of a hair, painted with coverage `alpha`. Widths in samples.
  struct Knot {
    glm::vec3 at;
    glm::vec3 colour;
    float width;
  };
  void DrawHair(const Knot& a, const Knot& b, float alpha);
  // Hairs drawn so far hide what lies behind them from now on.
  void FinishLayer();

  // Averages blocks of samples x samples into 8-bit sRGB, rows from the top.
  std::vector<uint8_t> Resolve(uint32_t samples) const;

 private:
  uint32_t width_, height_;
  std::vector<glm::vec3> colour_;
  std::vector<float> depth_, layer_depth_;
  uint32_t touched_from_, touched_to_ = 0;
};

// Linear light of sRGB bytes.
glm::vec3 LinearColour(uint32_t aabbggrr);

}  // namespace pelt
