#include "core/character/smooth_clips.hpp"

#include <algorithm>
#include <cmath>

#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

constexpr float kQuarterTurn = 0.70710678f;  // the dot product of rotations that far apart
constexpr double kDegreesPerChord = 2.0 * 57.29577951308232;

// How far a track's cubics lead off the lines, at most.
struct Off {
  double degrees = 0.0, units = 0.0;
};

bool IsSampled(const Track& track) {
  const size_t keys = track.time_s.size();
  if (track.interpolation != Interpolation::kLinear || track.channel == Channel::kScale || keys < 3)
    return false;
  const double seconds = double(track.time_s.back()) - double(track.time_s.front());
  return double(keys - 1) > kSmoothedKeysPerSecond * seconds;
}

// Rotations on the short way from each key to the next; false where one turns further than is sampled.
bool Unroll(std::vector<glm::vec4>& keys) {
  for (size_t k = 1; k < keys.size(); ++k) {
    if (glm::dot(keys[k - 1], keys[k]) < 0.0f) keys[k] = -keys[k];
    if (glm::dot(keys[k - 1], keys[k]) < kQuarterTurn) return false;
  }
  return true;
}

// Of the parabola through three keys, at the middle one.
glm::dvec4 SlopeBetween(const glm::dvec4& before, const glm::dvec4& at, const glm::dvec4& after,
                        double from_before_s, double to_after_s) {
  const glm::dvec4 in = (at - before) / from_before_s, out = (after - at) / to_after_s;
  return (in * to_after_s + out * from_before_s) / (from_before_s + to_after_s);
}

// As files round: within a hundredth of the way from `a` to the key `next` to it.
bool IsNear(const glm::vec4& a, const glm::vec4& b, const glm::vec4& next) {
  const glm::dvec4 off = glm::dvec4(a) - glm::dvec4(b), step = glm::dvec4(a) - glm::dvec4(next);
  return glm::dot(off, off) <= 1e-4 * glm::dot(step, step);
}

// At each key. A track that ends where it began, a rotation perhaps the other way round, is taken for one that loops.
std::vector<glm::vec4> SlopesOf(const std::vector<glm::vec4>& keys,
                                const std::vector<float>& time_s) {
  const size_t last = keys.size() - 1;
  const auto span = [&](size_t k) { return double(time_s[k + 1]) - double(time_s[k]); };
  const auto slope = [&](const glm::vec4& before, size_t at, double from_before_s) {
    const glm::vec4& after = keys[at + 1];
    if (before == keys[at] || keys[at] == after) return glm::vec4(0.0f);  // it holds still
    return glm::vec4(SlopeBetween(before, keys[at], after, from_before_s, span(at)));
  };
  const auto end = [&](size_t at, size_t next, double seconds, const glm::vec4& slope_there) {
    if (keys[at] == keys[next]) return glm::vec4(0.0f);
    const glm::dvec4 chord = (glm::dvec4(keys[next]) - glm::dvec4(keys[at])) / seconds;
    return glm::vec4(chord * 1.5 - glm::dvec4(slope_there) * 0.5);  // not bent there
  };
  std::vector<glm::vec4> slopes(keys.size());
  for (size_t k = 1; k < last; ++k) slopes[k] = slope(keys[k - 1], k, span(k - 1));
  const bool same = IsNear(keys[0], keys[last], keys[1]);
  if (same || IsNear(keys[0], -keys[last], keys[1])) {
    slopes[0] = slope(same ? keys[last - 1] : -keys[last - 1], 0, span(last - 1));
    slopes[last] = same ? slopes[0] : -slopes[0];
  } else {
    slopes[0] = end(0, 1, span(0), slopes[1]);
    slopes[last] = end(last, last - 1, -span(last - 1), slopes[last - 1]);
  }
  return slopes;
}

// Halfway between keys, where a cubic is about furthest from the line.
void Measure(const std::vector<glm::vec4>& keys, const std::vector<glm::vec4>& slopes,
             const std::vector<float>& time_s, bool rotation, Off& off) {
  for (size_t k = 0; k + 1 < keys.size(); ++k) {
    const double eighth = (double(time_s[k + 1]) - double(time_s[k])) / 8.0;
    const glm::dvec4 by = (glm::dvec4(slopes[k]) - glm::dvec4(slopes[k + 1])) * eighth;
    const double far = std::sqrt(glm::dot(by, by));
    double& most = rotation ? off.degrees : off.units;
    most = std::max(most, rotation ? far * kDegreesPerChord : far);
  }
}

bool Smooth(Track& track, Off& off) {
  if (!IsSampled(track)) return false;
  std::vector<glm::vec4> keys = track.value;
  const bool rotation = track.channel == Channel::kRotation;
  if (rotation && !Unroll(keys)) return false;
  const std::vector<glm::vec4> slopes = SlopesOf(keys, track.time_s);
  Measure(keys, slopes, track.time_s, rotation, off);
  track.interpolation = Interpolation::kCubicSpline;
  track.value.clear();
  for (size_t k = 0; k < keys.size(); ++k)
    track.value.insert(track.value.end(), {slopes[k], keys[k], slopes[k]});
  return true;
}

}  // namespace

void SmoothClips(Character& character) {
  Off off;
  size_t tracks = 0, smoothed = 0;
  for (Clip& clip : character.clips)
    for (Track& track : clip.tracks) {
      ++tracks;
      smoothed += Smooth(track, off);
    }
  if (smoothed > 0)
    character.notes.push_back(
        Format("clips: {} of {} tracks have linear keys as dense as sampled motion and are smooth "
               "between them, up to {:.2g} degrees and {:.2g} units off the lines; "
               "clip_smoothing = false keeps the lines.",
               smoothed, tracks, off.degrees, off.units));
}

}  // namespace pelt
