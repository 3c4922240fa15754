// Each check of a verification finds the fault that it is there for, says what kind of fault it is,
// and passes the healthy scene.
//
// Faults are planted in the plan of a case: a kernel is replaced by a twin that is wrong in one
// way. The reference is never touched.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "bench/verify/guarded_executor.hpp"
#include "bench/verify/odd_floats.hpp"
#include "bench/verify/verified_scene.hpp"
#include "bench/verify/verify.hpp"
#include "bench/verify/view_test.hpp"
#include "core/kernels/activate.hpp"
#include "core/kernels/collect_changes.hpp"
#include "core/kernels/select_lod.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

const Scenario& Tiny() {
  static const Scenario kTiny = LoadScenario("tiny");
  return kTiny;
}

// ---- Planting
// ------------------------------------------------------------------------------------

// The kernel that a twin stands in for, and where its ports are.
struct Twin {
  void (*run)(const void*, const Binding*) = nullptr;
  std::span<const PortDesc> ports;
  std::byte* kept = nullptr;  // what a faulty twin remembers

  template <class T>
  T* As(const Binding* bindings, Stream stream) const {
    for (size_t p = 0; p < ports.size(); ++p)
      if (ports[p].stream == stream) return static_cast<T*>(bindings[p].block);
    return nullptr;
  }
};
Twin twin;

using Planted = void (*)(const void*, const Binding*);

void Plant(Plan& plan, std::string_view stage, Planted planted) {
  for (Stage& s : plan.stages) {
    if (s.kernel.name != stage) continue;
    twin = {s.kernel.run, s.kernel.ports, nullptr};
    s.kernel.run = planted;
    return;
  }
  FAIL() << "no stage " << stage;
}

std::function<void(const VerifyCase&, Plan&)> Planting(std::string_view stage, Planted planted) {
  return [=](const VerifyCase&, Plan& plan) { Plant(plan, stage, planted); };
}

// Hides the address from the compiler: the twins go where the language does not let them.
template <class T>
T* Launder(T* p) {
  asm volatile("" : "+r"(p));
  return p;
}

VerifyOptions NoCases(uint32_t frames) {
  VerifyOptions options;
  options.frames = frames;
  options.skips = options.checks = false;
  options.filter = [](const VerifyCase&) { return false; };
  return options;
}

VerifyOptions OneExecutor(ExecutorKind executor, uint32_t frames) {
  VerifyOptions options = NoCases(frames);
  options.filter = [executor](const VerifyCase& c) {
    return c.executor == executor && c.isa == BestIsa() && c.fuse && !c.piecewise_sort &&
           c.vertex_order == VertexOrder::kSorted && c.settings == Settings::kSkips &&
           !c.odd_floats;
  };
  return options;
}

// The case behind those that compare vertex orders.
CaseResult RunOne(const VerifyOptions& options) { return Verify(Tiny(), options).cases.back(); }

std::vector<CheckResult> ChecksOf(const VerifyReport& report, std::string_view section) {
  std::vector<CheckResult> found;
  for (const CheckResult& c : report.checks)
    if (c.section == section) found.push_back(c);
  return found;
}

bool AnyFailed(const std::vector<CheckResult>& checks, FindingKind kind, std::string_view name) {
  return std::any_of(checks.begin(), checks.end(), [&](const CheckResult& c) {
    return !c.passed && c.kind == kind && c.name.find(name) != std::string::npos;
  });
}

// ---- The scene
// -----------------------------------------------------------------------------------

TEST(VerifiedScene, HasTwoCharactersThatDiffer) {
  const Scenario verified = MakeVerifiedScene(Tiny());
  ASSERT_EQ(verified.actors.size(), 2u);
  const Groom& first = verified.grooms[verified.actors[0].groom];
  const Groom& second = verified.grooms[verified.actors[1].groom];
  EXPECT_NE(first.layers.size(), second.layers.size());
  EXPECT_NE(first.layers[0].params.solver, second.layers[0].params.solver);
  EXPECT_NE(std::memcmp(&first.skeleton, &second.skeleton, sizeof first.skeleton), 0);
  EXPECT_NE(verified.actors[0].weather_share, verified.actors[1].weather_share);
  EXPECT_EQ(Tiny().actors.size(), 1u) << "the scene itself stays what it is";
}

