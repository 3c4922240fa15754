// Poses and frame input, given to a scene frame by frame: for any input, BeginFrame refuses it or
// the frame runs, inside its blocks, to finite values.
//
//   record    kind (1 byte), payload
//   0         a word of the pose: index (2 bytes), bits (4 bytes)
//   1         all of the frame's input, as a recording has it
//   2         run a frame
//   3         the pose as it was bound
//   4         velocities of all colliders
#include <cstdlib>
#include <cstring>

#include "core/bind_pose.hpp"
#include "core/groom/groom_file.hpp"
#include "jobs/scene.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/jobs/non_finite.hpp"
#include "tests/source_folder.hpp"
#include "traces/input_fields.hpp"
#include "traces/input_log_format.hpp"

namespace pelt::fuzz {
namespace {

constexpr uint32_t kMostFrames = 8;

// An archive of ListInputFields that takes what is left, and then zeros.
struct Reader {
  std::span<const std::byte> left;

  template <class T>
  T Number() {
    std::byte bytes[sizeof(T)] = {};
    const size_t count = std::min(sizeof(T), left.size());
    std::memcpy(bytes, left.data(), count);
    left = left.subspan(count);
    return input_log::GetNumber<T>(bytes);
  }
  template <class T>
  void operator()(const char* field, T& value) {
    if constexpr (std::is_same_v<T, double>) {
      value = std::bit_cast<double>(Number<uint64_t>());
    } else if constexpr (std::is_same_v<T, float>) {
      value = std::bit_cast<float>(Number<uint32_t>());
    } else if constexpr (std::is_same_v<T, bool>) {
      value = Number<uint8_t>() & 1;
    } else if constexpr (std::is_array_v<T>) {
      for (auto& element : value) (*this)(field, element);
    } else {
      value = Number<uint32_t>();
    }
  }
};

// Of all that there may be, regardless of the counts.
void ReadVelocities(Reader& reader, FrameInput& input) {
  const uint32_t spheres = input.sphere_count, capsules = input.capsule_count;
  input.sphere_count = kSpheresPerScene;
  input.capsule_count = kCapsulesPerScene;
  ListColliderVelocities(
      [&reader](const char*, uint32_t, const char* field, auto& value) { reader(field, value); },
      input);
  input.sphere_count = spheres;
  input.capsule_count = capsules;
}

void RunFrame(FurScene& scene, const FrameInput& input) {
  if (scene.BeginFrame(input)) return;
  SerialExecutor().Run(scene.CurrentFrame());
  if (!testing::FindNonFinite(scene).empty()) std::abort();
}

}  // namespace

void ReadHostile(std::span<const std::byte> bytes) {
  static const Groom kGroom =
      ReadGroomFile(test::SourceFolder() + "/tests/fuzz/corpus/groom/strand_chains.groom")
          .OrThrow();
  static const Groom* const kGrooms[] = {&kGroom};
  const auto made = FurScene::Create(kGrooms).OrThrow();
  FurScene& scene = *made;
  FillBindPose(kGroom, scene.Pose(0));
  FrameInput input;
  Reader reader{bytes};
  for (uint32_t frames = 0; !reader.left.empty() && frames < kMostFrames;) {
    switch (reader.Number<uint8_t>() % 5) {
      case 0: {
        const size_t word = reader.Number<uint16_t>() % (sizeof(PoseBlock) / 4);
        const auto bits = reader.Number<uint32_t>();
        std::memcpy(reinterpret_cast<std::byte*>(&scene.Pose(0)) + 4 * word, &bits, 4);
        break;
      }
      case 1:
        input = {};
        ListInputFields(reader, input);
        for (auto& sphere : input.sphere) reader("sphere", sphere);
        for (CapsuleCollider& capsule : input.capsule) ListCapsuleFields(reader, capsule);
        for (SphereLight& light : input.lighting.light) ListLightFields(reader, light);
        for (IrradianceSample& sample : input.lighting.sample) ListIrradianceFields(reader, sample);
        for (PaintBrush& brush : input.brush) ListBrushFields(reader, brush);
        for (ForceVolume& force : input.force) ListForceFields(reader, force);
        break;
      case 2:
        RunFrame(scene, input);
        ++frames;
        break;
      case 4:
        ReadVelocities(reader, input);
        break;
      default:
        FillBindPose(kGroom, scene.Pose(0));
    }
  }
  RunFrame(scene, input);
}

}  // namespace pelt::fuzz
