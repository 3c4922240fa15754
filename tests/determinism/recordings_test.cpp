// Recordings of contact that once gave other bits on other vectors, in traces/golden: made from the
// scenes below on every instruction set, the same bytes each time. tests/porting/cross_test.sh replays
// them on other machines.
//
// After a change of bits that is meant, PELT_RENEW=1 in the environment writes them anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/file_bytes.hpp"
#include "core/groom/groom_file.hpp"
#include "core/kernels/frame_table.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/source_folder.hpp"
#include "traces/input_log.hpp"

namespace pelt::testing {
namespace {

struct Recording {
  const char* name;
  const char* setup;
  uint32_t frames;
  uint32_t sphere_count;
  float sphere[3][4];
  float velocity[3] = {};  // of all, m/s
};

const Recording kRecordings[] = {
    // Strands pressed on the skin, of which a ball is near some.
    {"friction",
     "[[layer]]\n"
     "name = 'fur'\n"
     "seed = 1\n"
     "chain = 'strand'\n"
     "points = 5\n"
     "density = 20_000\n"
     "max_strands = 120\n"
     "mask = { materials = ['body', 'head'] }\n"
     "length = 0.06\n"
     "width = 0.001\n"
     "elevation = 15.0\n"
     "friction = 0.6\n"
     "surface_hardness = 1.0\n"
     "wind_response = 2.0\n",
     6,
     1,
     {{0.0f, 0.7f, 0.3f, 0.2f}}},
    // Strands of all lengths, soft and heavy, with balls that move through them; the shortest swing
    // faster than substeps follow.
    {"short_strands",
     "[[layer]]\n"
     "name = 'fur'\n"
     "seed = 11\n"
     "chain = 'strand'\n"
     "points = 4\n"
     "density = 20_000\n"
     "max_strands = 120\n"
     "mask = { materials = ['body', 'head'] }\n"
     "length = { value = 0.02, randomise = 0.95 }\n"
     "width = 0.001\n"
     "elevation = 40.0\n"
     "weight = 4.0\n"
     "frequency = 1.0\n"
     "surface_hardness = 0.0\n",
     12,
     3,
     {{0.0f, 0.9f, 0.15f, 0.1f}, {0.1f, 0.6f, 0.05f, 0.1f}, {-0.1f, 0.7f, -0.15f, 0.1f}},
     {0.0f, 0.0f, -0.4f}},
};

std::vector<std::byte> Record(const Recording& recording, Isa isa) {
  Scenario scenario =
      LoadScenario(ScenarioRequest{.scene = "tiny", .setup_texts = {recording.setup}});
  scenario.actors[0].clip = -1;
  scenario.actors[0].teleport_frame = -1;
  RunningScenario running(scenario, OptionsFor(isa));
  InputLogWriter writer;
  const std::vector<std::byte> groom = WriteGroom(scenario.grooms[0]).OrThrow();
  const std::span<const std::byte> grooms[] = {groom};
  EXPECT_EQ(writer.Begin({recording.name, "tests/determinism/recordings_test.cpp"}, grooms),
            nullptr);
  for (uint32_t f = 0; f < recording.frames; ++f) {
    FrameInput in = running.Prepare(f, {}, {});
    in.use_ground = false;
    in.sphere_count = recording.sphere_count;
    for (uint32_t s = 0; s < in.sphere_count; ++s) {
      std::copy_n(recording.sphere[s], 4, in.sphere[s]);
      std::copy_n(recording.velocity, 3, in.sphere_velocity[s]);
      for (uint32_t k = 0; k < 3; ++k)
        in.sphere[s][k] += recording.velocity[k] * float(f) * float(in.dt_s);
    }
    RunInput(running.scene(), in);
    EXPECT_EQ(writer.AddFrame(in, {&running.scene().Pose(0), 1}, running.scene().DigestFrame()),
              nullptr);
  }
  return writer.Finish();
}

TEST(Recordings, AreTheSameFromEveryInstructionSet) {
  if (kStrandsPerChunk != 128) GTEST_SKIP() << "they are kept for 128 strands per chunk";
  for (const Recording& recording : kRecordings) {
    const std::string path =
        test::SourceFolder() + "/traces/golden/" + recording.name + ".peltinput";
    if (std::getenv("PELT_RENEW"))
      WriteFileBytes("recording", path, Record(recording, Isa::kReference)).OrThrow();
    const std::vector<std::byte> kept = ReadFileBytes("recording", path).OrThrow();
    for (const Isa isa : kAllIsas)
      if (FindKernels(isa)) {
        EXPECT_TRUE(Record(recording, isa) == kept)
            << recording.name << " on " << IsaName(isa) << " is not " << path;
      }
  }
}

}  // namespace
}  // namespace pelt::testing