// ---- Undeclared access
// ---------------------------------------------------------------------------

TEST(VerifyAccess, AReadOfANeighbourWhoseValueNeverMattersIsFound) {
  if (!GuardedExecutor::IsAvailable()) GTEST_SKIP() << "no pages to close";
  VerifyOptions options = OneExecutor(ExecutorKind::kGuarded, 2);
  options.tamper = Planting("roots", [](const void* params, const Binding* bindings) {
    twin.run(params, bindings);
    const auto* next = Launder(twin.As<const StrandBlock>(bindings, Stream::kStrands)) + 1;
    if (*Launder(next->length) > 1000.0f)
      twin.As<RootBlock>(bindings, Stream::kRoots)->position[0][0] = 0.0f;
  });
  const CaseResult result = RunOne(options);
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(result.kind, FindingKind::kUndeclaredRead) << result.reason;
  EXPECT_EQ(result.stage, "roots");
  EXPECT_EQ(result.stream, "strands");
  // The other executors cannot see it: no value depends on it.
  options.filter = OneExecutor(ExecutorKind::kLocalStore, 2).filter;
  EXPECT_TRUE(RunOne(options).passed);
}

TEST(VerifyAccess, AReadOfAnotherCharacterIsFoundAndNamed) {
  VerifyOptions options = OneExecutor(ExecutorKind::kSerial, 2);
  options.tamper = Planting("skin", [](const void* params, const Binding* bindings) {
    twin.run(params, bindings);
    // One character on: in a scene of one there is nothing there but another stream.
    const auto* next = Launder(twin.As<const PaletteBlock>(bindings, Stream::kPalette)) + 1;
    twin.As<SkinnedBlock>(bindings, Stream::kSkinned)->vertex[0].position[0] +=
        Launder(next->matrix[0])[3];
  });
  const CaseResult result = RunOne(options);
  EXPECT_FALSE(result.passed);
  if (!GuardedExecutor::IsAvailable()) return;
  EXPECT_EQ(result.kind, FindingKind::kUndeclaredRead) << result.reason;
  EXPECT_EQ(result.stage, "skin");
}

TEST(VerifyAccess, APointerKeptFromTheLastItemIsFound) {
  if (!GuardedExecutor::IsAvailable()) GTEST_SKIP() << "no pages to close";
  VerifyOptions options = OneExecutor(ExecutorKind::kGuarded, 2);
  options.tamper = Planting("skin", [](const void* params, const Binding* bindings) {
    twin.run(params, bindings);
    auto* mesh = twin.As<std::byte>(bindings, Stream::kMesh);
    if (twin.kept && *Launder(twin.kept) == std::byte{77})
      twin.As<SkinnedBlock>(bindings, Stream::kSkinned)->vertex[0].position[0] = 0.0f;
    twin.kept = mesh;
  });
  const CaseResult result = RunOne(options);
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(result.stage, "skin");
  EXPECT_TRUE(result.kind == FindingKind::kUndeclaredRead) << result.reason;
}

TEST(VerifyAccess, AWriteOfTheSameValuePastTheEndIsFound) {
  if (!GuardedExecutor::IsAvailable()) GTEST_SKIP() << "no pages to close";
  VerifyOptions options = OneExecutor(ExecutorKind::kGuarded, 2);
  options.tamper = Planting("fit_cubic_4", [](const void* params, const Binding* bindings) {
    twin.run(params, bindings);
    auto* behind =
        reinterpret_cast<std::byte*>(Launder(twin.As<CurveBlock>(bindings, Stream::kCurves)) + 1);
    *Launder(behind) = *Launder(behind);
  });
  const CaseResult result = RunOne(options);
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(result.stage, "fit_cubic_4");
  EXPECT_EQ(result.stream, "curves") << result.reason;
}

