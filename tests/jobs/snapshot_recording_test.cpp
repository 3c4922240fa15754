// A recording that begins with a snapshot, in traces/golden: made from the scene below on every
// instruction set, the same bytes each time. tests/porting/cross_test.sh replays it on other machines,
// big-endian ones among them.
//
// After a change of bits, or of what is state, that is meant, PELT_RENEW=1 in the environment writes it
// anew.
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/file_bytes.hpp"
#include "core/groom/groom_file.hpp"
#include "core/kernels/frame_table.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/source_folder.hpp"
#include "traces/input_log.hpp"

namespace pelt::testing {
namespace {

constexpr uint32_t kFirst = 30, kEnd = 36;
constexpr const char* kSetup =
    "[[layer]]\n"
    "name = 'coat'\n"
    "density = 3_000\n"
    "max_strands = 60\n"
    "mask = { materials = ['head'] }\n"
    "length = { value = 0.05, randomise = 0.3 }\n"
    "[[layer]]\n"
    "name = 'crest'\n"
    "chain = 'strand'\n"
    "solver = 'verlet'\n"
    "output = 'ribbons'\n"
    "density = 3_000\n"
    "max_strands = 40\n"
    "mask = { materials = ['head'] }\n"
    "length = 0.08\n"
    "clump = 0.4\n"
    "clump_controls = 16\n"
    "[[layer]]\n"
    "name = 'mane'\n"
    "chain = 'strand'\n"
    "points = 9\n"
    "density = 3_000\n"
    "max_strands = 30\n"
    "mask = { materials = ['head'] }\n"
    "length = 0.12\n"
    "lit = true\n"
    "painted = true\n";

std::string RecordingPath() {
  return test::SourceFolder() + "/traces/golden/from_frame_30.peltinput";
}

Scenario RecordedScenario() {
  Scenario scenario = TinyScenario();
  scenario.spheres.clear();
  scenario.actors[0].teleport_frame = -1;
  scenario.base.sphere_count = 0;
  scenario.base.wind.velocity[0] = 3.0f;
  scenario.base.wind.turbulence = 1.0f;
  for (const PaintBrush& brush : TinyBrushes())
    scenario.base.brush[scenario.base.brush_count++] = brush;
  scenario.grooms[0] = BakeForActor(scenario, ReadFurSetup(kSetup, "setup", "."));
  return scenario;
}

// The first frame that is recorded is a pause: what follows from the state has to be made there.
std::vector<std::byte> RecordOn(Isa isa) {
  Scenario scenario = RecordedScenario();
  RunningScenario running(scenario, OptionsFor(isa));
  FurScene& scene = running.scene();
  InputLogWriter writer;
  for (uint32_t f = 0; f < kEnd; ++f) {
    FrameInput input = running.Prepare(f, scenario.base.skip, scenario.base.lod);
    if (f == kFirst) {
      const std::vector<std::byte> groom = WriteGroom(scenario.grooms[0]).OrThrow();
      const std::span<const std::byte> grooms[] = {groom};
      std::vector<std::byte> snapshot(scene.SnapshotBytes());
      EXPECT_EQ(scene.Snapshot(snapshot), nullptr);
      EXPECT_EQ(writer.Begin({.scene = "from frame 30", .note = ""}, grooms, snapshot), nullptr);
      input.dt_s = 0.0;
    }
    RunInput(scene, input);
    if (f < kFirst) continue;
    EXPECT_EQ(writer.AddFrame(input, {&scene.Pose(0), 1}, scene.DigestFrame()), nullptr);
  }
  return writer.Finish();
}

TEST(SnapshotRecording, IsTheSameOnEveryInstructionSet) {
  if (kStrandsPerChunk != 128) GTEST_SKIP() << "it is kept for 128 strands per chunk";
  const std::vector<std::byte> made = RecordOn(BestIsa());
  if (std::getenv("PELT_RENEW")) WriteFileBytes("recording", RecordingPath(), made).OrThrow();
  EXPECT_TRUE(ReadFileBytes("recording", RecordingPath()).OrThrow() == made)
      << "other bits than recorded, or state is kept otherwise: if it is meant, PELT_RENEW=1";
  for (const Isa isa : kAllIsas)
    if (FindKernels(isa)) {
      EXPECT_TRUE(RecordOn(isa) == made) << IsaName(isa);
    }
}

TEST(SnapshotRecording, ReplaysOnEveryInstructionSet) {
  if (kStrandsPerChunk != 128) GTEST_SKIP() << "it is kept for 128 strands per chunk";
  const InputLog log = ReadInputLogFile(RecordingPath()).OrThrow();
  const Groom groom = ReadGroom(log.grooms[0], "recorded").OrThrow();
  const Groom* const grooms[] = {&groom};
  for (const Isa isa : kAllIsas) {
    if (!FindKernels(isa)) continue;
    const auto scene = FurScene::Create(grooms, OptionsFor(isa)).OrThrow();
    ASSERT_EQ(scene->Restore(log.snapshot), nullptr);
    for (uint32_t f = 0; f < log.FrameCount(); ++f) {
      log.FillPose(f, 0, &scene->Pose(0));
      PermutedExecutor permuted(f);
      RunInput(*scene, log.Input(f), permuted);
      EXPECT_EQ(scene->DigestFrame(), log.frames[f].digest) << IsaName(isa) << ", frame " << f;
    }
  }
}

}  // namespace
}  // namespace pelt::testing
