// Clips: animations as tracks on skeleton nodes.
//
// Tracks that move nodes outside the skeleton move nothing we draw and are left out. Rotation keys
// of step and linear tracks are made unit, because the blend weights of slerp are right for unit
// quaternions only; cubic ones are left as they are, tangents and all.
// Source: glTF 2.0, 3.11 and appendix C.
#include <algorithm>
#include <cmath>

#include "core/character/gltf_accessor.hpp"
#include "core/character/gltf_read.hpp"
#include "core/float_rules.hpp"

namespace pelt::gltf {
namespace {

constexpr float kLargestValue = 1e15f;

class ClipReader {
 public:
  ClipReader(const Document& document, const SkeletonImport& skeleton,
             std::vector<std::string>* notes)
      : document_(document), skeleton_(skeleton), notes_(notes) {}

  std::vector<Clip> Read() {
    std::vector<Clip> clips;
    for (size_t a = 0; a < document_.animations.size(); ++a) clips.push_back(ReadClip(a));
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
      if (channel.sampler < 0 || size_t(channel.sampler) >= animation.samplers.size())
        Fail(document_, where, "sampler " + std::to_string(channel.sampler) + " does not exist");
      if (channel.node < 0 || size_t(channel.node) >= document_.nodes.size())
        Fail(document_, where, "node " + std::to_string(channel.node) + " does not exist");
      const int joint = skeleton_.joint_of_node[size_t(channel.node)];
      if (joint < 0 || channel.path == "weights") {
        ++elsewhere;
        continue;
      }
      Track track;
      track.joint = uint32_t(joint);
      track.channel = ChannelOf(channel.path, where);
      uint8_t& known = seen[3 * size_t(joint) + size_t(track.channel)];
      if (known) {
        ++repeated;
        continue;
      }
      known = 1;
      ReadTrack(animation.samplers[size_t(channel.sampler)],
                where + " sampler " + std::to_string(channel.sampler), &track);
      clip.duration_s = std::max(clip.duration_s, track.time_s.back());
      clip.tracks.push_back(std::move(track));
    }
    // Neighbouring joints are sampled one after the other.
    std::sort(clip.tracks.begin(), clip.tracks.end(), [](const Track& a, const Track& b) {
      return a.joint != b.joint ? a.joint < b.joint : a.channel < b.channel;
    });
    if (elsewhere)
      notes_->push_back(place + ": " + std::to_string(elsewhere) +
                        " channels move no joint; they were left out.");
    if (repeated)
      notes_->push_back(place + ": " + std::to_string(repeated) +
                        " channels repeat an earlier one's target; the first counts.");
    return clip;
  }

  Channel ChannelOf(const std::string& path, const std::string& where) const {
    if (path == "translation") return Channel::kTranslation;
    if (path == "rotation") return Channel::kRotation;
    if (path == "scale") return Channel::kScale;
    Fail(document_, where, "path '" + path + "' is not translation, rotation, scale or weights");
  }

  Interpolation InterpolationOf(const std::string& name, const std::string& where) const {
    if (name.empty() || name == "LINEAR") return Interpolation::kLinear;
    if (name == "STEP") return Interpolation::kStep;
    if (name == "CUBICSPLINE") return Interpolation::kCubicSpline;
    Fail(document_, where, "interpolation '" + name + "' is not STEP, LINEAR or CUBICSPLINE");
  }

  void ReadTrack(const Sampler& sampler, const std::string& where, Track* track) {
    track->interpolation = InterpolationOf(sampler.interpolation, where);
    ReadTimes(sampler.input, where + " input", track);
    const std::string place = where + " output";
    const bool rotation = track->channel == Channel::kRotation;
    const size_t n = rotation ? 4 : 3;
    const size_t per_key = track->interpolation == Interpolation::kCubicSpline ? 3 : 1;
    const size_t wanted = track->time_s.size() * per_key;
    const uint64_t has = CountElements(document_, sampler.output, place);
    if (has != wanted)
      Fail(document_, place,
           "has " + std::to_string(has) + " elements for " + std::to_string(track->time_s.size()) +
               " keys; " + std::to_string(wanted) + " are needed");
    const uint32_t allowed =
        rotation ? kSetF32 | kSetI8 | kSetU8 | kSetI16 | kSetU16 : uint32_t(kSetF32);
    const std::vector<float> v =
        ReadFloats(document_, sampler.output, {int(n), allowed, Scaling::kNormalised}, place);
    for (size_t i = 0; i < wanted; ++i) {
      glm::vec4 value(0.0f);
      for (size_t c = 0; c < n; ++c) value[int(c)] = v[n * i + c];
      for (int c = 0; c < 4; ++c)
        if (!(std::abs(value[c]) < kLargestValue))
          Fail(document_, place, "element " + std::to_string(i) + " is beyond 1e15");
      if (rotation && (per_key == 1 || i % 3 == 1))
        value = CheckRotation(value, per_key == 1, i, place);
      track->value.push_back(value);
    }
  }

  glm::vec4 CheckRotation(const glm::vec4& value, bool normalise, size_t element,
                          const std::string& place) const {
    const glm::dvec4 q(value);
    const double length = std::sqrt(glm::dot(q, q));
    if (!(length > 1e-6))
      Fail(document_, place, "element " + std::to_string(element) + " is a zero quaternion");
    return normalise ? glm::vec4(q / length) : value;
  }

  void ReadTimes(int accessor, const std::string& place, Track* track) {
    const uint64_t count = CountElements(document_, accessor, place);
    if (count == 0) Fail(document_, place, "has no keys");
    keys_ += count;
    if (keys_ > kMaxKeys)
      Fail(document_, place,
           "brings the file above " + std::to_string(kMaxKeys) + " animation keys");
    track->time_s = ReadFloats(document_, accessor, {1, kSetF32, Scaling::kAsFlagged}, place);
    for (size_t k = 0; k < track->time_s.size(); ++k) {
      const float t = track->time_s[k];
      if (t < 0.0f || t > 1e6f)
        Fail(document_, place,
             "key " + std::to_string(k) + ": time " + std::to_string(t) +
                 " s is not in 0 .. 1000000");
      if (k > 0 && !(t > track->time_s[k - 1]))
        Fail(document_, place,
             "key " + std::to_string(k) + ": time " + std::to_string(t) +
                 " s does not ascend from " + std::to_string(track->time_s[k - 1]));
    }
  }

  const Document& document_;
  const SkeletonImport& skeleton_;
  std::vector<std::string>* notes_;
  uint64_t keys_ = 0;
};

}  // namespace

std::vector<Clip> ReadClips(const Document& document, const SkeletonImport& skeleton,
                            std::vector<std::string>* notes) {
  return ClipReader(document, skeleton, notes).Read();
}

}  // namespace pelt::gltf
