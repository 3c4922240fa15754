// Writes the input log; the layout is described in input_log.hpp.
//
// No exceptions: this is the half that runs inside an engine.
#include <algorithm>
#include <cstring>
#include <utility>

#include "core/file_bytes.hpp"
#include "core/format.hpp"
#include "traces/input_fields.hpp"
#include "traces/input_log.hpp"
#include "traces/input_log_format.hpp"

namespace pelt {

using namespace input_log;

namespace {

void PutText(std::vector<std::byte>& to, const std::string& text) {
  const auto size = uint32_t(std::min<size_t>(text.size(), kTextBytesLimit));
  PutNumber(to, size);
  for (const std::byte c : AsBytes(text).first(size)) to.push_back(c);
}

template <auto kRow>
void PutRows(const BlockOf<kRow>& block, uint32_t joint_count, std::vector<std::byte>& packed) {
  ForEachPoseRow<kRow>(joint_count, [&](size_t offset, uint32_t lanes) {
    for (uint32_t l = 0; l < lanes; ++l) {
      uint32_t word;
      std::memcpy(&word, reinterpret_cast<const std::byte*>(&block) + offset + 4 * l, 4);
      PutNumber(packed, word);
    }
  });
}

std::vector<std::byte> PackPose(const PoseBlock& pose) {
  std::vector<std::byte> packed;
  packed.reserve(8 + 4 * CountPoseWords(pose.joint_count));
  PutNumber(packed, pose.joint_count);
  PutNumber(packed, pose.teleported);
  PutRows<&Streams::pose>(pose, pose.joint_count, packed);
  return packed;
}

// Writes a part of a frame, or that it is the last frame's.
void PutPart(uint8_t unchanged, uint8_t follows, std::vector<std::byte> packed,
             std::vector<std::byte>& last, std::vector<std::byte>& to) {
  const bool same = packed == last;
  PutNumber(to, same ? unchanged : follows);
  if (same) return;
  to.insert(to.end(), packed.begin(), packed.end());
  last = std::move(packed);
}

void PutRates(const PoseRateBlock& rates, uint32_t joint_count, std::vector<std::byte>& last,
              std::vector<std::byte>& to) {
  if (!rates.given) {
    PutNumber(to, kNoRatesGiven);
    last.clear();
    return;
  }
  std::vector<std::byte> packed;
  PutRows<&Streams::pose_rates>(rates, joint_count, packed);
  PutPart(kRatesUnchanged, kRatesFollow, std::move(packed), last, to);
}

// Whether some bit of a collider's velocity is set.
bool HaveColliderVelocities(const FrameInput& input) {
  bool any = false;
  ListColliderVelocities(
      [&any](const char*, uint32_t, const char*, const float(&velocity)[3]) {
        for (const float v : velocity) any |= std::bit_cast<uint32_t>(v) != 0;
      },
      input);
  return any;
}

template <class T>
bool SameBits(std::span<const T> a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (b.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

}  // namespace

const char* InputLogWriter::Begin(const InputLogScene& about,
                                  std::span<const std::span<const std::byte>> character_grooms,
                                  std::span<const std::byte> snapshot) {
  if (character_grooms.empty() || character_grooms.size() > kCharactersLimit)
    return "no character, or more than a scene can have";
  if (!IsPrintable(about.scene) || !IsPrintable(about.note))
    return "the scene's name or the note holds a control character or is no UTF-8";
  std::vector<std::span<const std::byte>> grooms;
  std::vector<uint32_t> character_groom;
  for (const std::span<const std::byte> groom : character_grooms) {
    const auto same = std::find_if(grooms.begin(), grooms.end(), [&](const auto& known) {
      return std::equal(known.begin(), known.end(), groom.begin(), groom.end());
    });
    character_groom.push_back(uint32_t(same - grooms.begin()));
    if (same == grooms.end()) grooms.push_back(groom);
  }
  last_pose_.assign(character_grooms.size(), {});
  last_rates_.assign(character_grooms.size(), {});
  velocities_ = about.velocities;
  origins_ = about.origins;
  frame_count_ = collider_frames_ = list_frames_ = 0;
  collider_bytes_.clear();
  list_bytes_.clear();
  last_lists_ = {};
  bytes_.assign(AsBytes(kMagic).begin(), AsBytes(kMagic).end());
  // Without a snapshot it is what earlier programs read too.
  PutNumber(bytes_, kInputLogVersion);
  PutNumber(bytes_, kStrandsPerChunk);
  PutNumber(bytes_, (about.index_buffer ? kWithIndexBuffer : 0u) |
                        (about.velocities ? kWithVelocities : 0u) |
                        (about.origins ? kWithOrigins : 0u) |
                        (snapshot.empty() ? 0u : kWithSnapshot));
  PutNumber(bytes_, uint32_t(grooms.size()));
  PutNumber(bytes_, uint32_t(character_grooms.size()));
  bytes_.resize(kHeaderBytes);  // frames, file size and hash, once they are known
  PutText(bytes_, about.scene);
  PutText(bytes_, about.note);
  for (const uint32_t groom : character_groom) PutNumber(bytes_, groom);
  for (const std::span<const std::byte> groom : grooms) {
    PutNumber(bytes_, uint64_t(groom.size()));
    bytes_.insert(bytes_.end(), groom.begin(), groom.end());
  }
  if (snapshot.empty()) return nullptr;
  PutNumber(bytes_, uint64_t(snapshot.size()));
  bytes_.insert(bytes_.end(), snapshot.begin(), snapshot.end());
  return nullptr;
}

const char* InputLogWriter::AddFrame(const FrameInput& input, std::span<const PoseBlock> poses,
                                     uint64_t digest, std::span<const PoseRateBlock> rates,
                                     std::span<const double> origins) {
  const size_t characters = last_pose_.size();
  if (characters == 0) return "frames come after Begin";
  if (poses.size() != characters || (!input.weather.empty() && input.weather.size() != characters))
    return "not as many poses, or weathers, as characters";
  if (rates.size() != (velocities_ ? characters : 0))
    return velocities_ ? "not as many velocities as characters"
                       : "velocities in a recording that was begun without";
  if (origins.size() != (origins_ ? 3 * characters : 0))
    return origins_ ? "not three numbers of an origin for each character"
                    : "origins in a recording that was begun without";
  if (input.sphere_count > kSpheresPerScene) return "more spheres than a scene can have";
  if (input.capsule_count > kCapsulesPerScene) return "more capsules than a scene can have";
  if (input.lighting.light_count > kLightsPerScene ||
      input.lighting.sample_count > kIrradianceSamplesPerScene)
    return "more lights or irradiance samples than a scene can have";
  if (input.brush_count > kBrushesPerScene) return "more brushes than a scene can have";
  if (input.importance.size() > kLayersPerScene)
    return "importance of more layers than a scene has";
  if (input.force_count > kForceVolumesPerScene) return "more force volumes than a scene can have";
  for (const PoseBlock& pose : poses)
    if (pose.joint_count > kJointsPerCharacter)
      return "a pose of more joints than a character can have";
  Writer writer{bytes_};
  ListInputFields(writer, input);
  ListCountedFields([&writer](const char*, uint32_t, const char* field,
                              const auto& value) { writer(field, value); },
                    input);
  PutNumber(bytes_, uint32_t(input.weather.size()));
  for (const Weather& weather : input.weather) {
    writer("wetness", weather.wetness);
    writer("dirt", weather.dirt);
  }
  for (size_t c = 0; c < characters; ++c) {
    PutPart(kPoseUnchanged, kPoseFollows, PackPose(poses[c]), last_pose_[c], bytes_);
    if (velocities_) PutRates(rates[c], poses[c].joint_count, last_rates_[c], bytes_);
  }
  if (origins_) {
    writer("origin", input.origin);
    for (const double place : origins) writer("origin of a character", place);
  }
  PutNumber(bytes_, digest);
  if (HaveColliderVelocities(input)) {
    Writer collider_writer{collider_bytes_};
    PutNumber(collider_bytes_, frame_count_);
    ListColliderVelocities([&](const char*, uint32_t, const char* field,
                               const auto& value) { collider_writer(field, value); },
                           input);
    ++collider_frames_;
  }
  if (!SameBits(input.importance, last_lists_.importance) ||
      !SameBits(input.cut, last_lists_.cut) || !SameBits(input.strands, last_lists_.strands)) {
    Writer list_writer{list_bytes_};
    PutNumber(list_bytes_, frame_count_);
    ListLayerLists(
        [&](const char*, const auto& list) {
          PutNumber(list_bytes_, uint32_t(list.size()));
          for (const auto& element : list) ListElement(list_writer, element);
        },
        input);
    last_lists_.importance.assign(input.importance.begin(), input.importance.end());
    last_lists_.cut.assign(input.cut.begin(), input.cut.end());
    last_lists_.strands.assign(input.strands.begin(), input.strands.end());
    ++list_frames_;
  }
  ++frame_count_;
  return nullptr;
}

std::vector<std::byte> InputLogWriter::Finish() const {
  std::vector<std::byte> file = bytes_;
  if (file.empty()) return file;
  PutNumber(file, collider_frames_);
  file.insert(file.end(), collider_bytes_.begin(), collider_bytes_.end());
  if (list_frames_ > 0) {
    const auto options = GetNumber<uint32_t>(file.data() + kOptionsAt);
    PutNumberAt(file, kOptionsAt, options | kWithLists);
    PutNumber(file, list_frames_);
    file.insert(file.end(), list_bytes_.begin(), list_bytes_.end());
  }
  PutNumberAt(file, kFrameCountAt, frame_count_);
  PutNumberAt(file, kFileBytesAt, uint64_t(file.size()));
  PutNumberAt(file, kHashAt, HashOf(file));
  return file;
}

}  // namespace pelt
