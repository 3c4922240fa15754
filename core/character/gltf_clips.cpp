// Clips: animations as tracks on skeleton nodes.
//
// What is broken in one channel or clip leaves out that channel or clip, with a note.
//
// Tracks that move nodes outside the skeleton move nothing we draw and are left out. Rotation keys
// of step and linear tracks are made unit, because the blend weights of slerp are right for unit
// quaternions only; cubic ones are left as they are, tangents and all.
// Source: glTF 2.0, 3.11 and appendix C.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/character/gltf_accessor.hpp"
#include "core/character/gltf_read.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt::gltf {
namespace {

constexpr float kLargestValue = 1e15f;
constexpr uint64_t kMostSpent = 1u << 26;  // keys of clips that are left out: a bound on time

class ClipReader {
 public:
  ClipReader(const Document& document, const SkeletonImport& skeleton,
             std::vector<std::string>* notes)
      : document_(document), skeleton_(skeleton), notes_(notes) {}

  std::vector<Clip> Read() {
    std::vector<Clip> clips;
    for (size_t a = 0; a < document_.animations.size(); ++a) {
      const uint64_t keys = keys_;
      fault_ = {};
      Clip clip = ReadClip(a);
      if (!fault_) {
        clips.push_back(std::move(clip));
        continue;
      }
      // The keys of those that are left out are no part of what is held, but took their time.
      spent_ += keys_ - keys;
      keys_ = keys;
      if (spent_ > kMostSpent) Fail(document_, "animations", "too many are faulty");
      notes_->push_back(fault_.text + "; the clip was left out.");
    }
    std::vector<std::string*> names;
    for (Clip& clip : clips) names.push_back(&clip.name);
    MakeNamesUnique("clip", names, notes_);
    return clips;
  }

 private:
  Clip ReadClip(size_t index) {
    const Animation& animation = document_.animations[index];
    const std::string place = Place("animation", index, animation.name);
    Clip clip;
    clip.name = animation.name.empty() ? "clip " + std::to_string(index) : animation.name;
    size_t elsewhere = 0, repeated = 0;
    std::vector<uint8_t> seen(3 * skeleton_.skeleton.name.size(), 0);
    for (size_t c = 0; c < animation.channels.size(); ++c) {
      const ChannelDesc& channel = animation.channels[c];
      const std::string where = place + " channel " + std::to_string(c);
      const bool exists = channel.node >= 0 && size_t(channel.node) < document_.nodes.size();
      const int joint = exists ? skeleton_.joint_of_node[size_t(channel.node)] : -1;
      const std::optional<Channel> moves = ChannelOf(channel.path);
      if (joint < 0 || !moves) {
        ++elsewhere;
        continue;
      }
      if (channel.sampler < 0 || size_t(channel.sampler) >= animation.samplers.size()) {
        fault_.Say(where, "sampler " + std::to_string(channel.sampler) + " does not exist");
        return clip;
      }
      Track track;
      track.joint = uint32_t(joint);
      track.channel = *moves;
      uint8_t& known = seen[3 * size_t(joint) + size_t(track.channel)];
      if (known) {
        ++repeated;
        continue;
      }
      known = 1;
      if (!ReadTrack(animation.samplers[size_t(channel.sampler)],
                     where + " sampler " + std::to_string(channel.sampler), &track))
        return clip;
      clip.duration_s = std::max(clip.duration_s, track.time_s.back());
      clip.tracks.push_back(std::move(track));
    }
    // Neighbouring joints are sampled one after the other.
    std::sort(clip.tracks.begin(), clip.tracks.end(), [](const Track& a, const Track& b) {
      return a.joint != b.joint ? a.joint < b.joint : a.channel < b.channel;
    });
    if (animation.name.empty())
      notes_->push_back(place + " has no name; it is now '" + clip.name + "'.");
    if (elsewhere)
      notes_->push_back(place + ": " + std::to_string(elsewhere) +
                        " channels move no joint; they were left out.");
    if (repeated)
      notes_->push_back(place + ": " + std::to_string(repeated) +
                        " channels repeat an earlier one's target; the first counts.");
    return clip;
  }

