// Clips as such: where in its keys a track stands at a time, which poses (pose.hpp) and their velocities are sampled
// by; linear tracks made cubic; and whether a clip goes on where it ends.
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

// Linear tracks made cubic: fur feels each corner that a linear track has at its keys as a blow.
//
// Files hold motions sampled at 24 to 60 keys a second, and what moved between the keys was smooth. So a track whose
// keys are that dense goes through the same keys on cubics (glTF's CUBICSPLINE); the slope at a key is that of the
// parabola through it and its neighbours. Where a track holds still from key to key it still does, to the last bit.
//
// Left as they are: scales, steps, keys that are few (an animator's own, meant as they stand), and rotations of more
// than a quarter turn from key to key.
//
// Of all of the character's clips; its notes say how many tracks, and how far they lead off the lines.
void SmoothClips(Character& character);

// Whether a clip does not go on where it ends when it loops, as one that walks away from where it began: there the
// engine teleports the character, or its fur is torn along.
//
// That is, whether some of the mesh lies elsewhere at the clip's end than at its beginning, by more than a fiftieth of
// the rest pose's extent and four times what anything moves in a sixtieth of a second within the clip: a last key that
// was left out is no jump.
bool JumpsWhereItLoops(const Character& character, const Clip& clip);

}  // namespace pelt
