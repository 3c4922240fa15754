// Pictures one after the other as one animated PNG (PNG specification, third edition, 11.3.6), which browsers play and
// other viewers show the first picture of.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace pelt {

struct AnimationFrame {
  std::vector<std::byte> png;  // of 8 bits per channel, all of one size
  double seconds;              // that it is shown
};

// Plays without end. Throws Error where there is no frame, where one is no PNG, and where sizes differ.
std::vector<std::byte> AnimatePng(std::span<const AnimationFrame> frames);

}  // namespace pelt