TEST(VerifyAccess, AWriteInFrontOfTheBlockAndOneThroughAReadOnlyPortAreFound) {
  if (!GuardedExecutor::IsAvailable()) GTEST_SKIP() << "no pages to close";
  VerifyOptions options = OneExecutor(ExecutorKind::kGuarded, 2);
  options.tamper = Planting("roots", [](const void* params, const Binding* bindings) {
    twin.run(params, bindings);
    Launder(reinterpret_cast<uint32_t*>(twin.As<RootBlock>(bindings, Stream::kRoots)))[-1] = 0;
  });
  CaseResult result = RunOne(options);
  EXPECT_EQ(result.kind, FindingKind::kUndeclaredWrite) << result.reason;
  options.tamper = Planting("roots", [](const void* params, const Binding* bindings) {
    twin.run(params, bindings);
    auto* length =
        const_cast<float*>(Launder(twin.As<const StrandBlock>(bindings, Stream::kStrands))->length);
    *Launder(length) = *Launder(length);  // the same value: no comparison shows it
  });
  result = RunOne(options);
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(result.stream, "strands") << result.reason;
  EXPECT_NE(result.reason.find("read-only port 'strands'"), std::string::npos) << result.reason;
}

TEST(VerifyAccess, StaticStateIsFound) {
  if (!GuardedExecutor::IsAvailable()) GTEST_SKIP() << "no pages to close";
  VerifyOptions options = OneExecutor(ExecutorKind::kGuarded, 2);
  static uint32_t runs;
  runs = 0;
  options.tamper = Planting("sample_pose", [](const void* params, const Binding* bindings) {
    twin.run(params, bindings);
    twin.As<LocalPoseBlock>(bindings, Stream::kLocalPose)->translation[0][0] += float(runs++);
  });
  const CaseResult result = RunOne(options);
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(result.kind, FindingKind::kHiddenState) << result.reason;
  EXPECT_EQ(result.stage, "sample_pose");
}

// A port declared Out that the kernel reads. Sort keys: what it finds there decides only whether
// the layer is sorted again, so every value stays right, however it is poisoned.
void DeclareOut(Plan& plan, std::string_view stage, Stream stream) {
  static std::vector<PortDesc> ports;
  for (Stage& s : plan.stages) {
    if (s.kernel.name != stage) continue;
    ports.assign(s.kernel.ports.begin(), s.kernel.ports.end());
    for (PortDesc& port : ports)
      if (port.stream == stream) port.access = Access::kOut;
    s.kernel.ports = ports;
  }
}

void ExpectReadsOutFound(std::string_view stage, Stream stream) {
  VerifyOptions options = NoCases(6);
  options.checks = true;
  options.sections = {"access"};
  options.tamper = [&](const VerifyCase&, Plan& plan) { DeclareOut(plan, stage, stream); };
  const VerifyReport report = Verify(Tiny(), options);
  const auto checks = ChecksOf(report, "access");
  ASSERT_TRUE(AnyFailed(checks, FindingKind::kReadsOut, "at rest")) << DescribeReport(report);
  const auto failed = std::find_if(checks.begin(), checks.end(), [](const CheckResult& c) {
    return c.kind == FindingKind::kReadsOut;
  });
  EXPECT_EQ(failed->stage, stage);
  EXPECT_EQ(failed->stream, DescribeStream(stream).name);
}

TEST(VerifyAccess, SortKeysDeclaredOutAreFound) {
  if (!GuardedExecutor::IsAvailable()) GTEST_SKIP() << "no pages to close";
  ExpectReadsOutFound("sort_key4", Stream::kSortKeys);
}

TEST(VerifyAccess, ActivatesStateDeclaredOutIsFound) {
  if (!GuardedExecutor::IsAvailable()) GTEST_SKIP() << "no pages to close";
  ExpectReadsOutFound("activate", Stream::kChunkState);
}

VerifyReport RunAccessAtRest(std::function<void(const VerifyCase&, Plan&)> tamper) {
  VerifyOptions options = NoCases(6);
  options.checks = true;
  options.sections = {"access"};
  options.tamper = std::move(tamper);
  return Verify(Tiny(), options);
}

TEST(VerifyAccess, HealthyScenePassesAtRest) {
  const VerifyReport report = RunAccessAtRest({});
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
}

