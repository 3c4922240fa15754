// The colour that a character's file gives its surface: material, image, colours at corners. Linear, and the same
// bits on any machine, so that fur may take it.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/groom/growth.hpp"

namespace pelt {

// sRGB to linear and back, 0 to 1, without libm.
double ExactLinear(double srgb);
double ExactSrgb(double linear);

class SurfaceColour {
 public:
  // Decodes the images that the mesh's materials use. Those that are no picture count as white.
  explicit SurfaceColour(const Character& character);

  // Whether the file says anything of the triangle's colour.
  bool Knows(uint32_t triangle) const;
  // Whether it is to be shown as it is, independent of the light that falls on it (KHR_materials_unlit).
  bool IsUnlit(uint32_t triangle) const;
  // Whether it differs within the triangle by an image.
  bool HasImage(uint32_t triangle) const;
  glm::vec3 At(const SurfacePoint& point) const;
  // What an artist picks from the image, or sees of a surface without one: sRGB, 0 to 1. Nothing where the file says none,
  // or its image cannot be read.
  std::optional<glm::vec3> SrgbAt(const SurfacePoint& point) const;
  // Whether alpha leaves nothing there. Nowhere where it leaves nothing at all: then the material is bare.
  bool IsHole(const SurfacePoint& point) const;
  // Whether the triangle may have any.
  bool IsCut(uint32_t triangle) const;
  // For those who sample images themselves: the triangle's, null if it has none; where on it the point is; and what it is
  // multiplied with.
  const ControlMap* ImageOf(uint32_t triangle) const;
  glm::vec2 ImageUvAt(const SurfacePoint& point) const;
  glm::vec3 TintAt(const SurfacePoint& point) const;
  // Alpha, to be multiplied with the image's, and below which there is a hole; 0: nowhere.
  glm::vec2 AlphaAndCutoffAt(const SurfacePoint& point) const;

  // What could not be decoded, one sentence each.
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  const MaterialLook& LookOf(uint32_t triangle) const;
  glm::vec4 CornersAt(const SurfacePoint& point) const;

  const Mesh& mesh_;
  std::vector<ControlMap> images_;
  std::vector<std::string> faults_;
  float linear_[257];  // of bytes; one more for the sum of rounding
};

}  // namespace pelt
