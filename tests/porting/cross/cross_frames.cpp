// Frames that must give the same bits on every processor. Prints what must agree between machines
// as lines "same ...", and what this machine is as lines "here ...". Returns non-zero when its own
// executors and kernels disagree with each other.
//
//   cross_frames GROOM FRAMES
#include <bit>
#include <string>

#include "core/bind_pose.hpp"
#include "core/float_environment.hpp"
#include "core/groom/groom_file.hpp"
#include "core/kernels/frame_table.hpp"
#include "jobs/scene.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/porting/cross/program.hpp"
#include "traces/digest.hpp"

namespace {

// Binary fractions only, so that no compiler can read them differently.
pelt::FrameInput InputOf(uint32_t frame) {
  pelt::FrameInput input;
  input.dt_s = 1.0 / 64.0;
  input.time_s = frame / 64.0;
  input.wind.velocity[0] = 1.5f;
  input.wind.turbulence = 0.75f;
  input.wind.gust_strength = 0.5f;
  input.sphere_count = 1;
  input.sphere[0][0] = 0.25f;
  input.sphere[0][1] = 0.5f + float(frame) / 32.0f;
  input.sphere[0][3] = 0.25f;
  input.skip.lod = frame >= 4;
  return input;
}

// The character walks and nods.
void MoveOn(uint32_t frame, const pelt::Groom& groom, pelt::PoseBlock& pose) {
  pelt::FillBindPose(groom, pose);
  pose.root[3] = float(frame) / 64.0f;
  const uint32_t last = groom.joint_count - 1;
  pose.translation_key[0][1][last] += float(frame % 4) / 128.0f;
}

// Vectors keep denormals while a kernel runs, regardless of the mode that the thread had before.
bool KeepsDenormals() {
  typedef float Four __attribute__((vector_size(16)));
  volatile float a = 0x1p-100f, b = 0x1p-40f;
  const Four x = {a, a, a, a}, y = {b, b, b, b};
  const pelt::FloatEnvironment float_environment;
  volatile Four product = x * y;
  return product[0] == 0x1p-140f;
}

struct Course {
  uint64_t digest = 0;
  uint32_t drawn = 0;
};

Course RunCourse(const pelt::Groom& groom, const pelt::SceneOptions& options, uint32_t frames,
                 pelt::Executor& executor) {
  const pelt::Groom* grooms[] = {&groom};
  const auto made = OrExit(pelt::FurScene::Create(grooms, options));
  pelt::FurScene& scene = *made;
  pelt::Digest fold;
  for (uint32_t f = 0; f < frames; ++f) {
    MoveOn(f, groom, scene.Pose(0));
    if (const char* fault = scene.BeginFrame(InputOf(f))) {
      std::fprintf(stderr, "frame %u: %s\n", f, fault);
      std::exit(1);
    }
    executor.Run(scene.CurrentFrame());
    fold.Add64(scene.DigestFrame());
  }
  return {fold.Value(), scene.DrawnStrands()};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const uint32_t frames = uint32_t(std::atoi(argv[2]));
  const std::vector<std::byte> bytes = ReadBytes(argv[1]);
  const pelt::Groom groom = OrExit(pelt::ReadGroom(bytes, argv[1]));
  const bool round_trip = OrExit(pelt::WriteGroom(groom)) == bytes;
  std::printf("here %s-endian, %zu-bit\n",
              std::endian::native == std::endian::big ? "big" : "little", 8 * sizeof(void*));
  std::printf("same groom %016llx, read and written again: %s\n",
              static_cast<unsigned long long>(pelt::HashGroomBytes(bytes)),
              round_trip ? "the same bytes" : "OTHER BYTES");

  const bool keeps_denormals = KeepsDenormals();
  std::printf("same denormals: %s\n", keeps_denormals ? "kept" : "LOST");

  int failures = !round_trip + !keeps_denormals;
  uint64_t expected = 0;
  for (const pelt::Isa isa : pelt::kAllIsas) {
    if (!pelt::FindKernels(isa)) continue;
    pelt::SceneOptions options;
    options.isa = isa;
    options.plan.must_fit = true;
    pelt::SerialExecutor serial;
    pelt::PermutedExecutor permuted(1);
    pelt::LocalStoreExecutor local_store(options.plan.local_store_data_bytes);
    const std::pair<const char*, pelt::Executor*> executors[] = {
        {"serial", &serial}, {"permuted", &permuted}, {"local store", &local_store}};
    for (const auto& [name, executor] : executors) {
      const Course course = RunCourse(groom, options, frames, *executor);
      if (expected == 0) {
        expected = course.digest;
        std::printf("same digest of %u frames %016llx, %u strands drawn in the last\n", frames,
                    static_cast<unsigned long long>(expected), course.drawn);
      }
      const bool same = course.digest == expected;
      failures += !same;
      std::printf("here %s, %s: %s\n", std::string(pelt::IsaName(isa)).c_str(), name,
                  same ? "the same digest" : "ANOTHER DIGEST");
    }
    for (const pelt::LocalStoreFault& fault : local_store.faults()) {
      std::fprintf(stderr, "local store: %s\n", fault.what.c_str());
      ++failures;
    }
  }
  return failures != 0;
}