// Lanes that do not live, of the last group that is worked on, read vertices that nobody skins.
void ActivateWithoutTheLastLaneGroup(const void* params, const Binding* bindings) {
  twin.run(params, bindings);
  auto& state = *twin.As<ChunkStateBlock>(bindings, Stream::kChunkState);
  const auto& strands = *twin.As<const StrandBlock>(bindings, Stream::kStrands);
  if (state.live_strands > 0)
    state.live_vertices = strands.vertex_prefix[state.live_strands - 1] + 1u;
}

TEST(VerifyAccess, VerticesOfTheLastLaneGroupLeftOutAreFound) {
  const VerifyReport report =
      RunAccessAtRest(Planting("activate", ActivateWithoutTheLastLaneGroup));
  EXPECT_TRUE(AnyFailed(ChecksOf(report, "access"), FindingKind::kReadsOut, "whole lane groups"));
}

// ---- Waking
// --------------------------------------------------------------------------------------

// The plan's `activate` with one of its parameters switched off.
uint32_t ActivateParams::*hidden_param;
void ActivateWithout(const void* params, const Binding* bindings) {
  auto hiding = *static_cast<const ActivateParams*>(params);
  hiding.*hidden_param = 0;
  twin.run(&hiding, bindings);
}

VerifyReport RunWaking(std::function<void(const VerifyCase&, Plan&)> tamper) {
  VerifyOptions options = NoCases(12);
  options.checks = true;
  options.sections = {"waking"};
  options.tamper = std::move(tamper);
  return Verify(Tiny(), options);
}

TEST(VerifyWaking, HealthyScenePassesAndSomethingWakes) {
  const VerifyReport report = RunWaking({});
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
  const auto checks = ChecksOf(report, "waking");
  // Some chunk sleeps, or nothing was proven; and every kind of input wakes one.
  EXPECT_GT(checks.front().seen, 10u) << "asleep";
  const auto woke = [&](std::string_view name) {
    return std::any_of(checks.begin(), checks.end(), [&](const CheckResult& c) {
      return c.name == name && c.compared && c.seen > 0 && c.felt;
    });
  };
  for (const char* name :
       {"dt_s, less than a float's ulp", "dt_s, a lot", "gravity[1], one ulp", "sphere 1[0], a lot",
        "sphere 1[3], a lot", "wetness of character 0, one ulp", "wetness of character 1, a lot",
        "wind.velocity[0], a lot", "ground[3], a lot", "use_ground",
        "pose of character 0, root[0], one ulp", "character 0 teleported",
        "a sphere more, around sphere 1", "a sphere less"})
    EXPECT_TRUE(woke(name)) << name;
  // What blows already keeps awake, and what moves the eye wakes no chain.
  for (const char* name : {"wind that blew already", "eye and target[0]", "eye and target[1]"})
    EXPECT_TRUE(std::any_of(checks.begin(), checks.end(), [&](const CheckResult& c) {
      return c.name == name && c.compared && c.felt;
    })) << name;
  EXPECT_TRUE(std::any_of(checks.begin(), checks.end(), [](const CheckResult& c) {
    return c.name.starts_with("sphere ") && c.name.ends_with("one ulp") && c.felt;
  }));
  // Every number of the input is there, and what is not compared says why.
  EXPECT_GT(checks.size(), 200u);
  for (const CheckResult& c : checks) EXPECT_TRUE(c.compared) << c.name << ": " << c.reason;
}

TEST(VerifyWaking, FrameInputsHiddenFromSleepersAreFound) {
  hidden_param = &ActivateParams::frame_inputs_changed;
  const VerifyReport report = RunWaking(Planting("activate", ActivateWithout));
  const auto checks = ChecksOf(report, "waking");
  // dt reaches a chunk through its layer too: what hides it alone is below.
  for (const char* name : {"sphere 1[0], a lot", "sphere 1[3], a lot", "ground[3], a lot",
                           "use_ground", "a sphere more", "a sphere less"})
    EXPECT_TRUE(AnyFailed(checks, FindingKind::kSleep, name)) << name;
}

TEST(VerifyWaking, ATurnedCameraHiddenFromSleepersIsFound) {
  hidden_param = &ActivateParams::view_changed;
  const VerifyReport report = RunWaking(Planting("activate", ActivateWithout));
  EXPECT_TRUE(AnyFailed(ChecksOf(report, "waking"), FindingKind::kSleep, "camera.position[0]"));
}

