// A picture put together step by step, from the bare skin to all of its light: what each term does is seen by what the
// next picture has and the one before has not.
#pragma once

#include <span>
#include <string_view>

#include "bench/picture/picture.hpp"

namespace pelt {

struct LightStep {
  std::string_view text;
  void (*leave_out)(PictureScene& scene);  // what this step does not have yet
};
std::span<const LightStep> LightSteps();

// The steps in reading order, three beside each other, each of the options' size. 8-bit sRGB, rows from the top.
inline constexpr uint32_t kStepsAcross = 3;
std::vector<uint8_t> DrawSteps(const PictureScene& scene, const PictureOptions& options,
                               PictureRenderer& renderer);

}  // namespace pelt
