// The characters' bodies: posed by the frame's own matrices, coloured as the fur that grows on them, with eyeballs.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "bench/picture/canvas.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "bench/view/default_look.hpp"
#include "bench/view/paint_shading.hpp"
#include "core/groom/surface_colour.hpp"

namespace pelt {

// An eyeball. The built-in mesh only marks where it is, by triangles with a ragged edge: the ball is drawn over them.
struct Eye {
  glm::vec3 centre{0.0f}, forward{0.0f};  // world
  float radius = 0.0f;                    // m
};

class ReliefCoat;

// Metres that the skin goes along for one unit of u and of v, at each vertex.
struct TextureAxes {
  std::vector<glm::vec3> u, v;
};

struct Body {
  const Character* character;
  std::vector<glm::vec3> position, normal;       // world
  std::shared_ptr<const SurfaceColour> surface;  // what the character's file says of its colour
  std::vector<glm::vec3> fur, fur_tip;           // colours at its roots and tips, linear
  std::vector<glm::vec4> paint;                  // SkinFur::paint
  PaintLook paint_look;
  std::vector<float> covered;           // by fur, 0 to 1
  std::vector<uint8_t> furry_material;  // those that fur grows on
  float mean_covered = 0.0f;            // where fur grows
  std::vector<Eye> eyes;
  std::shared_ptr<const ReliefCoat> relief;  // fur that is drawn on the skin; null: none
  TextureAxes axes;                          // with relief
};

// Light left at skin that is covered so far, and at the roots of the fur; `floor`: where nothing but fur is.
float DepthFloor(float covered, float floor = kDefaultDepthFloor);

Body PoseBody(const Scenario& scenario, const FurScene& scene, uint32_t actor,
              std::shared_ptr<const SurfaceColour> surface,
              std::shared_ptr<const ReliefCoat> relief = nullptr);

// Share of the sun's light that reaches a place with this normal.
using SunShare = std::function<float(const glm::vec3& position, const glm::vec3& normal)>;
void DrawBody(const Body& body, const PictureLook& look, const SunShare& sun,
              const Projection& projection, Canvas& canvas);

}  // namespace pelt