// Weather and the modal solver's course tables reach a chunk through its layer's `changed`.
void ActivateUnchangedLayers(const void* params, const Binding* bindings) {
  Binding hiding[kMaxPorts];
  std::copy_n(bindings, twin.ports.size(), hiding);
  LayerBlock layer = *twin.As<const LayerBlock>(bindings, Stream::kLayers);
  layer.changed = 0;
  for (size_t p = 0; p < twin.ports.size(); ++p)
    if (twin.ports[p].stream == Stream::kLayers) hiding[p].block = &layer;
  twin.run(params, hiding);
}

TEST(VerifyWaking, ChangedLayersHiddenFromSleepersAreFound) {
  const VerifyReport report = RunWaking(Planting("activate", ActivateUnchangedLayers));
  const auto checks = ChecksOf(report, "waking");
  EXPECT_TRUE(AnyFailed(checks, FindingKind::kSleep, "wetness of character 0, a lot"));
  EXPECT_TRUE(AnyFailed(checks, FindingKind::kSleep, "dt_s, less than a float's ulp"))
      << "of the modal tables alone";
}

// Wind has nobody awake: only its beginning and its end, which change the layer's flags.
void ActivateWithoutWind(const void* params, const Binding* bindings) {
  Binding hiding[kMaxPorts];
  std::copy_n(bindings, twin.ports.size(), hiding);
  LayerBlock layer = *twin.As<const LayerBlock>(bindings, Stream::kLayers);
  layer.flags &= ~uint32_t(kLayerWind);
  for (size_t p = 0; p < twin.ports.size(); ++p)
    if (twin.ports[p].stream == Stream::kLayers) hiding[p].block = &layer;
  twin.run(params, hiding);
}

TEST(VerifyWaking, WindThatBlewAlreadyAndChangesHiddenFromSleepersIsFound) {
  const VerifyReport report = RunWaking(Planting("activate", ActivateWithoutWind));
  EXPECT_TRUE(AnyFailed(ChecksOf(report, "waking"), FindingKind::kSleep, "wind that blew already"));
}

// Vertices are written again only when a key or a record changed.
void CollectWithoutTheEye(const void* params, const Binding* bindings) {
  auto hiding = *static_cast<const CollectChangesParams*>(params);
  hiding.view_changed = 0;
  twin.run(&hiding, bindings);
}

TEST(VerifyWaking, RibbonsThatDoNotTurnToAnEyeThatMovesAcrossAreFound) {
  const VerifyReport report = RunWaking(Planting("collect_changes", CollectWithoutTheEye));
  EXPECT_TRUE(AnyFailed(ChecksOf(report, "waking"), FindingKind::kSleep, "eye and target["));
}

// A joint that moves and does not say so.
uint32_t still_joint;
void PaletteWithAStillJoint(const void* params, const Binding* bindings) {
  twin.run(params, bindings);
  auto& palette = *twin.As<PaletteBlock>(bindings, Stream::kPalette);
  palette.moved[still_joint / 32] &= ~(1u << still_joint % 32);
}

TEST(VerifyWaking, AJointThatNeverMovesIsFound) {
  still_joint = 7;
  const VerifyReport report = RunWaking(Planting("joint_palette", PaletteWithAStillJoint));
  EXPECT_TRUE(AnyFailed(ChecksOf(report, "waking"), FindingKind::kSleep, "joint 7"));
}

// Joints that moved by less than a millionth did not move.
void PaletteWithThreshold(const void* params, const Binding* bindings) {
  auto& palette = *twin.As<PaletteBlock>(bindings, Stream::kPalette);
  const PaletteBlock before = palette;
  twin.run(params, bindings);
  for (uint32_t j = 0; j < kJointsPerCharacter; ++j) {
    float most = 0.0f;
    for (int i = 0; i < 12; ++i)
      most = std::max(most, std::abs(palette.matrix[j][i] - before.matrix[j][i]));
    if (most < 1e-6f) palette.moved[j / 32] &= ~(1u << j % 32);
  }
}

