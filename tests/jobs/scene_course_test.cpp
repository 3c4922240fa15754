// Courses of a scene: restarts, weather, falling asleep and waking, and that no skip changes a bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "jobs/scene.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

// ---- Restarts -----------------------------------------------------------------------------------

constexpr Stream kRestarted[] = {
    StreamOf<&Streams::skinned>,         StreamOf<&Streams::anchors>,
    StreamOf<&Streams::vertex_loads>,    StreamOf<&Streams::roots>,
    StreamOf<&Streams::vertex_points>,   StreamOf<&Streams::vertex_previous>,
    StreamOf<&Streams::strand_points4>,  StreamOf<&Streams::strand_previous4>,
    StreamOf<&Streams::strand_points5>,  StreamOf<&Streams::strand_previous5>,
    StreamOf<&Streams::vertex_modal>,    StreamOf<&Streams::strand_modal4>,
    StreamOf<&Streams::strand_modal5>,   StreamOf<&Streams::strand_points9>,
    StreamOf<&Streams::strand_modal9>,   StreamOf<&Streams::curves>,
    StreamOf<&Streams::ribbons>,         StreamOf<&Streams::sort_keys>,
    StreamOf<&Streams::order>,           StreamOf<&Streams::instances>,
    StreamOf<&Streams::ribbon_vertices>, StreamOf<&Streams::line_vertices>};

// Compares `scene` after `frame` with a scene whose first frame it was.
void ExpectLikeAFirstFrame(Scenario& scenario, uint32_t frame, const FurScene& scene) {
  RunningScenario fresh(scenario, {});
  RunFrame(fresh, frame);
  for (const Stream stream : kRestarted)
    EXPECT_EQ(scene.DigestStream(stream), fresh.scene().DigestStream(stream))
        << DescribeStream(stream).name;
}

TEST(FurSceneRestart, TeleportedCharacterStartsFromItsGroom) {
  Scenario scenario = TinyScenario();
  const auto teleport = uint32_t(scenario.actors[0].teleport_frame);
  RunningScenario running(scenario, {});
  for (uint32_t f = 0; f <= teleport; ++f) {
    RunFrame(running, f);
    if (f + 1 == teleport) {
      EXPECT_EQ(CountChunks(running.scene(), kChunkRestart), 0u);
      EXPECT_EQ(CountPatches(running.scene(), kChunkRestart), 0u);
    }
  }
  EXPECT_EQ(CountChunks(running.scene(), kChunkRestart), running.scene().shape().chunk_count);
  EXPECT_EQ(CountPatches(running.scene(), kChunkRestart), running.scene().shape().patch_count);
  ExpectLikeAFirstFrame(scenario, teleport, running.scene());
}

TEST(FurSceneRestart, NewlyVisibleCharacterStartsFromItsGroom) {
  Scenario scenario = RestingScenario(~0u);
  RunningScenario running(scenario, {});
  FurScene& scene = running.scene();
  const auto run = [&](uint32_t frame, bool look_away) {
    FrameInput input = scenario.PrepareFrame(frame, scene);
    if (look_away)
      for (int a = 0; a < 3; ++a)
        input.camera.target[a] = 2.0f * input.camera.eye[a] - input.camera.target[a];
    RunInput(scene, input);
  };
  for (uint32_t f = 0; f < 5; ++f) run(f, false);
  EXPECT_GT(scene.DrawnStrands(), 0u);
  for (uint32_t f = 5; f < 9; ++f) run(f, true);
  EXPECT_EQ(scene.DrawnStrands(), 0u);
  EXPECT_EQ(scene.LiveStrands(), 0u);
  EXPECT_EQ(CountPatches(scene, 0, ~0u), scene.shape().patch_count);
  EXPECT_EQ(scene.memory().Of<&Streams::draw_list>(0)->count, 0u);
  run(9, false);
  ExpectLikeAFirstFrame(scenario, 9, scene);
}

// ---- Weather ------------------------------------------------------------------------------------

