#include "core/groom/surface_colour.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt {

// IEC 61966-2-1.
double ExactLinear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : exact::Pow((srgb + 0.055) / 1.055, 2.4);
}
double ExactSrgb(double linear) {
  return linear <= 0.0031308 ? linear * 12.92 : 1.055 * exact::Pow(linear, 1.0 / 2.4) - 0.055;
}

SurfaceColour::SurfaceColour(const Character& character) : mesh_(character.mesh) {
  for (int byte = 0; byte <= 256; ++byte)
    linear_[byte] = float(ExactLinear(double(std::min(byte, 255)) / 255.0));
  for (size_t i = 0; i < character.images.size(); ++i) {
    const auto& bytes = character.images[i];
    ControlMap& image = images_.emplace_back();
    try {
      image = ReadControlMap({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()},
                             Format("image {} of {}", i, character.name));
    } catch (const Error& error) {
      faults_.push_back(Format("{}; taken as white.", error.what()));
    }
  }
}

const MaterialLook& SurfaceColour::LookOf(uint32_t triangle) const {
  static const MaterialLook kNone;
  const uint16_t material = mesh_.triangle_material[triangle];
  return material < mesh_.looks.size() ? mesh_.looks[material] : kNone;
}

bool SurfaceColour::Knows(uint32_t triangle) const {
  return LookOf(triangle).stated || !mesh_.corner_colour.empty();
}

bool SurfaceColour::IsUnlit(uint32_t triangle) const { return LookOf(triangle).unlit; }

bool SurfaceColour::HasImage(uint32_t triangle) const {
  return LookOf(triangle).image >= 0 && !mesh_.uv.empty();
}

glm::vec2 SurfaceColour::ImageUvAt(const SurfacePoint& point) const {
  return Interpolate(mesh_.uv, mesh_, point);
}

glm::vec3 SurfaceColour::At(const SurfacePoint& point) const {
  const MaterialLook& look = LookOf(point.triangle);
  glm::vec3 colour = look.base_colour;
  if (HasImage(point.triangle)) {
    const glm::vec2 uv = ImageUvAt(point);
    for (int c = 0; c < 3; ++c) {
      const float byte = images_[size_t(look.image)].Sample(uv, c, look.wrap) * 255.0f;
      const int low = int(byte);
      colour[c] *= linear_[low] + (linear_[low + 1] - linear_[low]) * (byte - float(low));
    }
  }
  return colour * glm::vec3(CornersAt(point));
}

std::optional<glm::vec3> SurfaceColour::SrgbAt(const SurfacePoint& point) const {
  if (!Knows(point.triangle)) return std::nullopt;
  glm::vec3 colour;
  if (const ControlMap* image = ImageOf(point.triangle)) {
    if (image->rgba.empty()) return std::nullopt;
    const glm::vec2 uv = ImageUvAt(point);
    for (int c = 0; c < 3; ++c) colour[c] = image->Sample(uv, c, WrapOn(mesh_, point.triangle));
  } else {
    const glm::vec3 linear = TintAt(point);
    for (int c = 0; c < 3; ++c) colour[c] = float(ExactSrgb(double(linear[c])));
  }
  return colour;
}

bool SurfaceColour::IsCut(uint32_t triangle) const {
  const MaterialLook& look = LookOf(triangle);
  return look.IsCut() && !look.IsTransparent();
}

glm::vec2 SurfaceColour::AlphaAndCutoffAt(const SurfacePoint& point) const {
  if (!IsCut(point.triangle)) return {1.0f, 0.0f};
  const MaterialLook& look = LookOf(point.triangle);
  return {look.alpha * CornersAt(point).a, look.alpha_cutoff};
}

bool SurfaceColour::IsHole(const SurfacePoint& point) const {
  if (!IsCut(point.triangle)) return false;
  const MaterialLook& look = LookOf(point.triangle);
  glm::vec2 alpha = AlphaAndCutoffAt(point);
  if (look.alpha_image >= 0 && !mesh_.uv.empty())
    alpha.x *= images_[size_t(look.alpha_image)].Sample(ImageUvAt(point), 3, look.wrap);
  return alpha.x < alpha.y;
}

const ControlMap* SurfaceColour::ImageOf(uint32_t triangle) const {
  return HasImage(triangle) ? &images_[size_t(LookOf(triangle).image)] : nullptr;
}

glm::vec3 SurfaceColour::TintAt(const SurfacePoint& point) const {
  return LookOf(point.triangle).base_colour * glm::vec3(CornersAt(point));
}

glm::vec4 SurfaceColour::CornersAt(const SurfacePoint& point) const {
  if (mesh_.corner_colour.empty()) return glm::vec4(1.0f);
  const auto& corner = mesh_.corner_colour[point.triangle];
  return corner[0] * point.bary.x + corner[1] * point.bary.y + corner[2] * point.bary.z;
}

}  // namespace pelt
