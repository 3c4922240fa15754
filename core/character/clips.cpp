#include "core/character/clips.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/character/pose.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

constexpr double kSmoothedKeysPerSecond = 10.0;  // more than these are sampled motion
constexpr float kQuarterTurn = 0.70710678f;      // the dot product of rotations that far apart
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

namespace {

constexpr size_t kVertices = 256;  // that are looked at
constexpr int kPlaces = 32;        // in the clip where its pace is measured
constexpr double kStep_s = 1.0 / 60.0, kSteps = 4.0, kShare = 0.02;

// The skeleton and some of the mesh.
Character TakeFew(const Character& from) {
  Character few;
  few.skeleton = from.skeleton;
  const size_t count = from.mesh.position.size();
  const size_t step = std::max<size_t>(1, count / kVertices);
  for (size_t v = 0; v < count; v += step) {
    few.mesh.position.push_back(from.mesh.position[v]);
    few.mesh.normal.push_back(from.mesh.normal[v]);
    few.mesh.tangent.push_back(from.mesh.tangent[v]);
    few.mesh.joints.push_back(from.mesh.joints[v]);
    few.mesh.weights.push_back(from.mesh.weights[v]);
  }
  return few;
}

JointPose JointOf(const PoseBlock& pose, size_t j) {
  JointPose out{glm::vec3(0.0f), glm::quat(0.0f, 0.0f, 0.0f, 0.0f), glm::vec3(0.0f)};
  glm::vec4 q(0.0f);
  for (size_t k = 0; k < 4; ++k) {
    for (int c = 0; c < 3; ++c) {
      out.translation[c] += pose.translation_key[k][size_t(c)][j] * pose.translation_weight[k][j];
      out.scale[c] += pose.scale_key[k][size_t(c)][j] * pose.scale_weight[k][j];
    }
    for (int c = 0; c < 4; ++c)
      q[c] += pose.rotation_key[k][size_t(c)][j] * pose.rotation_weight[k][j];
  }
  const float length = std::sqrt(glm::dot(q, q));
  if (length > 0.0f) q /= length;
  out.rotation = glm::quat(q.w, q.x, q.y, q.z);
  return out;
}

// `few` posed, in the file's units.
std::vector<glm::vec3> PlacesAt(Character& few, const Skeleton& skeleton, const Clip& clip,
                                double time_s) {
  const auto pose =
      std::make_unique<PoseBlock>(MakePose(skeleton, &clip, time_s, false, glm::mat4(1.0f)));
  for (size_t j = 0; j < few.skeleton.rest.size(); ++j) few.skeleton.rest[j] = JointOf(*pose, j);
  return ComputeRestGeometry(few, 1.0f).position;
}

double LargestStep(const std::vector<glm::vec3>& from, const std::vector<glm::vec3>& to) {
  double largest = 0.0;
  for (size_t v = 0; v < from.size(); ++v) {
    const glm::dvec3 d = glm::dvec3(to[v]) - glm::dvec3(from[v]);
    largest = std::max(largest, std::sqrt(glm::dot(d, d)));
  }
  return largest;
}

}  // namespace

bool JumpsWhereItLoops(const Character& character, const Clip& clip) {
  const double end_s = double(clip.duration_s);
  if (clip.tracks.empty() || !(end_s > 0.0)) return false;
  Character few = TakeFew(character);
  const Skeleton& skeleton = character.skeleton;
  const double extent = BoundPlaces(ComputeRestGeometry(few, 1.0f).position).LargestSide();
  const double jump =
      LargestStep(PlacesAt(few, skeleton, clip, end_s), PlacesAt(few, skeleton, clip, 0.0));
  if (!(jump > kShare * extent)) return false;
  double pace = 0.0;
  for (int i = 0; i < kPlaces && jump > kSteps * pace; ++i) {
    const double at_s = std::max(end_s - kStep_s, 0.0) * i / (kPlaces - 1);
    pace = std::max(pace, LargestStep(PlacesAt(few, skeleton, clip, at_s),
                                      PlacesAt(few, skeleton, clip, at_s + kStep_s)));
  }
  return jump > kSteps * pace;
}

}  // namespace pelt
