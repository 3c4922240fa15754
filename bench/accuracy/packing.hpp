// What is left of a float in 16 bits, as a float.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace pelt::accuracy {

// binary16, rounded to nearest, ties to even; what is too large for it becomes its largest number.
inline float RoundHalf(float a) {
  constexpr float kLargest = 65504.0f, kLeastNormal = 0x1p-14f;
  // Below, numbers lie 2^-24 apart, as floats do from 1/2 to 1.
  constexpr float kSameSpacing = 0.75f;
  if (std::abs(a) < kLeastNormal) {
    const volatile float moved = a + kSameSpacing;
    return moved - kSameSpacing;
  }
  uint32_t bits = std::bit_cast<uint32_t>(a);
  bits += 0xfffu + ((bits >> 13) & 1u);
  return std::clamp(std::bit_cast<float>(bits & ~0x1fffu), -kLargest, kLargest);
}

// 16 bits signed normalised: -1 to 1, as Pelt's tangents are.
inline float RoundSigned16(float a) {
  return std::nearbyint(std::clamp(a, -1.0f, 1.0f) * 32767.0f) / 32767.0f;
}

// 16 bits unsigned over the range from `low` to `high`.
inline double RoundWithin16(double a, double low, double high) {
  const double share = std::clamp((a - low) / (high - low), 0.0, 1.0);
  return low + std::nearbyint(share * 65535.0) / 65535.0 * (high - low);
}

}  // namespace pelt::accuracy
