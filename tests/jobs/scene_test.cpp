// FurScene: memory as measured, bad input refused without a trace, restarts, weather, sleep, skips
// and LOD.
#include "jobs/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt {
namespace {

using namespace testing;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

std::string BeginError(FurScene& scene, const FrameInput& input) {
  const char* fault = scene.BeginFrame(input);
  return fault ? fault : "";
}

// ---- Memory ---------------------------------------------------------------------------------------

std::string ConstructionError(const SceneLayout& layout, std::span<std::byte> memory) {
  const Scenario scenario = TinyScenario();
  try {
    FurScene scene(scenario.ActorGrooms(), {}, layout, memory);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(FurSceneMemory, TakesExactlyWhatWasMeasured) {
  const Scenario scenario = TinyScenario();
  const SceneLayout layout = MeasureScene(scenario.ActorGrooms(), {});
  uint64_t sum = 0;
  for (const MemoryRange& range : layout.ranges) {
    EXPECT_FALSE(range.name.empty());
    EXPECT_EQ(range.bytes % kBlockAlignment, 0u) << range.name;
    sum += range.bytes;
  }
  EXPECT_EQ(sum, layout.total_bytes);
  EXPECT_EQ(layout.strand_count, scenario.StrandCount());

  // Canaries on both sides of the block survive frames.
  SceneBlock block(layout.total_bytes + 2 * kBlockAlignment);
  std::memset(block.bytes().data(), 0x5a, block.bytes().size());
  FurScene scene(scenario.ActorGrooms(), {}, layout,
                 block.bytes().subspan(kBlockAlignment, layout.total_bytes));
  Scenario course = TinyScenario();
  SerialExecutor serial;
  for (uint32_t f = 0; f < 3; ++f) {
    ASSERT_EQ(BeginError(scene, course.PrepareFrame(f, scene)), "");
    serial.Run(scene.CurrentFrame());
  }
  for (uint32_t i = 0; i < kBlockAlignment; ++i) {
    ASSERT_EQ(block.bytes()[i], std::byte(0x5a));
    ASSERT_EQ(block.bytes()[block.bytes().size() - 1 - i], std::byte(0x5a));
  }
}

TEST(FurSceneMemory, RefusesTooLittleUnalignedAndForeignMemory) {
  const Scenario scenario = TinyScenario();
  const SceneLayout layout = MeasureScene(scenario.ActorGrooms(), {});
  SceneBlock block(layout.total_bytes + kBlockAlignment);
  const std::string little = ConstructionError(layout, block.bytes().first(layout.total_bytes - 1));
  EXPECT_EQ(little, "the scene needs " + std::to_string(layout.total_bytes) +
                        " bytes and was given " + std::to_string(layout.total_bytes - 1));
  const std::string unaligned = ConstructionError(layout, block.bytes().subspan(16));
  EXPECT_NE(unaligned.find("aligned to 128 bytes"), std::string::npos) << unaligned;
  const std::vector<const Groom*> twice(2, scenario.ActorGrooms()[0]);
  const SceneLayout foreign = MeasureScene(twice, {});
  SceneBlock large(foreign.total_bytes);
  const std::string other = ConstructionError(foreign, large.bytes());
  EXPECT_NE(other.find("other grooms"), std::string::npos) << other;
}

TEST(FurSceneMemory, NeedsAGroom) { EXPECT_THROW(MeasureScene({}, {}), Error); }

// ---- Bad input ------------------------------------------------------------------------------------

struct BadInput {
  const char* says;
  std::function<void(FrameInput&, FurScene&)> spoil;
};

const std::vector<BadInput> kBadInputs = {
    {"dt_s", [](FrameInput& in, FurScene&) { in.dt_s = 0.0; }},
    {"dt_s", [](FrameInput& in, FurScene&) { in.dt_s = -0.01; }},
    {"dt_s", [](FrameInput& in, FurScene&) { in.dt_s = double(kNaN); }},
    {"dt_s", [](FrameInput& in, FurScene&) { in.dt_s = double(kInf); }},
    {"dt_s", [](FrameInput& in, FurScene&) { in.dt_s = 1.5; }},
    {"time_s", [](FrameInput& in, FurScene&) { in.time_s = double(kNaN); }},
    {"time_s", [](FrameInput& in, FurScene&) { in.time_s = -1.0; }},
    {"camera", [](FrameInput& in, FurScene&) { in.camera.position[1] = kNaN; }},
    {"camera", [](FrameInput& in, FurScene&) { in.camera.vertical_fov_rad = 0.0f; }},
    {"camera",
     [](FrameInput& in, FurScene&) {
       std::memcpy(in.camera.target, in.camera.position, sizeof in.camera.target);
     }},
    {"gravity", [](FrameInput& in, FurScene&) { in.gravity[2] = kInf; }},
    {"gravity", [](FrameInput& in, FurScene&) { in.gravity[0] = 1e30f; }},
    {"wind", [](FrameInput& in, FurScene&) { in.wind.velocity[0] = kNaN; }},
    {"wind", [](FrameInput& in, FurScene&) { in.wind.gust_strength = kInf; }},
    {"wind", [](FrameInput& in, FurScene&) { in.wind.gust_period_s = 0.0f; }},
    {"wind", [](FrameInput& in, FurScene&) { in.wind.turbulence_scale_m = -1.0f; }},
    {"wind", [](FrameInput& in, FurScene&) { in.wind.turbulence_scale_m = kNaN; }},
    {"ground",
     [](FrameInput& in, FurScene&) {
       in.use_ground = true;
       in.ground[3] = kNaN;
     }},
    {"normal is not unit",
     [](FrameInput& in, FurScene&) {
       in.use_ground = true;
       in.ground[1] = 2.0f;
     }},
    {"more spheres", [](FrameInput& in, FurScene&) { in.sphere_count = kSpheresPerScene + 1; }},
    {"sphere",
     [](FrameInput& in, FurScene&) {
       in.sphere_count = 1;
       in.sphere[0][0] = kNaN;
     }},
    {"sphere",
     [](FrameInput& in, FurScene&) {
       in.sphere_count = 1;
       in.sphere[0][3] = -0.1f;
     }},
    {"weather for 2 characters, the scene has 1",
     [](FrameInput& in, FurScene&) {
       static const Weather kTwo[2];
       in.weather = kTwo;
     }},
    {"weather of character 0",
     [](FrameInput& in, FurScene&) {
       static const Weather kBad[1] = {{kNaN, 0.0f}};
       in.weather = kBad;
     }},
    {"lod", [](FrameInput& in, FurScene&) { in.lod.full_detail_px = kNaN; }},
    {"lod", [](FrameInput& in, FurScene&) { in.lod.min_fraction = kNaN; }},
    {"lod", [](FrameInput& in, FurScene&) { in.lod.hysteresis = -1.0f; }},
    {"lod", [](FrameInput& in, FurScene&) { in.lod.fade_share = 2.0f; }},
    {"pose of character 0: bad joint count",
     [](FrameInput&, FurScene& s) { s.Pose(0).joint_count = 0; }},
    {"joint count",
     [](FrameInput&, FurScene& s) { s.Pose(0).joint_count = kJointsPerCharacter + 1; }},
    {"root placement", [](FrameInput&, FurScene& s) { s.Pose(0).root[3] = kNaN; }},
    {"root placement", [](FrameInput&, FurScene& s) { s.Pose(0).root[3] = 1e9f; }},
    {"translation keys",
     [](FrameInput&, FurScene& s) { s.Pose(0).translation_key[0][1][0] = kNaN; }},
    {"rotation keys",
     [](FrameInput&, FurScene& s) {
       s.Pose(0).rotation_key[3][3][s.Pose(0).joint_count - 1] = -kInf;
     }},
    {"scale keys", [](FrameInput&, FurScene& s) { s.Pose(0).scale_key[2][0][1] = kNaN; }},
    {"translation weights",
     [](FrameInput&, FurScene& s) { s.Pose(0).translation_weight[1][0] = kNaN; }},
    {"rotation weights", [](FrameInput&, FurScene& s) { s.Pose(0).rotation_weight[1][0] = kNaN; }},
    {"scale weights", [](FrameInput&, FurScene& s) { s.Pose(0).scale_weight[1][0] = kNaN; }},
};

TEST(FurSceneInput, BadInputIsRefusedAndLeavesNoTrace) {
  Scenario scenario = TinyScenario();
  RunningScenario clean(scenario, {}), tried(scenario, {});
  SerialExecutor serial;
  uint32_t frame = 0;
  const auto run_both = [&] {
    clean.Begin(frame);
    serial.Run(clean.scene().CurrentFrame());
    tried.Begin(frame);
    serial.Run(tried.scene().CurrentFrame());
    ++frame;
    return clean.scene().DigestFrame() == tried.scene().DigestFrame();
  };
  ASSERT_TRUE(run_both());
  for (const BadInput& bad : kBadInputs) {
    FrameInput input = scenario.PrepareFrame(frame, tried.scene());
    bad.spoil(input, tried.scene());
    const std::string error = BeginError(tried.scene(), input);
    EXPECT_NE(error.find(bad.says), std::string::npos)
        << "wanted '" << bad.says << "', got '" << error << "'";
    ASSERT_TRUE(run_both()) << bad.says;
  }
}

// Finite, and as absurd as the door lets through: what comes out stays finite, and a scene that is
// put back in order recovers.
TEST(FurSceneInput, AbsurdButFiniteInputDoesNoLastingHarm) {
  Scenario scenario = TinyScenario();
  RunningScenario running(scenario, {});
  FurScene& scene = running.scene();
  SerialExecutor serial;
  for (uint32_t f = 0; f < 3; ++f) {
    running.Begin(f);
    serial.Run(scene.CurrentFrame());
  }
  FrameInput input = scenario.PrepareFrame(3, scene);
  for (int i : {3, 7, 11}) scene.Pose(0).root[i] = 9e5f;
  input.gravity[1] = -9e5f;
  input.wind.velocity[0] = 9e5f;
  input.dt_s = 1.0;
  ASSERT_EQ(BeginError(scene, input), "");
  serial.Run(scene.CurrentFrame());
  for (uint32_t f = 4; f < 30; ++f) {
    running.Begin(f);
    serial.Run(scene.CurrentFrame());
  }
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    const auto finite = [&](Stream stream, uint32_t points) {
      const float* p = scene.memory().As<float>(stream, c);
      if (!p) return;
      for (uint32_t row = 0; row < 3 * (points - 1); ++row)
        for (uint32_t i = 0; i < scene.LiveLanes(stream, c); ++i)
          ASSERT_LT(std::abs(p[row * kStrandsPerChunk + i]), 10.0f)
              << DescribeStream(stream).name << " of chunk " << c << ", lane " << i;
    };
    finite(Stream::kVertexPoints, 4);
    finite(Stream::kStrandPoints4, 4);
    finite(Stream::kStrandPoints5, 5);
  }
}

// ---- Restarts -------------------------------------------------------------------------------------

constexpr Stream kRestarted[] = {
    Stream::kSkinned,        Stream::kAnchors,         Stream::kRoots,
    Stream::kVertexPoints,   Stream::kVertexPrevious,  Stream::kStrandPoints4,
    Stream::kStrandPrevious4, Stream::kStrandPoints5,  Stream::kStrandPrevious5,
    Stream::kCurves,         Stream::kRibbons,         Stream::kSortKeys,
    Stream::kOrder,          Stream::kInstances,       Stream::kRibbonVertices};

// Holds `scene` after `frame` against a scene whose first frame it was.
void ExpectLikeAFirstFrame(Scenario& scenario, uint32_t frame, const FurScene& scene) {
  RunningScenario fresh(scenario, {});
  fresh.Begin(frame);
  SerialExecutor().Run(fresh.scene().CurrentFrame());
  for (const Stream stream : kRestarted)
    EXPECT_EQ(scene.DigestStream(stream), fresh.scene().DigestStream(stream))
        << DescribeStream(stream).name;
}

TEST(FurSceneRestart, TeleportedCharacterStartsFromItsGroom) {
  Scenario scenario = TinyScenario();
  const auto teleport = uint32_t(scenario.actors[0].teleport_frame);
  RunningScenario running(scenario, {});
  SerialExecutor serial;
  for (uint32_t f = 0; f <= teleport; ++f) {
    running.Begin(f);
    serial.Run(running.scene().CurrentFrame());
    if (f + 1 == teleport) {
      EXPECT_EQ(CountChunks(running.scene(), kChunkRestart), 0u);
    }
  }
  EXPECT_EQ(CountChunks(running.scene(), kChunkRestart), running.scene().shape().chunk_count);
  ExpectLikeAFirstFrame(scenario, teleport, running.scene());
}

TEST(FurSceneRestart, NewlyVisibleCharacterStartsFromItsGroom) {
  Scenario scenario = RestingScenario(~0u);
  RunningScenario running(scenario, {});
  FurScene& scene = running.scene();
  SerialExecutor serial;
  const auto run = [&](uint32_t frame, bool look_away) {
    FrameInput input = scenario.PrepareFrame(frame, scene);
    if (look_away)
      for (int a = 0; a < 3; ++a)
        input.camera.target[a] = 2.0f * input.camera.position[a] - input.camera.target[a];
    ASSERT_EQ(BeginError(scene, input), "");
    serial.Run(scene.CurrentFrame());
  };
  for (uint32_t f = 0; f < 5; ++f) run(f, false);
  EXPECT_GT(scene.DrawnStrands(), 0u);
  for (uint32_t f = 5; f < 9; ++f) run(f, true);
  EXPECT_EQ(scene.DrawnStrands(), 0u);
  EXPECT_EQ(scene.LiveStrands(), 0u);
  EXPECT_EQ(scene.memory().As<DrawListBlock>(Stream::kDrawList, 0)->count, 0u);
  run(9, false);
  ExpectLikeAFirstFrame(scenario, 9, scene);
}

// ---- Weather --------------------------------------------------------------------------------------

TEST(FurSceneWeather, WetAndDirtyChangeWhileRunningWithoutAReset) {
  Scenario wet_course = TinyScenario(), dry_course = TinyScenario();
  dry_course.weather_course = {};
  const uint32_t from = wet_course.weather_course.from_frame;
  RunningScenario wet(wet_course, {}), dry(dry_course, {});
  SerialExecutor serial;
  for (uint32_t f = 0; f < 20; ++f) {
    wet.Begin(f);
    serial.Run(wet.scene().CurrentFrame());
    dry.Begin(f);
    serial.Run(dry.scene().CurrentFrame());
    const bool same = wet.scene().DigestFrame() == dry.scene().DigestFrame();
    EXPECT_EQ(same, f < from) << "frame " << f;
    if (f > 0) {
      EXPECT_EQ(CountChunks(wet.scene(), kChunkRestart), 0u) << "frame " << f;
    }
    if (f == from) {
      // The first wet frame is a small step away from the dry one (towards the control strands,
      // which in this thin fur are decimetres away), not a jump.
      EXPECT_NE(wet.scene().DigestStream(Stream::kStrandPoints4),
                dry.scene().DigestStream(Stream::kStrandPoints4));
      for (uint32_t c = 0; c < wet.scene().shape().chunk_count; ++c) {
        const auto* a = wet.scene().memory().As<PointBlock<4>>(Stream::kStrandPoints4, c);
        const auto* b = dry.scene().memory().As<PointBlock<4>>(Stream::kStrandPoints4, c);
        if (!a) continue;
        for (uint32_t i = 0; i < wet.scene().LiveLanes(Stream::kStrandPoints4, c); ++i)
          for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(a->position[2][axis][i], b->position[2][axis][i], 0.02f);
      }
    }
  }
}

// ---- Sleep ----------------------------------------------------------------------------------------

// Runs until every visible chunk sleeps; the number of frames it took, or `most`.
struct Course {
  Scenario scenario = RestingScenario(6);
  RunningScenario running{scenario, {}};
  SerialExecutor serial;
  std::function<void(FrameInput&, FurScene&)> change = [](FrameInput&, FurScene&) {};
  uint32_t frame = 0;

  FurScene& scene() { return running.scene(); }
  void Run() {
    FrameInput input = scenario.PrepareFrame(frame++, scene());
    input.time_s = 0.0;
    change(input, scene());
    ASSERT_EQ(BeginError(scene(), input), "");
    serial.Run(scene().CurrentFrame());
  }
  uint32_t Awake() { return CountChunks(scene(), kChunkVisible | kChunkSimulate); }
  bool FallAsleep(uint32_t most) {
    for (uint32_t i = 0; i < most; ++i) {
      Run();
      if (Awake() == 0) return true;
    }
    return false;
  }
};

constexpr uint32_t kLongestToRest = 2000;

TEST(FurSceneSleep, AStillSceneSleepsAndDoesNothing) {
  Course course;
  ASSERT_TRUE(course.FallAsleep(kLongestToRest)) << course.Awake() << " chunks still awake";
  EXPECT_EQ(CountAsleep(course.scene()), course.scene().shape().chunk_count);
  course.Run();
  course.Run();
  EXPECT_EQ(CountChunks(course.scene(), kChunkVisible,
                        kChunkSkin | kChunkSimulate | kChunkFit | kChunkKeys),
            course.scene().shape().chunk_count);
  for (uint32_t l = 0; l < course.scene().shape().layer_count; ++l) {
    const auto& sort = *course.scene().memory().As<LayerSortBlock>(Stream::kLayerSort, l);
    EXPECT_EQ(sort.keys_changed | sort.records_changed, 0u);
    EXPECT_GT(sort.visible_count, 0u) << "it is still drawn, with last frame's vertices";
  }
}

TEST(FurSceneSleep, WhateverMovesWakesIt) {
  Course course;
  ASSERT_TRUE(course.FallAsleep(kLongestToRest));
  const uint32_t all = course.scene().shape().chunk_count;
  using Change = std::function<void(FrameInput&, FurScene&)>;
  // Each stays in force for the changes after it.
  const std::vector<std::pair<const char*, Change>> changes = {
      {"dt", [](FrameInput& in, FurScene&) { in.dt_s = 1.0 / 50.0; }},
      {"gravity", [](FrameInput& in, FurScene&) { in.gravity[1] = -9.0f; }},
      {"ground", [](FrameInput& in, FurScene&) { in.ground[3] = -0.01f; }},
      {"sphere", [](FrameInput& in, FurScene&) { in.sphere[0][3] += 0.01f; }},
      {"weather",
       [](FrameInput& in, FurScene&) {
         static const Weather kWet[1] = {{1.0f, 0.0f}};
         in.weather = kWet;
       }},
      {"placement", [](FrameInput&, FurScene& s) { s.Pose(0).root[3] += 0.01f; }},
  };
  std::vector<Change> in_force;
  course.change = [&](FrameInput& in, FurScene& s) {
    for (const Change& change : in_force) change(in, s);
  };
  for (const auto& [name, change] : changes) {
    in_force.push_back(change);
    course.Run();
    EXPECT_EQ(course.Awake(), all) << name;
    ASSERT_TRUE(course.FallAsleep(kLongestToRest)) << name;
  }
  // Wind: only layers that answer to it wake, and they stay awake while it blows.
  in_force.push_back([](FrameInput& in, FurScene&) { in.wind.velocity[0] = 1.0f; });
  course.Run();
  for (uint32_t c = 0; c < all; ++c) {
    const auto& state = *course.scene().memory().As<ChunkStateBlock>(Stream::kChunkState, c);
    const uint32_t layer = course.scene().shape().chunk_layer[c];
    const uint32_t flags = course.scene().memory().As<LayerBlock>(Stream::kLayers, layer)->flags;
    EXPECT_EQ((state.flags & kChunkSimulate) != 0, (flags & kLayerWind) != 0) << c;
  }
  EXPECT_GT(course.Awake(), 0u);
}

TEST(FurSceneSleep, ATurnedCameraSortsAgainAndWakesNobody) {
  Course course;
  ASSERT_TRUE(course.FallAsleep(kLongestToRest));
  course.change = [](FrameInput& in, FurScene&) { in.camera.position[0] += 0.3f; };
  course.Run();
  EXPECT_EQ(course.Awake(), 0u);
  EXPECT_EQ(CountChunks(course.scene(), kChunkKeys), course.scene().shape().chunk_count);
}

// ---- Skips ----------------------------------------------------------------------------------------

struct SkipCase {
  const char* name;
  bool SkipSettings::*which;
};
constexpr SkipCase kSkips[] = {{"sleep", &SkipSettings::sleep},
                               {"unmoved", &SkipSettings::unmoved},
                               {"sort", &SkipSettings::sort},
                               {"cull", &SkipSettings::cull},
                               {"wind", &SkipSettings::wind}};

void ExpectSkipsChangeNothing(Scenario scenario, uint32_t frames) {
  SerialExecutor serial;
  const auto with_all = RunDigests(scenario, {}, serial, frames);
  for (const SkipCase& c : kSkips) {
    SkipSettings skip;
    skip.*(c.which) = false;
    ExpectSameFrames(with_all, RunDigests(scenario, {}, serial, frames, skip),
                     std::string("without ") + c.name);
  }
  const SkipSettings none{false, false, false, false, false, false};
  ExpectSameFrames(with_all, RunDigests(scenario, {}, serial, frames, none), "without any");
}

TEST(FurSceneSkips, ChangeNothingInMotion) { ExpectSkipsChangeNothing(TinyScenario(), 24); }
// The course of the sleep tests: into sleep and a while of it.
TEST(FurSceneSkips, ChangeNothingComingToRest) {
  ExpectSkipsChangeNothing(RestingScenario(6), 240);
}
// And out of it: rests from frame 6, walks on where its clock stands.
TEST(FurSceneSkips, ChangeNothingWhenItMovesAgain) {
  Scenario scenario = RestingScenario(6);
  SerialExecutor serial;
  const auto run = [&](const SkipSettings& skip) {
    std::vector<uint64_t> digests;
    Scenario course = scenario;
    RunningScenario running(course, {});
    for (uint32_t f = 0; f < 140; ++f) {
      course.rest_from_frame = f < 120 ? 6 : ~0u;
      running.Begin(f, skip, {});
      serial.Run(running.scene().CurrentFrame());
      digests.push_back(running.scene().DigestFrame());
    }
    return digests;
  };
  ExpectSameFrames(run({}), run({false, false, false, false, false, false}), "without any");
}

// ---- LOD ------------------------------------------------------------------------------------------

// A layer far too small on the screen for its strands, held at `fraction`.
LodSettings HeldAt(float fraction) { return {1e9f, fraction, 0.0f, 0.0f, 0}; }

TEST(FurSceneLod, APrefixKeepsTheBitsOfTheFullRun) {
  Scenario scenario = TinyScenario();
  RunningScenario full(scenario, {}), half(scenario, {});
  SkipSettings lod_on;
  lod_on.lod = true;
  SerialExecutor serial;
  for (uint32_t f = 0; f < 24; ++f) {
    full.Begin(f, {}, {});
    serial.Run(full.scene().CurrentFrame());
    half.Begin(f, lod_on, HeldAt(0.5f));
    serial.Run(half.scene().CurrentFrame());
  }
  const FurScene &a = full.scene(), &b = half.scene();
  uint32_t compared = 0;
  for (uint32_t c = 0; c < a.shape().chunk_count; ++c) {
    const uint32_t strands = a.memory().As<StrandBlock>(Stream::kStrands, c)->strand_count;
    const uint32_t live = b.LiveLanes(Stream::kRoots, c);
    EXPECT_EQ(live, (strands + 1) / 2);
    const auto same = [&](Stream stream, uint32_t rows) {
      const auto *p = a.memory().As<uint32_t>(stream, c), *q = b.memory().As<uint32_t>(stream, c);
      if (!p) return;
      for (uint32_t row = 0; row < rows; ++row)
        ASSERT_EQ(std::memcmp(p + row * kStrandsPerChunk, q + row * kStrandsPerChunk,
                              4 * b.LiveLanes(stream, c)),
                  0)
            << DescribeStream(stream).name << " of chunk " << c << ", row " << row;
      ++compared;
    };
    same(Stream::kRoots, 12);
    same(Stream::kVertexPoints, 9);
    same(Stream::kStrandPoints4, 9);
    same(Stream::kStrandPoints5, 12);
    if (const auto* p = a.memory().As<CurveBlock>(Stream::kCurves, c)) {
      EXPECT_EQ(std::memcmp(p, b.memory().As<CurveBlock>(Stream::kCurves, c),
                            live * sizeof(CurveRecord)),
                0);
    }
  }
  EXPECT_GE(compared, 2 * a.shape().chunk_count);
}

TEST(FurSceneLod, DrawsItsShareOfEveryChunk) {
  Scenario scenario = TinyScenario();
  SkipSettings lod_on;
  lod_on.lod = true;
  for (const float fraction : {0.05f, 0.25f, 0.8f, 1.0f}) {
    RunningScenario running(scenario, {});
    running.Begin(0, lod_on, HeldAt(fraction));
    SerialExecutor().Run(running.scene().CurrentFrame());
    const double wanted = double(fraction) * double(scenario.StrandCount());
    EXPECT_GE(running.scene().LiveStrands(), wanted * 0.999);
    EXPECT_LE(running.scene().LiveStrands(), wanted + running.scene().shape().chunk_count);
  }
}

TEST(FurSceneLod, KeepsToItsBudget) {
  Scenario scenario = TinyScenario();
  SkipSettings lod_on;
  lod_on.lod = true;
  LodSettings lod;
  lod.full_detail_px = 0.0f;
  lod.hysteresis = 0.0f;
  lod.strand_budget = 200;
  RunningScenario running(scenario, {});
  SerialExecutor serial;
  for (uint32_t f = 0; f < 10; ++f) {
    running.Begin(f, lod_on, lod);
    serial.Run(running.scene().CurrentFrame());
    // The budget acts on what the frame before measured.
    if (f > 0) {
      EXPECT_LE(running.scene().LiveStrands(), 200 + running.scene().shape().chunk_count) << f;
    }
  }
  EXPECT_GE(running.scene().LiveStrands(), 180u);
}

// Strands that come back while the rest runs start from their groom; nothing else notices.
TEST(FurSceneLod, GrowingBackDisturbsNoStrandThatWasThere) {
  Scenario scenario = TinyScenario();
  RunningScenario full(scenario, {}), grown(scenario, {});
  SkipSettings lod_on;
  lod_on.lod = true;
  SerialExecutor serial;
  for (uint32_t f = 0; f < 8; ++f) {
    full.Begin(f, {}, {});
    serial.Run(full.scene().CurrentFrame());
    grown.Begin(f, lod_on, HeldAt(f < 4 ? 0.5f : 1.0f));
    serial.Run(grown.scene().CurrentFrame());
  }
  const FurScene &a = full.scene(), &b = grown.scene();
  EXPECT_EQ(a.LiveStrands(), b.LiveStrands());
  for (uint32_t c = 0; c < a.shape().chunk_count; ++c) {
    const auto* p = a.memory().As<PointBlock<4>>(Stream::kStrandPoints4, c);
    if (!p || (a.shape().layer_kind[a.shape().chunk_layer[c]] & kLayerVertexChains)) continue;
    const auto* q = b.memory().As<PointBlock<4>>(Stream::kStrandPoints4, c);
    const uint32_t strands = a.memory().As<StrandBlock>(Stream::kStrands, c)->strand_count;
    for (uint32_t i = 0; i < (strands + 1) / 2; ++i)
      EXPECT_EQ(std::memcmp(&p->position[2][0][i], &q->position[2][0][i], 4), 0) << c << ' ' << i;
  }
}

}  // namespace
}  // namespace pelt
