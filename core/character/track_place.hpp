// Where in its keys a track stands at a time: what poses and their velocities are sampled by.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/character/character.hpp"
#include "core/exact_math.hpp"

namespace pelt {

// Keys [low] and [high] (equal at the ends) and the place between them.
struct TrackPlace {
  size_t low, high;
  double share;  // [0, 1)
  double span_s;
};

inline TrackPlace FindPlace(const Track& track, double t) {
  const std::vector<float>& time = track.time_s;
  if (t <= time.front()) return {0, 0, 0.0, 0.0};
  if (t >= time.back()) return {time.size() - 1, time.size() - 1, 0.0, 0.0};
  const size_t high =
      size_t(std::upper_bound(time.begin(), time.end(), t,
                              [](double value, float key) { return value < double(key); }) -
             time.begin());
  const double span = double(time[high]) - double(time[high - 1]);
  return {high - 1, high, (t - double(time[high - 1])) / span, span};
}

// Between equal keys nothing may move, not even a last bit: a still joint lets its chunks sleep.
inline bool IsHeld(const Track& track, const TrackPlace& at) {
  const auto zero = [](const glm::vec4& v) { return v == glm::vec4(0.0f); };
  if (at.low == at.high || track.interpolation == Interpolation::kStep) return true;
  if (track.interpolation == Interpolation::kLinear)
    return track.value[at.low] == track.value[at.high];
  return track.value[3 * at.low + 1] == track.value[3 * at.high + 1] &&
         zero(track.value[3 * at.low + 2]) && zero(track.value[3 * at.high]);
}

// A time within the clip; one that is not finite counts as 0.
inline double WrapTime(const Clip& clip, double time_s, bool loop) {
  if (!std::isfinite(time_s)) return 0.0;
  const double duration = double(clip.duration_s);
  if (!loop || !(duration > 0.0)) return time_s;
  const double t = time_s - exact::Floor(time_s / duration) * duration;
  return t >= 0.0 && t < duration ? t : 0.0;
}

}  // namespace pelt
