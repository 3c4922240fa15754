#include "bench/picture/light_steps.hpp"

#include <algorithm>

namespace pelt {
namespace {

void LeaveOutRim(PictureScene& scene) {
  scene.ForEachLook([](PictureLook& look) {
    look.light.rim = glm::vec3(0.0f);
    look.hair.backlight = 0.0f;
  });
}

void LeaveOutHighlights(PictureScene& scene) {
  LeaveOutRim(scene);
  scene.ForEachLook([](PictureLook& look) { look.hair.primary = look.hair.secondary = 0.0f; });
}

void LeaveOutShadows(PictureScene& scene) {
  LeaveOutHighlights(scene);
  scene.ForEachLook([](PictureLook& look) {
    look.shadow.strength = 0.0f;
    look.depth_floor = 1.0f;
  });
}

void LeaveOutSun(PictureScene& scene) {
  LeaveOutShadows(scene);
  scene.ForEachLook([](PictureLook& look) { look.light.sun = glm::vec3(0.0f); });
}

void LeaveOutHair(PictureScene& scene) {
  LeaveOutSun(scene);
  scene.draws.clear();
  scene.layers.clear();
}

constexpr LightStep kSteps[] = {
    {"skin under the sky", LeaveOutHair},
    {"strands under the sky", LeaveOutSun},
    {"the sun, from everywhere", LeaveOutShadows},
    {"shadows: of the coat, of depth", LeaveOutHighlights},
    {"two highlights", LeaveOutRim},
    {"rim and light from behind", [](PictureScene&) {}},
};

}  // namespace

std::span<const LightStep> LightSteps() { return kSteps; }

std::vector<uint8_t> DrawSteps(const PictureScene& scene, const PictureOptions& options,
                               PictureRenderer& renderer) {
  const size_t row = size_t(options.width_px) * 3, sheet_row = row * kStepsAcross;
  const size_t down = (std::size(kSteps) + kStepsAcross - 1) / kStepsAcross;
  std::vector<uint8_t> sheet(sheet_row * options.height_px * down);
  for (size_t s = 0; s < std::size(kSteps); ++s) {
    PictureScene shown = scene;
    kSteps[s].leave_out(shown);
    const std::vector<uint8_t> rgb = renderer.Draw(shown, options);
    const size_t left = s % kStepsAcross * row, top = s / kStepsAcross * options.height_px;
    for (size_t y = 0; y < options.height_px; ++y)
      std::copy_n(rgb.begin() + ptrdiff_t(y * row), row,
                  sheet.begin() + ptrdiff_t((top + y) * sheet_row + left));
  }
  return sheet;
}

}  // namespace pelt