TEST(FurSceneWeather, WetAndDirtyChangeWhileRunningWithoutAReset) {
  Scenario wet_course = TinyScenario(), dry_course = TinyScenario();
  dry_course.weather_course = {};
  const uint32_t from = wet_course.weather_course.from_frame;
  RunningScenario wet(wet_course, {}), dry(dry_course, {});
  for (uint32_t f = 0; f < 20; ++f) {
    RunFrame(wet, f);
    RunFrame(dry, f);
    const bool same = wet.scene().DigestFrame() == dry.scene().DigestFrame();
    EXPECT_EQ(same, f < from) << "frame " << f;
    if (f > 0) {
      EXPECT_EQ(CountChunks(wet.scene(), kChunkRestart), 0u) << "frame " << f;
    }
    if (f == from) {
      // The first wet frame is a small step away from the dry one (towards the control strands,
      // which in this thin fur are decimetres away), not a jump.
      EXPECT_NE(wet.scene().DigestStream(StreamOf<&Streams::strand_points4>),
                dry.scene().DigestStream(StreamOf<&Streams::strand_points4>));
      for (uint32_t c = 0; c < wet.scene().shape().chunk_count; ++c) {
        const auto* a = wet.scene().memory().Of<&Streams::strand_points4>(c);
        const auto* b = dry.scene().memory().Of<&Streams::strand_points4>(c);
        if (!a) continue;
        for (uint32_t i = 0; i < wet.scene().LiveLanes(StreamOf<&Streams::strand_points4>, c); ++i)
          for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(a->position[2][axis][i], b->position[2][axis][i], 0.02f);
      }
    }
  }
}

// ---- Sleep --------------------------------------------------------------------------------------

// Runs until every visible chunk sleeps; the number of frames it took, or `most`.
struct SleepCourse {
  Scenario scenario = RestingScenario(6);
  RunningScenario running{scenario, {}};
  std::function<void(FrameInput&, FurScene&)> change = [](FrameInput&, FurScene&) {};
  uint32_t frame = 0;

