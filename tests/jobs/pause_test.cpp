// A frame of no time: nothing moves, nothing is forgotten, and the view is still followed.
#include <gtest/gtest.h>

#include <cmath>

#include "platform_sim/local_store.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

const FrameInput PausedInput(Scenario& scenario, uint32_t frame, FurScene& scene) {
  FrameInput input = scenario.PrepareFrame(frame, scene);
  input.dt_s = 0.0;
  return input;
}

// After every frame of a course, one to three pauses in which everything else changes: the frames
// themselves have the bits of the course without, so state, sleep and comparisons were kept.
void ExpectPausesChangeNothing(Scenario scenario, uint32_t frames, const SkipSettings& skip,
                               const LodSettings& lod, Executor& executor,
                               const SceneOptions& options) {
  Scenario plain = scenario;
  SerialExecutor serial;
  const std::vector<uint64_t> truth = RunDigests(plain, options, serial, frames, skip, lod);
  RunningScenario running(scenario, options);
  FurScene& scene = running.scene();
  const Weather soaked[] = {{1.0f, 1.0f}};
  for (uint32_t f = 0; f < frames; ++f) {
    running.Begin(f, skip, lod);
    executor.Run(scene.CurrentFrame());
    ASSERT_EQ(scene.DigestFrame(), truth[f]) << "frame " << f;
    for (uint32_t p = 0; p <= f % 3; ++p) {
      FrameInput input = PausedInput(scenario, f + 7, scene);
      input.skip = skip;
      input.lod = lod;
      input.lod.strand_budget /= 2;
      input.weather = soaked;
      input.wind.velocity[0] = 20.0f;
      input.gravity[1] = 3.0f;
      scene.Pose(0).root[3] += 100.0f;
      scene.Pose(0).translation_key[0][0][1] = std::nanf("");
      input.camera = scenario.PrepareFrame(f, scene).camera;
      RunInput(scene, input, executor);
      EXPECT_TRUE(scene.RefusedPoses().empty());
      ASSERT_EQ(scene.DigestFrame(), truth[f]) << "pause " << p << " after frame " << f;
    }
  }
}

TEST(Pause, KeepsEverything) {
  SerialExecutor serial;
  LodSettings lod;
  ExpectPausesChangeNothing(TinyScenario(), 30, {}, lod, serial, OptionsFor(BestIsa()));
  lod.strand_budget = 300;
  ExpectPausesChangeNothing(TinyScenario(), 12, {.lod = true}, lod, serial, OptionsFor(BestIsa()));
  ExpectPausesChangeNothing(TinyScenario(), 8, kNoSkips, {}, serial, OptionsFor(BestIsa()));
}

TEST(Pause, IsTheSameOnOtherExecutorsAndOrders) {
  PermutedExecutor permuted(2);
  ExpectPausesChangeNothing(TinyScenario(), 8, {}, {}, permuted, OptionsFor(Isa::kReference));
  SceneOptions pieces = OptionsFor(BestIsa());
  pieces.piecewise_sort_chunks = 1;
  LocalStoreExecutor local(pieces.plan.local_store_data_bytes);
  ExpectPausesChangeNothing(TinyScenario(), 8, {}, {}, local, pieces);
  ExpectNoFaults(local);
  SceneOptions unsorted = OptionsFor(BestIsa());
  unsorted.vertex_order = VertexOrder::kIndexBuffer;
  SerialExecutor serial;
  ExpectPausesChangeNothing(TinyScenario(), 8, {}, {}, serial, unsorted);
}

TEST(Pause, KeepsSleepersAsleep) {
  Scenario scenario = RestingScenario(4);
  RunningScenario running(scenario, OptionsFor(BestIsa()));
  FurScene& scene = running.scene();
  uint32_t f = 0;
  for (; f < 400 && CountAsleep(scene) == 0; ++f) RunFrame(running, f);
  const uint32_t asleep = CountAsleep(scene);
  ASSERT_GT(asleep, 0u);
  RunInput(scene, PausedInput(scenario, f, scene));
  RunFrame(running, f);
  EXPECT_GE(CountAsleep(scene), asleep);
}