TEST(VerifyWaking, PosesThatChangeByLessThanAMillionthAreFound) {
  const VerifyReport report = RunWaking(Planting("joint_palette", PaletteWithThreshold));
  EXPECT_TRUE(AnyFailed(ChecksOf(report, "waking"), FindingKind::kSleep, "one ulp"));
}

// ---- Culling
// -------------------------------------------------------------------------------------

VerifyReport RunCulling(std::function<void(const VerifyCase&, Plan&)> tamper) {
  VerifyOptions options = NoCases(6);
  options.checks = true;
  options.sections = {"culling"};
  options.tamper = std::move(tamper);
  return Verify(Tiny(), options);
}

TEST(VerifyCulling, HealthyScenePassesWithLayersThatLeaveAndReturn) {
  const VerifyReport report = RunCulling({});
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
  for (const CheckResult& c : ChecksOf(report, "culling")) {
    EXPECT_TRUE(c.compared) << c.name << ": " << c.reason;
    EXPECT_GT(c.seen, 0u) << c.name;
  }
}

void CullEverything(const void* params, const Binding* bindings) {
  auto wrong = *static_cast<const SelectLodParams*>(params);
  for (auto& plane : wrong.view.planes)
    for (float& x : plane) x = -x;
  twin.run(&wrong, bindings);
}
void CullAtTheMiddle(const void* params, const Binding* bindings) {
  auto wrong = *static_cast<const SelectLodParams*>(params);
  // The left plane through the middle of the picture: half of what is seen is lost.
  for (int i = 0; i < 3; ++i)
    wrong.view.planes[0][i] = wrong.view.planes[0][i] - wrong.view.planes[1][i];
  wrong.view.planes[0][3] = wrong.view.planes[0][3] - wrong.view.planes[1][3];
  twin.run(&wrong, bindings);
}

TEST(VerifyCulling, APlaneTestThatCullsTooMuchIsFound) {
  for (const Planted planted : {CullEverything, CullAtTheMiddle}) {
    const VerifyReport report = RunCulling(Planting("select_lod", planted));
    const auto checks = ChecksOf(report, "culling");
    EXPECT_TRUE(AnyFailed(checks, FindingKind::kCull, "no layer in view"))
        << DescribeReport(report);
  }
}

// A layer that returns goes on from where it left instead of starting from its groom.
void ActivateWithoutRestart(const void* params, const Binding* bindings) {
  twin.run(params, bindings);
  auto& state = *twin.As<ChunkStateBlock>(bindings, Stream::kChunkState);
  state.flags &= ~uint32_t(kChunkRestart);
  state.first_new_strand = state.live_strands;
  state.first_new_vertex = state.live_vertices;
}

TEST(VerifyCulling, ALayerThatReturnsWithoutARestartIsFound) {
  const VerifyReport report = RunCulling(Planting("activate", ActivateWithoutRestart));
  EXPECT_TRUE(AnyFailed(ChecksOf(report, "culling"), FindingKind::kCull, "return"))
      << DescribeReport(report);
}

// Only the flag that says so: all lanes are new in any case.
void ActivateWithoutTheRestartFlag(const void* params, const Binding* bindings) {
  twin.run(params, bindings);
  twin.As<ChunkStateBlock>(bindings, Stream::kChunkState)->flags &= ~uint32_t(kChunkRestart);
}

TEST(VerifyCulling, ALayerThatReturnsAndDoesNotSayThatItRestartsIsFound) {
  const VerifyReport report = RunCulling(Planting("activate", ActivateWithoutTheRestartFlag));
  EXPECT_TRUE(AnyFailed(ChecksOf(report, "culling"), FindingKind::kCull, "return"))
      << DescribeReport(report);
}

// Keys that are those of the last time in view are reported as unchanged.
void KeysWithoutTheRestart(const void* params, const Binding* bindings) {
  const SortKeyBlock before = *twin.As<const SortKeyBlock>(bindings, Stream::kSortKeys);
  twin.run(params, bindings);
  const auto& keys = *twin.As<const SortKeyBlock>(bindings, Stream::kSortKeys);
  if (std::memcmp(&before, &keys, sizeof keys) == 0)
    twin.As<ChunkStateBlock>(bindings, Stream::kChunkState)->keys_changed = 0;
}