  FurScene& scene() { return running.scene(); }
  void Run() {
    FrameInput input = scenario.PrepareFrame(frame++, scene());
    input.time_s = 0.0;
    change(input, scene());
    RunInput(scene(), input);
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

// Roots as deep as 5 cm under the ground, and hair that lies between skin and ground; with friction too.
TEST(FurSceneSleep, ASceneSunkInTheGroundSleepsToo) {
  for (const float friction : {0.0f, 0.4f}) {
    Scenario sunk = RestingScenario(6);
    SetModalFriction(sunk, friction);
    SleepCourse course{std::move(sunk)};
    course.change = [](FrameInput& input, FurScene&) { input.ground[3] = -0.05f; };
    EXPECT_TRUE(course.FallAsleep(kLongestToRest))
        << course.Awake() << " chunks still awake, friction " << friction;
    std::printf("friction %.1f: asleep after %u frames\n", friction, course.frame);
  }
}

TEST(FurSceneSleep, AStillSceneSleepsAndDoesNothing) {
  SleepCourse course;
  ASSERT_TRUE(course.FallAsleep(kLongestToRest)) << course.Awake() << " chunks still awake";
  EXPECT_EQ(CountAsleep(course.scene()), course.scene().shape().chunk_count);
  course.Run();
  course.Run();
  EXPECT_EQ(CountChunks(course.scene(), kChunkVisible,
                        kChunkSkin | kChunkSimulate | kChunkFit | kChunkKeys),
            course.scene().shape().chunk_count);
  EXPECT_EQ(CountPatches(course.scene(), kChunkVisible, kChunkSkin | kChunkSimulate | kChunkFit),
            course.scene().shape().patch_count);
  for (uint32_t l = 0; l < course.scene().shape().layer_count; ++l) {
    const auto& sort = *course.scene().memory().Of<&Streams::layer_sort>(l);
    EXPECT_EQ(sort.keys_changed | sort.records_changed, 0u);
    EXPECT_GT(sort.visible_count, 0u) << "it is still drawn, with last frame's vertices";
  }
}

TEST(FurSceneSleep, WhateverMovesWakesIt) {
  SleepCourse course;
  ASSERT_TRUE(course.FallAsleep(kLongestToRest));
  const uint32_t all = course.scene().shape().chunk_count;
  using Change = std::function<void(FrameInput&, FurScene&)>;
  // Each stays in force for the changes after it.
  const std::vector<std::pair<const char*, Change>> changes = {
      {"dt", [](FrameInput& in, FurScene&) { in.dt_s = 1.0 / 50.0; }},
      {"dt by an ulp",
       [](FrameInput& in, FurScene&) { in.dt_s = std::nextafter(float(in.dt_s), 1.0f); }},
      {"gravity", [](FrameInput& in, FurScene&) { in.gravity[1] = -9.0f; }},
      {"ground", [](FrameInput& in, FurScene&) { in.ground[3] = -0.01f; }},
      {"sphere", [](FrameInput& in, FurScene&) { in.sphere[0][3] += 0.01f; }},
      {"one sphere more",
       [](FrameInput& in, FurScene&) { in.sphere[in.sphere_count++][3] = 0.01f; }},
      {"a capsule",
       [](FrameInput& in, FurScene&) { in.capsule[in.capsule_count++].radius = 0.01f; }},
      {"capsule", [](FrameInput& in, FurScene&) { in.capsule[0].to[1] = 0.2f; }},
      {"capsule bound", [](FrameInput& in, FurScene&) { in.capsule[0].joint = 2; }},
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
    EXPECT_EQ(CountPatches(course.scene(), kChunkVisible | kChunkSimulate),
              course.scene().shape().patch_count)
        << name;
    ASSERT_TRUE(course.FallAsleep(kLongestToRest)) << name;
  }
  // Wind: only layers that answer to it wake, and they stay awake while it blows.
  in_force.push_back([](FrameInput& in, FurScene&) { in.wind.velocity[0] = 1.0f; });
  course.Run();
  for (uint32_t c = 0; c < all; ++c) {
    const auto& state = *course.scene().memory().Of<&Streams::chunk_state>(c);
    const uint32_t layer = course.scene().shape().chunk_layer[c];
    const uint32_t flags = course.scene().memory().Of<&Streams::layers>(layer)->flags;
    EXPECT_EQ((state.flags & kChunkSimulate) != 0, (flags & kLayerWind) != 0) << c;
  }
  EXPECT_GT(course.Awake(), 0u);
}

bool IsMovedBy(const uint32_t (&joint_mask)[kJointsPerCharacter / 32], uint32_t joint) {
  return joint_mask[joint / 32] >> joint % 32 & 1u;
}

// A joint without another below it, that moves as few patches as any but some; ~0: there is none.
uint32_t FindJointOfFewPatches(const FurScene& scene) {
  const auto& parent = scene.memory().Of<&Streams::skeleton>(0)->parent;
  uint32_t found = ~0u, least = ~0u;
  for (uint32_t j = 0; j < kJointsPerCharacter; ++j) {
    if (std::find(std::begin(parent), std::end(parent), int32_t(j)) != std::end(parent)) continue;
    uint32_t patches = 0;
    for (uint32_t p = 0; p < scene.shape().patch_count; ++p)
      patches += IsMovedBy(scene.memory().Of<&Streams::patches>(p)->joint_mask, j);
    if (patches > 0 && patches < least) {
      found = j;
      least = patches;
    }
  }
  return found;
}

// Of the layer's patches those wake that the joint moves, and its chunks with one of these; the
// others sleep on, with the bits of a scene where none sleeps.
TEST(FurSceneSleep, PatchesThatNoJointMovesSleepOnWithTheChunksThatListNoOther) {
  SleepCourse lazy{PatchedScenario()}, eager{PatchedScenario()};
  const FurScene& scene = lazy.scene();
  ASSERT_EQ(scene.shape().layer_count, 1u);
  const uint32_t joint = FindJointOfFewPatches(scene);
  ASSERT_NE(joint, ~0u);
  float shift = 0.0f;
  const auto move = [&](FurScene& moved) { moved.Pose(0).translation_key[0][1][joint] += shift; };
  lazy.change = [&](FrameInput&, FurScene& moved) { move(moved); };
  eager.change = [&](FrameInput& input, FurScene& moved) {
    input.skip.sleep = false;
    move(moved);
  };
  const auto run = [&] {
    lazy.Run();
    eager.Run();
    ASSERT_EQ(lazy.scene().DigestFrame(), eager.scene().DigestFrame())
        << "frame " << lazy.frame - 1;
  };
  const auto fall_asleep = [&] {
    for (uint32_t i = 0; i < kLongestToRest && !::testing::Test::HasFatalFailure(); ++i) {
      run();
      if (lazy.Awake() == 0) return true;
    }
    return false;
  };
  ASSERT_TRUE(fall_asleep()) << lazy.Awake() << " chunks still awake";

  shift = 0.005f;
  run();
  const FrameMemory& memory = scene.memory();
  const auto is_awake = [](const ChunkStateBlock& state) {
    return (state.flags & kChunkSimulate) != 0;
  };
  uint32_t awake = 0;
  for (uint32_t p = 0; p < scene.shape().patch_count; ++p) {
    const bool reached = IsMovedBy(memory.Of<&Streams::patches>(p)->joint_mask, joint);
    EXPECT_EQ(is_awake(*memory.Of<&Streams::patch_state>(p)), reached) << "patch " << p;
    awake += reached;
  }
  EXPECT_GT(awake, 0u);
  EXPECT_LT(awake, scene.shape().patch_count);
  awake = 0;
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    const auto& list = memory.Of<&Streams::patch_list>(c)->patch;
    ASSERT_EQ(list[kListedPatches], ~0u);
    bool lists_one = false;
    for (const uint32_t patch : list)
      if (patch != ~0u) lists_one |= is_awake(*memory.Of<&Streams::patch_state>(patch));
    EXPECT_EQ(is_awake(*memory.Of<&Streams::chunk_state>(c)), lists_one) << "chunk " << c;
    awake += lists_one;
  }
  EXPECT_GT(awake, 0u);
  EXPECT_LT(awake, scene.shape().chunk_count) << "every chunk lists a patch that is awake";

  for (uint32_t f = 0; f < 20; ++f) {
    shift = 0.005f * float(f % 3);
    run();
    EXPECT_LT(CountPatches(scene, kChunkSimulate), scene.shape().patch_count) << f;
  }
  shift = 0.0f;
  EXPECT_TRUE(fall_asleep()) << lazy.Awake() << " chunks still awake";
}

TEST(FurSceneSleep, ATurnedCameraSortsAgainAndWakesNobody) {
  SleepCourse course;
  ASSERT_TRUE(course.FallAsleep(kLongestToRest));
  course.change = [](FrameInput& in, FurScene&) { in.camera.eye[0] += 0.3f; };
  course.Run();
  EXPECT_EQ(course.Awake(), 0u);
  EXPECT_EQ(CountPatches(course.scene(), kChunkSimulate), 0u);
  EXPECT_EQ(CountChunks(course.scene(), kChunkKeys), course.scene().shape().chunk_count);
}

// ---- Skips --------------------------------------------------------------------------------------

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
  const auto with_all = RunDigests(scenario, {}, frames);
  for (const SkipCase& c : kSkips) {
    SkipSettings skip;
    skip.*(c.which) = false;
    ExpectSameFrames(with_all, RunDigests(scenario, {}, frames, skip),
                     std::string("without ") + c.name);
  }
  ExpectSameFrames(with_all, RunDigests(scenario, {}, frames, kNoSkips), "without any");
}

TEST(FurSceneSkips, ChangeNothingInMotion) { ExpectSkipsChangeNothing(TinyScenario(), 24); }
// The course of the sleep tests: into sleep and a while of it.
TEST(FurSceneSkips, ChangeNothingComingToRest) {
  ExpectSkipsChangeNothing(RestingScenario(6), 240);
}
// And out of it: rests from frame 6, walks on where its clock stands.
TEST(FurSceneSkips, ChangeNothingWhenItMovesAgain) {
  Scenario scenario = RestingScenario(6);
  const auto run = [&](const SkipSettings& skip) {
    std::vector<uint64_t> digests;
    Scenario course = scenario;
    RunningScenario running(course, {});
    for (uint32_t f = 0; f < 140; ++f) {
      course.rest_from_frame = f < 120 ? 6 : ~0u;
      RunFrame(running, f, skip, {});
      digests.push_back(running.scene().DigestFrame());
    }
    return digests;
  };
  ExpectSameFrames(run({}), run(kNoSkips), "without any");
}

}  // namespace
}  // namespace pelt::testing
