// Whether a time is within a target, and what the answers for several platforms come to.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>

namespace pelt {

// The later outweighs the earlier: what surely does not fit stays a no, whatever is unsure beside it.
enum class Fit : uint8_t { kFits, kUnsure, kDoesNotFit };

constexpr std::string_view FitName(Fit fit) {
  constexpr std::string_view kNames[] = {"FITS", "UNSURE", "DOES NOT FIT"};
  return kNames[size_t(fit)];
}

// `disturbed`: others used the machine, so the time is not that of the work alone.
constexpr Fit JudgeTime(double ms, double target_ms, bool disturbed) {
  if (disturbed) return Fit::kUnsure;
  return ms <= target_ms ? Fit::kFits : Fit::kDoesNotFit;
}

// Of one at least.
constexpr Fit JudgeAll(std::span<const Fit> fits) {
  return *std::max_element(fits.begin(), fits.end());
}

}  // namespace pelt
