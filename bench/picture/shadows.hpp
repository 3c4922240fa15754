// The sun's shadows: the map of one character, what shells add to it, and the maps of a whole scene.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "bench/picture/picture_scene.hpp"
#include "bench/shading/default_look.hpp"

namespace pelt {

// What the sun sees of one character: for each texel of a grid across the light, how far the nearest thing is, and
// how much covers the texel in all. A graphics card keeps the same by MIN blending on one channel and ADD on another.
//
// Invariant: texels are whole numbers, found by minimum and saturating sum, so what is drawn in another order gives the
// same bits.
class ShadowMap {
 public:
  static constexpr uint32_t kFull = 255;  // coverage of a texel that lets nothing through

  struct Texel {
    uint32_t nearest = ~0u;  // depth steps from the front
    uint32_t coverage = 0;   // of kFull, and at most that
    bool operator==(const Texel&) const = default;
  };

  // Covers a ball of `radius` metres round `centre`. `to_light` is unit.
  ShadowMap(const glm::vec3& to_light, const glm::vec3& centre, float radius, uint32_t side);

  // A piece of a hair of this full width, m: as wide as a texel, with less coverage where it is thinner; nothing where
  // that is below `least`.
  void AddHair(const glm::vec3& a, const glm::vec3& b, float width, float alpha,
               float least = 0.0f);
  // `covered`: share of a texel that it covers, at its corners; nothing is added where that is none.
  void AddTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                   const glm::vec3& covered = glm::vec3(1.0f));

  // Whether the light's rays through the place meet the map at all.
  bool Covers(const glm::vec3& world) const;
  // Share of light that reaches a place: SelfShadow of the texels round it, mixed.
  float Share(const glm::vec3& world, const ShadowLook& look = kDefaultShadow) const;
  // Softened coverage, 0 to 1, of the rays through a place behind everything.
  float Blocked(const glm::vec3& world) const;
  // For Blocked: after all has been added.
  void Soften(int texels);

  std::span<const Texel> texels() const { return texels_; }

 private:
  glm::vec3 Map(const glm::vec3& world) const;  // texels, and depth steps from the front
  void Add(int x, int y, float depth, uint32_t coverage);
  // The value at four texels round a place, mixed; `outside` beyond the grid.
  template <class Value>
  float Mix(const glm::vec3& at, float outside, Value value) const;

  glm::vec3 axis_x_, axis_y_, to_light_, centre_;
  float radius_, texels_per_m_, steps_per_m_;
  int side_;
  std::vector<Texel> texels_;
  std::vector<float> soft_;
};

// What a layer of shells keeps of the sun. A few of its shells stand for all of them: each covers what the hairs do
// that end between it and the next of these, so that a ray straight down the coat meets each hair once. The fur's
// texture is far finer than a shadow map: of its texels the share counts, not one of them.
inline constexpr size_t kShadowShells = 6;  // at most, of a layer

struct ShadowShell {
  float height;
  std::array<float, 256> covers;  // share of a place, by the stencil there in 8 bits
};

// From the skin up; the topmost shell is one of them.
std::vector<ShadowShell> FindShadowShells(std::span<const Shell> shells, const FurTexture& texture);

// Nothing of a layer of strands.
void AddShells(const LayerDraw& draw, const FurTexture& texture, ShadowMap& map);

// The sun's shadows of a whole scene: a map for each character, as one over all of them would be too coarse for hair.

// Texels of a side: a few millimetres each on a character a metre tall.
inline constexpr uint32_t kShadowTexels = 384;
inline constexpr int kSoftTexels = 6;  // of half shadow round what the ground is shaded by
inline constexpr float kLiftTexels = 1.5f;

class SceneShadows {
 public:
  explicit SceneShadows(const PictureScene& scene);

  // Share of the sun that reaches a place on a character: past itself and those whose shadows meet it.
  float OnActor(uint32_t actor, const glm::vec3& world) const;
  // How much of the sun is kept from a place on the ground, softly: 0 to 1.
  float OnGround(const glm::vec3& world) const;
  // A normal's length by which skin is lifted out of its own shadow, m.
  float Lift(uint32_t actor) const { return lift_[actor]; }

 private:
  ShadowLook look_;
  std::vector<ShadowMap> maps_;
  std::vector<float> lift_;
  // For each map, those whose rays may meet it, and itself.
  std::vector<std::vector<uint32_t>> near_;
};

}  // namespace pelt