TEST(VerifyCulling, AnUnchangedKeyThatIsNotReportedAfterAReturnIsFound) {
  const VerifyReport report = RunCulling(Planting("sort_key4", KeysWithoutTheRestart));
  EXPECT_TRUE(AnyFailed(ChecksOf(report, "culling"), FindingKind::kCull, "the same picture"))
      << DescribeReport(report);
}

// The box of the skin, on its low or its high side.
bool skin_low;
void BoundOfTheSkin(const void* params, const Binding* bindings) {
  twin.run(params, bindings);
  const float margin = twin.As<const LayerBlock>(bindings, Stream::kLayers)->length_max;
  auto& bounds = *twin.As<BoundsBlock>(bindings, Stream::kBounds);
  for (int axis = 0; axis < 3; ++axis)
    (skin_low ? bounds.low : bounds.high)[axis] += skin_low ? margin : -margin;
}

TEST(VerifyCulling, ABoxWithoutTheFursLengthIsFound) {
  for (const bool low : {true, false}) {
    skin_low = low;
    const VerifyReport report = RunCulling(Planting("bound_layer", BoundOfTheSkin));
    EXPECT_TRUE(AnyFailed(ChecksOf(report, "culling"), FindingKind::kCull, "tips"))
        << DescribeReport(report);
  }
}

TEST(ViewTest, SeesWhatStandsBeforeTheCamera) {
  Camera camera;  // at (0, 1, 3), towards (0, 1, 0)
  camera.near_m = 0.5f;
  camera.far_m = 10.0f;
  const ViewTest view(camera);
  EXPECT_TRUE(view.IsClearlyInside({0.0f, 1.0f, 0.0f}));
  EXPECT_FALSE(view.IsClearlyInside({0.0f, 1.0f, 2.9f})) << "nearer than near";
  EXPECT_FALSE(view.IsClearlyInside({0.0f, 1.0f, -8.0f})) << "beyond far";
  EXPECT_FALSE(view.IsClearlyInside({0.0f, 1.0f, 4.0f})) << "behind";
  EXPECT_FALSE(view.IsClearlyInside({3.5f, 1.0f, 0.0f}));
  EXPECT_FALSE(view.IsClearlyInside({-3.5f, 1.0f, 0.0f}));
  EXPECT_FALSE(view.IsClearlyInside({0.0f, 3.0f, 0.0f}));
  EXPECT_FALSE(view.IsClearlyInside({0.0f, -1.0f, 0.0f}));
  EXPECT_TRUE(view.IsClearlyInside({2.0f, 1.0f, 0.0f})) << "wider than high";
}

// ---- Digests
// -------------------------------------------------------------------------------------

VerifyReport RunDigests(std::function<uint64_t(const FurScene&, Stream)> digest_stream) {
  VerifyOptions options = NoCases(6);
  options.checks = true;
  options.sections = {"digest"};
  options.digest_stream = std::move(digest_stream);
  return Verify(Tiny(), options);
}

TEST(VerifyDigests, HealthyDigestsSeeEverything) {
  const VerifyReport report = RunDigests({});
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
  uint32_t values = 0;
  for (uint32_t s = 0; s < kStreamCount; ++s)
    values += DescribeStream(Stream(s)).role == Role::kValue;
  // Every value stream with the sorted vertices; all but instances without.
  const auto checks = ChecksOf(report, "digest");
  EXPECT_EQ(checks.size(), 2 + 2 * values - 1);
  for (const CheckResult& c : checks) EXPECT_GT(c.seen, 0u) << c.name;
}

TEST(VerifyDigests, AStreamLeftOutIsFound) {
  const VerifyReport report = RunDigests([](const FurScene& scene, Stream stream) {
    return stream == Stream::kInstances ? 0 : scene.DigestStream(stream);
  });
  const auto checks = ChecksOf(report, "digest");
  EXPECT_TRUE(AnyFailed(checks, FindingKind::kDigest, "stream instances"));
  EXPECT_FALSE(AnyFailed(checks, FindingKind::kDigest, "stream curves"));
}