  // Of what a joint has; there are others.
  static std::optional<Channel> ChannelOf(const std::string& path) {
    if (path == "translation") return Channel::kTranslation;
    if (path == "rotation") return Channel::kRotation;
    if (path == "scale") return Channel::kScale;
    return std::nullopt;
  }

  static std::optional<Interpolation> InterpolationOf(const std::string& name) {
    if (name.empty() || name == "LINEAR") return Interpolation::kLinear;
    if (name == "STEP") return Interpolation::kStep;
    if (name == "CUBICSPLINE") return Interpolation::kCubicSpline;
    return std::nullopt;
  }

  bool ReadTrack(const Sampler& sampler, const std::string& where, Track* track) {
    const std::optional<Interpolation> interpolation = InterpolationOf(sampler.interpolation);
    if (!interpolation)
      return fault_.Say(where, "interpolation '" + sampler.interpolation +
                                   "' is not STEP, LINEAR or CUBICSPLINE");
    track->interpolation = *interpolation;
    return ReadTimes(sampler.input, where + " input", track) && ReadValues(sampler, where, track);
  }

  bool ReadValues(const Sampler& sampler, const std::string& where, Track* track) {
    const std::string place = where + " output";
    const bool rotation = track->channel == Channel::kRotation;
    const size_t n = rotation ? 4 : 3;
    const size_t per_key = track->interpolation == Interpolation::kCubicSpline ? 3 : 1;
    const size_t wanted = track->time_s.size() * per_key;
    const uint64_t has = CountElements(document_, sampler.output, place, fault_);
    if (fault_) return false;
    if (has != wanted)
      return fault_.Say(place, Format("has {} elements for {} keys; {} are needed", has,
                                      track->time_s.size(), wanted));
    // Of a rotation integers are normalised; of the others as they say.
    const std::vector<float> v = ReadFloats(
        document_, sampler.output,
        {int(n), kSetAny, rotation ? Scaling::kNormalised : Scaling::kAsFlagged}, place, fault_);
    if (fault_) return false;
    for (size_t i = 0; i < wanted; ++i) {
      glm::vec4 value(0.0f);
      for (size_t c = 0; c < n; ++c) value[int(c)] = v[n * i + c];
      for (int c = 0; c < 4; ++c)
        if (!(std::abs(value[c]) < kLargestValue))
          return fault_.Say(place, "element " + std::to_string(i) + " is beyond 1e15");
      if (rotation && (per_key == 1 || i % 3 == 1)) {
        const glm::dvec4 q(value);
        const double length = std::sqrt(glm::dot(q, q));
        if (!(length > 1e-6))
          return fault_.Say(place, "element " + std::to_string(i) + " is a zero quaternion");
        if (per_key == 1) value = glm::vec4(q / length);
      }
      track->value.push_back(value);
    }
    return true;
  }

  bool ReadTimes(int accessor, const std::string& place, Track* track) {
    const uint64_t count = CountElements(document_, accessor, place, fault_);
    if (fault_) return false;
    if (count == 0) return fault_.Say(place, "has no keys");
    keys_ += count;
    if (keys_ > LimitOf(document_))
      return fault_.Say(place,
                        Format("brings the file above {} animation keys", LimitOf(document_)));
    track->time_s =
        ReadFloats(document_, accessor, {1, kSetF32, Scaling::kAsFlagged}, place, fault_);
    for (size_t k = 0; k < track->time_s.size(); ++k) {
      const float t = track->time_s[k];
      if (t < 0.0f || t > 1e6f)
        return fault_.Say(place, Format("key {}: time {} s is not in 0 .. 1000000", k, t));
      if (k > 0 && !(t > track->time_s[k - 1]))
        return fault_.Say(
            place, Format("key {}: time {} s does not ascend from {}", k, t, track->time_s[k - 1]));
    }
    return !fault_;
  }

  const Document& document_;
  const SkeletonImport& skeleton_;
  std::vector<std::string>* notes_;
  Fault fault_;  // of the clip that is read
  uint64_t keys_ = 0, spent_ = 0;
};

}  // namespace

std::vector<Clip> ReadClips(const Document& document, const SkeletonImport& skeleton,
                            std::vector<std::string>* notes) {
  return ClipReader(document, skeleton, notes).Read();
}

}  // namespace pelt::gltf
