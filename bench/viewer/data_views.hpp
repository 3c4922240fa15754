// What the page can show in the place of the fur: what single stages of the last frame have computed. In the order of
// the frame, so that they are also a way to explain it.
#pragma once

#include <span>
#include <string_view>

#include "bench/picture/picture_scene.hpp"

namespace pelt {

struct DataView {
  std::string_view name, text;
  // Changes what a frame's picture shows; null: the fur, as it is.
  void (*show)(const FurScene& scene, PictureScene& shown);
};

std::span<const DataView> DataViews();
// In which the views show a joint, 0xAABBGGRR.
uint32_t ColourOfJoint(uint32_t joint);
// By name, in the same order.
std::span<const std::string_view> DataViewNames();

}  // namespace pelt
