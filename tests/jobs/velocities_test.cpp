// Velocities with the poses: what the frame makes of them, what they are worth, and that nothing
// changes without them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "bench/accuracy/double3.hpp"
#include "core/bind_pose.hpp"
#include "core/groom/groom_file.hpp"
#include "core/kernels/frame_table.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/c_scene.hpp"
#include "tests/jobs/non_finite.hpp"
#include "traces/input_log.hpp"

namespace pelt::testing {
namespace {

using accuracy::Double3, accuracy::IsFinite, accuracy::Length;

SceneOptions WithVelocities(Isa isa = BestIsa()) { return {.isa = isa, .velocities = true}; }

Double3 At(const float (&rows)[3][kStrandsPerChunk], uint32_t lane) {
  return {rows[0][lane], rows[1][lane], rows[2][lane]};
}

// Calls visit(roots, rates, lanes in use) for every patch and chunk of chains with velocities.
void VisitRoots(const FurScene& scene, auto&& visit) {
  const FrameMemory& memory = scene.memory();
  for (uint32_t p = 0; p < scene.shape().patch_count; ++p)
    if (const auto* rates = memory.Of<&Streams::anchor_rates>(p))
      visit(*memory.Of<&Streams::anchors>(p), *rates,
            scene.LiveLanes(StreamOf<&Streams::anchor_rates>, p));
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c)
    if (const auto* rates = memory.Of<&Streams::root_rates>(c))
      visit(*memory.Of<&Streams::roots>(c), *rates,
            scene.LiveLanes(StreamOf<&Streams::root_rates>, c));
}

// Position, normal and tangent of every one of their roots.
struct RootFrame {
  Double3 place, normal, tangent;
};
std::vector<RootFrame> RootsOf(const FurScene& scene) {
  std::vector<RootFrame> all;
  VisitRoots(scene, [&](const RootBlock& roots, const RootRateBlock&, uint32_t lanes) {
    for (uint32_t l = 0; l < lanes; ++l)
      all.push_back({At(roots.position, l), At(roots.normal, l), At(roots.tangent, l)});
  });
  return all;
}

struct RootRate {
  Double3 velocity, spin;
};
std::vector<RootRate> RatesOf(const FurScene& scene) {
  std::vector<RootRate> all;
  VisitRoots(scene, [&](const RootBlock&, const RootRateBlock& rates, uint32_t lanes) {
    for (uint32_t l = 0; l < lanes; ++l) all.push_back({At(rates.velocity, l), At(rates.spin, l)});
  });
  return all;
}

TEST(Velocities, RootsMoveAndTurnAsFastAsTheyAreSaidTo) {
  Scenario scenario = TinyScenario();
  scenario.dt_s = 1.0 / 2048.0;
  RunningScenario run(scenario, WithVelocities());
  double largest = 0.0, fastest_turn = 0.0;
  for (const uint32_t frame : {301u, 977u, 1501u, 2311u}) {
    RunFrame(run, frame - 1);
    const auto before = RootsOf(run.scene());
    RunFrame(run, frame);
    const auto rates = RatesOf(run.scene());
    const auto now = RootsOf(run.scene());
    RunFrame(run, frame + 1);
    const auto after = RootsOf(run.scene());
    ASSERT_EQ(rates.size(), after.size());
    ASSERT_GT(rates.size(), 200u);
    const double per = 0.5 / scenario.dt_s;
    for (size_t i = 0; i < rates.size(); ++i) {
      const Double3 off = (after[i].place - before[i].place) * per - rates[i].velocity;
      const Double3 normal = (after[i].normal - before[i].normal) * per;
      const Double3 tangent = (after[i].tangent - before[i].tangent) * per;
      ASSERT_LT(Length(off), 1e-3 + 2e-3 * Length(rates[i].velocity)) << frame << ", root " << i;
      const double most = 3e-3 + 2e-3 * Length(rates[i].spin);
      ASSERT_LT(Length(Cross(rates[i].spin, now[i].normal) - normal), most) << frame << ' ' << i;
      ASSERT_LT(Length(Cross(rates[i].spin, now[i].tangent) - tangent), most) << frame << ' ' << i;
      largest = std::max(largest, Length(rates[i].velocity));
      fastest_turn = std::max(fastest_turn, Length(rates[i].spin));
    }
  }
  EXPECT_GT(largest, 0.1);
  EXPECT_GT(fastest_turn, 0.3);
}

// Tips of a layer's strands from their roots, fifteen times a second, at a rate. From one second on:
// how a strand begins that did not exist before is a matter of the frame's length.
std::vector<Double3> PointsAt(uint32_t rate, bool velocities, double seconds) {
  Scenario scenario = TinyScenario();
  scenario.dt_s = 1.0 / rate;
  // What happens in a frame of a certain number would not be at one time.
  scenario.actors[0].teleport_frame = -1;
  scenario.rest_from_frame = ~0u;
  scenario.weather_course = {};
  scenario.spheres.clear();  // they jump from frame to frame, as wind does
  scenario.base.wind = {};
  for (LayerParams* layer : LayersOf(scenario)) {
    layer->quality = ModalQuality::kFine;
    layer->frequency_hz = 10.0f;  // stiff hair feels most of how its root moves
  }
  RunningScenario run(scenario, velocities ? WithVelocities() : SceneOptions{});
  std::vector<Double3> all;
  const uint32_t every = rate / 15;
  for (uint32_t f = 0; f <= uint32_t(15 * seconds) * every; ++f) {
    RunFrame(run, f);
    if (f % every != 0 || f < rate) continue;
    const FrameMemory& memory = run.scene().memory();
    for (uint32_t c = 0; c < run.scene().shape().chunk_count; ++c) {
      if (!memory.Of<&Streams::strand_modal4>(c)) continue;
      const auto& points = *memory.Of<&Streams::strand_points4>(c);
      const auto& roots = *memory.Of<&Streams::roots>(c);
      for (uint32_t l = 0; l < memory.Of<&Streams::chunk_state>(c)->live_strands; ++l)
        all.push_back(At(points.position[2], l) - At(roots.position, l));
    }
  }
  return all;
}

double RmsOff(const std::vector<Double3>& a, const std::vector<Double3>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += Dot(a[i] - b[i], a[i] - b[i]);
  return std::sqrt(sum / double(a.size()));
}

TEST(Velocities, MakeLowFrameRatesExact) {
  const auto exact = PointsAt(240, false, 3.0);
  for (const uint32_t rate : {15u, 30u}) {
    const auto with = PointsAt(rate, true, 3.0), without = PointsAt(rate, false, 3.0);
    ASSERT_EQ(with.size(), exact.size());
    const double better = RmsOff(with, exact), worse = RmsOff(without, exact);
    std::printf("tiny at %u Hz: tips %.3f mm off without velocities, %.3f with\n", rate,
                1e3 * worse, 1e3 * better);
    EXPECT_LT(better, 0.5 * worse) << rate;
  }
}

TEST(Velocities, NothingChangesUntilTheyAreGiven) {
  Scenario scenario = TinyScenario(), other = TinyScenario();
  RunningScenario plain(scenario, {}), rated(other, WithVelocities());
  for (uint32_t f = 0; f < 12; ++f) {
    RunFrame(plain, f);
    const FrameInput input = rated.Prepare(f, other.base.skip, other.base.lod);
    ASSERT_NE(rated.scene().PoseRates(0), nullptr);
    rated.scene().PoseRates(0)->given = 0;
    RunInput(rated, input);
    for (uint32_t s = 0; s < kStreamCount; ++s)
      if (plain.scene().memory().streams[s].block_count != 0) {
        ASSERT_EQ(plain.scene().DigestStream(Stream(s)), rated.scene().DigestStream(Stream(s)))
            << DescribeStream(Stream(s)).name << ", frame " << f;
      }
  }
  EXPECT_EQ(plain.scene().PoseRates(0), nullptr);
  // And then it does.
  RunFrame(plain, 12);
  RunFrame(rated, 12);
  EXPECT_NE(plain.scene().DigestStream(StreamOf<&Streams::strand_points4>),
            rated.scene().DigestStream(StreamOf<&Streams::strand_points4>));
}

TEST(Velocities, HaveTheSameBitsOnEveryInstructionSetAndInLocalStores) {
  constexpr uint32_t kFrames = 8;
  Scenario scenario = TinyScenario();
  const std::vector<uint64_t> expected =
      RunDigests(scenario, WithVelocities(Isa::kReference), kFrames);
  for (const Isa isa : kAllIsas)
    if (FindKernels(isa)) {
      EXPECT_EQ(RunDigests(scenario, WithVelocities(isa), kFrames), expected) << IsaName(isa);
    }
  for (const bool fuse : {true, false}) {
    SceneOptions options = WithVelocities();
    options.plan.fuse = fuse;
    LocalStoreExecutor local(options.plan.local_store_data_bytes);
    EXPECT_EQ(RunDigests(scenario, options, local, kFrames), expected);
    ExpectNoFaults(local);
  }
}

// A still character that is said to move, and is not moved, is awake for as long as it is said.
TEST(Velocities, WakeAndLetSleepAgain) {
  Scenario scenario = TinyScenario();
  scenario.rest_from_frame = 0;
  RunningScenario run(scenario, WithVelocities());
  const auto simulated = [&] {
    const FrameMemory& memory = run.scene().memory();
    uint32_t count = 0;
    for (uint32_t p = 0; p < run.scene().shape().patch_count; ++p)
      if (memory.Of<&Streams::anchor_rates>(p))
        count += (memory.Of<&Streams::patch_state>(p)->flags & kChunkSimulate) != 0;
    for (uint32_t c = 0; c < run.scene().shape().chunk_count; ++c)
      if (memory.Of<&Streams::root_rates>(c))
        count += (memory.Of<&Streams::chunk_state>(c)->flags & kChunkSimulate) != 0;
    return count;
  };
  uint32_t frame = 0;
  while (frame < 1200 && (frame < 2 || simulated() > 0)) RunFrame(run, frame++);
  ASSERT_EQ(simulated(), 0u) << "nothing came to rest";
  const FrameInput input = run.Prepare(frame++, scenario.base.skip, scenario.base.lod);
  run.scene().PoseRates(0)->translation[0][0] = 0.5f;
  RunInput(run, input);
  EXPECT_GT(simulated(), 0u);
  double off = 0.0;
  for (const RootRate& rate : RatesOf(run.scene())) off = std::max(off, Length(rate.velocity));
  EXPECT_GT(off, 0.01);
  RunFrame(run, frame++);
  for (const RootRate& rate : RatesOf(run.scene())) EXPECT_EQ(Length(rate.velocity), 0.0);
  uint32_t more = 0;
  while (more < 1200 && simulated() > 0) RunFrame(run, frame++), ++more;
  EXPECT_EQ(simulated(), 0u);
}

// All velocities that are let through, however large, and bodies that are flattened while they spin.
TEST(Velocities, OfAnySizeLeaveEverythingFinite) {
  Scenario scenario = TinyScenario();
  RunningScenario run(scenario, WithVelocities());
  std::mt19937 random(7);
  uint32_t accepted = 0;
  for (uint32_t f = 0; f < 60; ++f) {
    const FrameInput input = run.Prepare(f, scenario.base.skip, scenario.base.lod);
    FurScene& scene = run.scene();
    PoseRateBlock& rates = *scene.PoseRates(0);
    const auto any = [&](double most) {
      return float(std::uniform_real_distribution<>(-1.0, 1.0)(random) * most);
    };
    const double size = std::pow(10.0, double(f % 12) - 5.0);
    for (auto* rows : {&rates.translation, &rates.spin, &rates.scale})
      for (auto& row : *rows) row[random() % 8] = any(std::min(size, 1e6));
    for (float& element : rates.root) element = any(std::min(size, 1e6));
    if (f % 5 == 4)
      for (auto& key : scene.Pose(0).scale_key)
        for (auto& row : key) row[random() % 8] = 0.0f;
    RunInput(scene, input);
    accepted += scene.RefusedPoses().empty();
    ASSERT_EQ(FindNonFinite(scene), "") << f;
  }
  EXPECT_GT(accepted, 30u);
  EXPECT_LT(accepted, 60u);
}

TEST(Velocities, AreRecordedAndReplayed) {
  Scenario scenario = TinyScenario();
  RunningScenario run(scenario, WithVelocities());
  const std::vector<std::byte> groom = WriteGroom(scenario.grooms[0]).OrThrow();
  const std::span<const std::byte> grooms[] = {groom};
  InputLogWriter writer;
  InputLogScene about;
  about.velocities = true;
  ASSERT_EQ(writer.Begin(about, grooms), nullptr);
  for (uint32_t f = 0; f < 6; ++f) {
    const FrameInput input = run.Prepare(f, scenario.base.skip, scenario.base.lod);
    run.scene().PoseRates(0)->given = f != 3;
    RunInput(run, input);
    ASSERT_EQ(writer.AddFrame(input, {&run.scene().Pose(0), 1}, run.scene().DigestFrame(),
                              {run.scene().PoseRates(0), 1}),
              nullptr);
  }
  const InputLog log = ReadInputLog(writer.Finish(), "log").OrThrow();
  RunningScenario again(scenario, WithVelocities());
  for (uint32_t f = 0; f < 6; ++f) {
    log.FillPose(f, 0, &again.scene().Pose(0));
    log.FillPoseRates(f, 0, again.scene().PoseRates(0));
    EXPECT_EQ(again.scene().PoseRates(0)->given, f != 3 ? 1u : 0u);
    RunInput(again.scene(), log.Input(f));
    EXPECT_EQ(again.scene().DigestFrame(), log.frames[f].digest) << f;
  }
}

TEST(Velocities, ComeInByTheCInterface) {
  const Scenario scenario = TinyScenario();
  PeltSceneOptions options{};
  options.velocities = 1;
  const OwnScene made = MakeCScene(&options), made_plain = MakeCScene(nullptr);
  PeltScene *const scene = made.get(), *const plain = made_plain.get();
  const PeltJointVelocity velocity = {{0.0f, 0.5f, 0.0f}, {1.0f, 0.0f, 0.0f}, {}};
  const float root[12] = {0, 0, 0, 0.3f};
  EXPECT_NE(pelt_set_joint_velocity(plain, 0, 0, &velocity), nullptr);
  EXPECT_NE(pelt_place_velocity(plain, 0, root), nullptr);
  EXPECT_NE(pelt_set_joint_velocity(scene, 0, 1000, &velocity), nullptr);
  EXPECT_NE(pelt_set_joint_velocity(scene, 1, 0, &velocity), nullptr);
  EXPECT_NE(pelt_set_joint_velocity(scene, 0, 0, nullptr), nullptr);
  EXPECT_NE(pelt_place_velocity(scene, 1, root), nullptr);
  PeltFrame frame;
  pelt_default_frame(&frame);

  RunningScenario own(const_cast<Scenario&>(scenario), WithVelocities());
  FillBindPose(scenario.grooms[0], own.scene().Pose(0));
  for (uint32_t f = 0; f < 4; ++f) {
    PoseRateBlock& rates = *own.scene().PoseRates(0);
    rates = {};
    if (f == 1 || f == 2) {  // and in the last frame no longer
      rates.given = 1;
      if (f == 1) {
        rates.translation[1][2] = 0.5f;
        rates.spin[0][2] = 1.0f;
        EXPECT_EQ(pelt_set_joint_velocity(scene, 0, 2, &velocity), nullptr);
      }
      rates.root[3] = 0.3f;  // what was said of a joint before is not said again
      EXPECT_EQ(pelt_place_velocity(scene, 0, root), nullptr);
    }
    FrameInput input;
    input.time_s = frame.time_s = f / 60.0;
    ASSERT_EQ(pelt_begin(scene, &frame), nullptr);
    ASSERT_EQ(pelt_run(scene, nullptr), nullptr);
    RunInput(own.scene(), input);
    EXPECT_EQ(pelt_digest(scene), own.scene().DigestFrame()) << f;
  }
}

// A character whose pose is refused stands still, regardless of the velocities given for it: as one that is
// given its last pose again, and no velocity.
TEST(Velocities, OfAPoseThatIsHeldDoNotCount) {
  Scenario scenario = TinyScenario();
  RunningScenario held(scenario, WithVelocities()), again(scenario, WithVelocities());
  PoseBlock last{};
  for (uint32_t f = 0; f < 10; ++f) {
    const bool refused = f % 4 == 2;
    const FrameInput input = scenario.PrepareFrame(f, held.scene());
    ASSERT_NE(held.scene().PoseRates(0)->given, 0u);
    if (refused) held.scene().Pose(0).root[3] = std::numeric_limits<float>::quiet_NaN();
    RunInput(held.scene(), input);
    ASSERT_EQ(held.scene().RefusedPoses().size(), refused ? 1u : 0u);

    const FrameInput same = scenario.PrepareFrame(f, again.scene());
    if (refused) again.scene().Pose(0) = last, again.scene().PoseRates(0)->given = 0;
    last = again.scene().Pose(0);
    RunInput(again.scene(), same);
    for (const Stream points :
         {StreamOf<&Streams::strand_points4>, StreamOf<&Streams::strand_points5>})
      ASSERT_EQ(held.scene().DigestStream(points), again.scene().DigestStream(points))
          << DescribeStream(points).name << ", frame " << f;
  }
}

TEST(Velocities, ThatCannotBeUsedRefuseThePoseAndSayWhy) {
  Scenario scenario = TinyScenario();
  RunningScenario run(scenario, WithVelocities());
  FurScene& scene = run.scene();
  RunFrame(run, 0);
  const auto text_of = [&](auto spoil) -> std::string {
    const FrameInput input = scenario.PrepareFrame(1, scene);
    spoil(*scene.PoseRates(0));
    RunInput(scene, input);
    const auto refused = scene.RefusedPoses();
    return refused.empty() ? "" : DescribeRefusedPose(refused[0]);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(text_of([](PoseRateBlock&) {}), "");
  EXPECT_EQ(text_of([&](PoseRateBlock& r) { r.translation[1][3] = nan; }),
            "pose of character 0, joint 3: its velocity is not finite, or beyond 1e6");
  EXPECT_EQ(text_of([&](PoseRateBlock& r) { r.spin[2][4] = 2e6f; }),
            "pose of character 0, joint 4: its spin is not finite, or beyond 1e6");
  EXPECT_EQ(text_of([&](PoseRateBlock& r) { r.scale[0][0] = -INFINITY; }),
            "pose of character 0, joint 0: its scale's velocity is not finite, or beyond 1e6");
  EXPECT_EQ(text_of([&](PoseRateBlock& r) { r.root[11] = nan; }),
            "pose of character 0: its root placement's velocity is not finite, or beyond 1e6");
  EXPECT_NE(text_of([&](PoseRateBlock& r) {
              r.spin[0][0] = r.spin[1][0] = 1e6f, r.scale[0][1] = 1e6f, r.root[0] = 1e6f;
            }).find("faster than 1e7 m/s"),
            std::string::npos);
  // Not looked at where they are not given.
  EXPECT_EQ(text_of([&](PoseRateBlock& r) { r.given = 0, r.translation[1][3] = nan; }), "");
  for (const RootFrame& root : RootsOf(scene)) EXPECT_TRUE(IsFinite(root.place));
}

}  // namespace
}  // namespace pelt::testing