// A turned camera in a pause: the order is that of a scene which saw the same state from there, and
// the course goes on with the bits of one that never looked.
TEST(Pause, FollowsTheView) {
  Scenario scenario = TinyScenario();
  RunningScenario looking(scenario, OptionsFor(BestIsa())), plain(scenario, OptionsFor(BestIsa()));
  for (uint32_t f = 0; f < 10; ++f) {
    for (RunningScenario* running : {&looking, &plain}) RunFrame(*running, f);
    ASSERT_EQ(looking.scene().DigestFrame(), plain.scene().DigestFrame()) << "frame " << f;
    FurScene& scene = looking.scene();
    const uint64_t points = scene.DigestStream(StreamOf<&Streams::curves>),
                   keys = scene.DigestStream(StreamOf<&Streams::sort_keys>);
    FrameInput turned = PausedInput(scenario, f, scene);
    std::swap(turned.camera.eye[0], turned.camera.eye[2]);
    turned.camera.eye[1] += 0.1f;
    RunInput(scene, turned);
    EXPECT_EQ(scene.DigestStream(StreamOf<&Streams::curves>), points);
    EXPECT_NE(scene.DigestStream(StreamOf<&Streams::sort_keys>), keys);
    const uint64_t order = scene.DigestStream(StreamOf<&Streams::order>);
    // Without skipping the sort, from the same place.
    turned.skip.sort = false;
    RunInput(scene, turned);
    EXPECT_EQ(scene.DigestStream(StreamOf<&Streams::order>), order);
  }
}

// Layers that are sorted or written again in this frame.
uint32_t CountRedrawn(const FurScene& scene) {
  uint32_t count = 0;
  for (uint32_t l = 0; l < scene.shape().layer_count; ++l) {
    const auto& sort = *scene.memory().Of<&Streams::layer_sort>(l);
    count += (sort.keys_changed | sort.records_changed) != 0;
  }
  return count;
}

// What the frame before changed is drawn by then.
TEST(Pause, FromTheSameEyeDrawsNothingAgain) {
  Scenario scenario = TinyScenario();
  RunningScenario running(scenario, OptionsFor(BestIsa()));
  FurScene& scene = running.scene();
  for (uint32_t f = 0; f < 4; ++f) {
    RunFrame(running, f);
    EXPECT_GT(CountRedrawn(scene), 0u) << "frame " << f;
    FrameInput paused = PausedInput(scenario, f, scene);
    RunInput(scene, paused);
    EXPECT_EQ(CountRedrawn(scene), 0u) << "pause after frame " << f;
    paused.camera.eye[1] += 0.1f;
    RunInput(scene, paused);
    EXPECT_GT(CountRedrawn(scene), 0u) << "from elsewhere after frame " << f;
  }
}

// Which layers are simulated in `fast` follows the eye of frames: not that of pauses between them.
TEST(Pause, FromFarAwayIsNoReasonToBeLessExact) {
  Scenario scenario = TinyScenario();
  scenario.base.lod.fast_quality_px = 0.01f;
  RunningScenario looking(scenario, OptionsFor(BestIsa())), plain(scenario, OptionsFor(BestIsa()));
  for (uint32_t f = 0; f < 10; ++f) {
    for (RunningScenario* running : {&looking, &plain})
      RunFrame(*running, f, {}, scenario.base.lod);
    ASSERT_EQ(looking.scene().DigestFrame(), plain.scene().DigestFrame()) << "frame " << f;
    FrameInput far = PausedInput(scenario, f, looking.scene());
    far.camera.eye[2] += 1000.0f;
    RunInput(looking.scene(), far);
  }
}

TEST(Pause, AsTheFirstFrameShowsTheGroom) {
  Scenario scenario = TinyScenario();
  RunningScenario paused(scenario, OptionsFor(BestIsa()));
  FurScene& scene = paused.scene();
  RunInput(scene, PausedInput(scenario, 0, scene));
  EXPECT_GT(scene.DrawnStrands(), 0u);
  const uint64_t at_first = scene.DigestFrame();
  RunInput(scene, PausedInput(scenario, 0, scene));
  EXPECT_EQ(scene.DigestFrame(), at_first);
  for (uint32_t f = 0; f < 5; ++f) {
    RunFrame(paused, f);
    EXPECT_NE(scene.DigestFrame(), at_first);
  }
}

}  // namespace
}  // namespace pelt::testing
