// The characters' bodies: posed by the frame's own matrices, coloured as the fur that grows on them, with eyeballs.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "bench/picture/canvas.hpp"
#include "bench/picture/growth_sheets.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "bench/shading/default_look.hpp"
#include "bench/shading/shading.hpp"
#include "core/groom/surface_colour.hpp"

namespace pelt {

// An eyeball. The built-in mesh only marks where it is, by triangles with a ragged edge: the ball is drawn over them.
struct Eye {
  glm::vec3 centre{0.0f}, forward{0.0f};  // world
  float radius = 0.0f;                    // m
};

class ReliefCoat;
class SkinFurFinder;

// A layer whose density is known per texel: hair seen from the side for each area of skin, where that is 1. A bald
// spot is as sharp as its map.
struct MappedFur {
  SharedGrowth growth;
  std::vector<float> rate;  // at each vertex
};
// At most so many of a body; what more there are count at the vertices.
inline constexpr size_t kMappedLayers = 4;

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
  std::vector<float> covered;  // by fur, 0 to 1
  std::vector<MappedFur> mapped;
  std::vector<float> unmapped;          // as MappedFur's rate, of all other layers; with any mapped
  std::vector<uint8_t> furry_material;  // those that fur grows on
  float mean_covered = 0.0f;            // where fur grows
  std::vector<Eye> eyes;
  std::shared_ptr<const ReliefCoat> relief;  // fur that is drawn on the skin; null: none
  TextureAxes axes;                          // with relief
};

// Light left at skin that is covered so far, and at the roots of the fur; `floor`: where nothing but fur is.
float DepthFloor(float covered, float floor = kDefaultDepthFloor);

// Whether any of the mapped layers can grow on it.
bool IsMapped(const Body& body, uint32_t triangle);
// How much of the skin fur covers, at any place: with mapped layers as their maps say, else between the vertices.
float CoveredAt(const Body& body, const SurfacePoint& point);

// `growth`: of the scene's layers by number, null where there is none; or empty. `skin`: the actor's; null: found for
// this body alone.
Body PoseBody(const Scenario& scenario, const FurScene& scene, uint32_t actor,
              std::shared_ptr<const SurfaceColour> surface,
              std::shared_ptr<const ReliefCoat> relief = nullptr,
              std::span<const SharedGrowth> growth = {}, const SkinFurFinder* skin = nullptr);

// A vertex of a UV seam counts all fur that grows round it, and only the skin of its own side: here that of all sides,
// so that no seam is darker than what lies beside it.
void JoinSeams(Body& body);
// How relief is followed and shown.
struct ReliefShow {
  ReliefMarch march{4.0f, 16.0f, 0.0f, glm::vec3(0.0f), glm::vec2(0.0f)};
  int frame = -1;            // of the jitter, by sample; below 0: none
  bool shows_steps = false;  // in false colours
};
// Steps that relief was followed for, at so many places.
struct ReliefCount {
  double steps = 0.0;
  uint64_t places = 0;
};

// Share of the sun's light that reaches a place with this normal.
using SunShare = std::function<float(const glm::vec3& position, const glm::vec3& normal)>;
// `relief_looks`: what its layers of relief are lit by.
void DrawBody(const Body& body, const PictureLook& look, std::span<const PictureLook> relief_looks,
              const ReliefShow& show, const SunShare& sun, const Projection& projection,
              Canvas& canvas, ReliefCount& count);

}  // namespace pelt