TEST(VerifyDigests, AnItemOrALaneLeftOutIsFound) {
  const auto without = [](bool lane) {
    return [lane](const FurScene& scene, Stream stream) {
      if (stream != Stream::kRoots) return scene.DigestStream(stream);
      Digest digest;
      const uint32_t items = scene.shape().chunk_count;
      for (uint32_t c = 0; c < (lane ? items : items - 1); ++c)
        AddBlock(digest, DescribeStream(stream), scene.memory().Block(stream, c),
                 scene.LiveLanes(stream, c) - (lane ? 1 : 0));
      return digest.Value();
    };
  };
  for (const bool lane : {false, true}) {
    const VerifyReport report = RunDigests(without(lane));
    EXPECT_TRUE(AnyFailed(ChecksOf(report, "digest"), FindingKind::kDigest, "stream roots"))
        << (lane ? "lane" : "item");
  }
}

// A sum of its words: what a digest must not be.
TEST(VerifyDigests, ADigestThatDoesNotKnowOrderIsFound) {
  const VerifyReport report = RunDigests([](const FurScene& scene, Stream stream) {
    const StreamDesc& desc = DescribeStream(stream);
    uint64_t sum = 0;
    for (uint32_t i = 0; i < scene.shape().ItemCount(desc.domain); ++i) {
      const std::byte* block = scene.memory().Block(stream, i);
      if (!block) continue;
      const uint32_t live = scene.LiveLanes(stream, desc.domain == Domain::kChunk ? i : 0);
      for (const RowDesc& row : desc.rows)
        for (uint32_t e = 0; e < row.element_count; ++e) {
          const uint32_t lane =
              row.lane_major ? e / (row.element_count / row.lane_count) : e % row.lane_count;
          if (desc.lanes != Lanes::kAll && lane >= live) continue;
          Digest word;
          word.Add(RowElement(block, row, e));
          sum += word.Value();
        }
    }
    return sum;
  });
  const auto checks = ChecksOf(report, "digest");
  for (const char* stream : {"stream roots", "stream curves", "stream sort_keys"})
    EXPECT_TRUE(AnyFailed(checks, FindingKind::kDigest, stream)) << stream;
}

// ---- Floats
// --------------------------------------------------------------------------------------

// A worker that flushes denormals while this stage runs, as an engine's thread might.
#if defined(__SSE__)
void RunFlushing(const void* params, const Binding* bindings) {
  const uint32_t saved = _mm_getcsr();
  _mm_setcsr(saved | 0x8040u);
  twin.run(params, bindings);
  _mm_setcsr(saved);
}

TEST(VerifyFloats, AWorkerThatFlushesDenormalsIsFound) {
  for (const char* stage : {"sample_pose", "fit_cubic_5", "fit_ribbon_4"}) {
    VerifyOptions options = OneExecutor(ExecutorKind::kPull, 3);
    const auto one = options.filter;
    options.filter = [one](const VerifyCase& c) { return one(c) && c.workers == 2; };
    options.tamper = Planting(stage, RunFlushing);
    const CaseResult result = RunOne(options);
    EXPECT_FALSE(result.passed) << stage;
    EXPECT_EQ(result.stage, stage) << result.reason;
  }
}
#endif

// ---- What is said
// --------------------------------------------------------------------------------

TEST(VerifyFindings, TextAndJsonSayWhatKindItIs) {
  VerifyOptions options = OneExecutor(ExecutorKind::kSerial, 2);
  options.tamper = Planting("roots", [](const void* params, const Binding* bindings) {
    twin.run(params, bindings);
    twin.As<RootBlock>(bindings, Stream::kRoots)->normal[0][0] += 0.5f;
  });
  const VerifyReport report = Verify(Tiny(), options);
  EXPECT_NE(DescribeReport(report).find("  value: frame 0, stage roots"), std::string::npos)
      << DescribeReport(report);
  const auto json = nlohmann::json::parse(ReportAsJson(report));
  EXPECT_EQ(json["cases"].back()["kind"], "value");
  EXPECT_EQ(json["cases"].back()["stage"], "roots");
  EXPECT_EQ(json["cases"].back()["stream"], "roots");
  EXPECT_EQ(json["cases"][0].count("kind"), 0u);
}

}  // namespace
}  // namespace pelt
