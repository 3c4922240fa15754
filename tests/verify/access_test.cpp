// Reads and writes that no port declares, and state that belongs to no block, are found and named.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/verify/planting.hpp"

namespace pelt::testing {
namespace {

VerifyReport RunAccessAtRest(Tamper tamper) { return RunSection("access", 6, std::move(tamper)); }

TEST(VerifyAccess, AReadOfANeighbourWhoseValueNeverMattersIsFound) {
  if (!ExecutorKind("guarded")->IsAvailable()) GTEST_SKIP() << "no pages to close";
  VerifyOptions options = OneExecutor("guarded", 2);
  options.tamper = Planting("roots", [](const void* params, const Binding* bindings) {
    healthy.run(params, bindings);
    const auto* next =
        Launder(healthy.As<const StrandBlock>(bindings, StreamOf<&Streams::strands>)) + 1;
    if (*Launder(next->length) > 1000.0f)
      healthy.As<RootBlock>(bindings, StreamOf<&Streams::roots>)->position[0][0] = 0.0f;
  });
  const CaseResult result = RunOne(options);
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(result.kind, FindingKind::kUndeclaredRead) << result.reason;
  EXPECT_EQ(result.stage, "roots");
  EXPECT_EQ(result.stream, "strands");
  // The other executors cannot see it: no value depends on it.
  options.filter = OneExecutor("local-store", 2).filter;
  EXPECT_TRUE(RunOne(options).passed);
}

TEST(VerifyAccess, AReadOfAnotherCharacterIsFoundAndNamed) {
  const CaseResult result =
      RunPlanted("serial", "skin", [](const void* params, const Binding* bindings) {
        healthy.run(params, bindings);
        // One character on: in a scene of one there is nothing there but another stream.
        const auto* next =
            Launder(healthy.As<const PaletteBlock>(bindings, StreamOf<&Streams::palette>)) + 1;
        healthy.As<SkinnedBlock>(bindings, StreamOf<&Streams::skinned>)->vertex[0].position[0] +=
            Launder(next->matrix[0])[3];
      });
  if (!ExecutorKind("guarded")->IsAvailable()) return;
  EXPECT_EQ(result.kind, FindingKind::kUndeclaredRead) << result.reason;
  EXPECT_EQ(result.stage, "skin");
}

TEST(VerifyAccess, APointerKeptFromTheLastItemIsFound) {
  if (!ExecutorKind("guarded")->IsAvailable()) GTEST_SKIP() << "no pages to close";
  const CaseResult result =
      RunPlanted("guarded", "skin", [](const void* params, const Binding* bindings) {
        healthy.run(params, bindings);
        auto* mesh = healthy.As<std::byte>(bindings, StreamOf<&Streams::mesh>);
        if (healthy.kept && *Launder(healthy.kept) == std::byte{77})
          healthy.As<SkinnedBlock>(bindings, StreamOf<&Streams::skinned>)->vertex[0].position[0] =
              0.0f;
        healthy.kept = mesh;
      });
  EXPECT_EQ(result.stage, "skin");
  EXPECT_TRUE(result.kind == FindingKind::kUndeclaredRead) << result.reason;
}

TEST(VerifyAccess, AWriteOfTheSameValuePastTheEndIsFound) {
  if (!ExecutorKind("guarded")->IsAvailable()) GTEST_SKIP() << "no pages to close";
  const CaseResult result =
      RunPlanted("guarded", "fit_cubic_4", [](const void* params, const Binding* bindings) {
        healthy.run(params, bindings);
        auto* behind = reinterpret_cast<std::byte*>(
            Launder(healthy.As<CurveBlock>(bindings, StreamOf<&Streams::curves>)) + 1);
        *Launder(behind) = *Launder(behind);
      });
  EXPECT_EQ(result.stage, "fit_cubic_4");
  EXPECT_EQ(result.stream, "curves") << result.reason;
}

TEST(VerifyAccess, AWriteInFrontOfTheBlockAndOneThroughAReadOnlyPortAreFound) {
  if (!ExecutorKind("guarded")->IsAvailable()) GTEST_SKIP() << "no pages to close";
  VerifyOptions options = OneExecutor("guarded", 2);
  options.tamper = Planting("roots", [](const void* params, const Binding* bindings) {
    healthy.run(params, bindings);
    Launder(reinterpret_cast<uint32_t*>(
        healthy.As<RootBlock>(bindings, StreamOf<&Streams::roots>)))[-1] = 0;
  });
  CaseResult result = RunOne(options);
  EXPECT_EQ(result.kind, FindingKind::kUndeclaredWrite) << result.reason;
  options.tamper = Planting("roots", [](const void* params, const Binding* bindings) {
    healthy.run(params, bindings);
    auto* length = const_cast<float*>(
        Launder(healthy.As<const StrandBlock>(bindings, StreamOf<&Streams::strands>))->length);
    *Launder(length) = *Launder(length);  // the same value: no comparison shows it
  });
  result = RunOne(options);
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(result.stream, "strands") << result.reason;
  EXPECT_NE(result.reason.find("read-only port 'strands'"), std::string::npos) << result.reason;
}

TEST(VerifyAccess, StaticStateIsFound) {
  if (!ExecutorKind("guarded")->IsAvailable()) GTEST_SKIP() << "no pages to close";
  static uint32_t runs;
  runs = 0;
  const CaseResult result =
      RunPlanted("guarded", "sample_pose", [](const void* params, const Binding* bindings) {
        healthy.run(params, bindings);
        healthy.As<LocalPoseBlock>(bindings, StreamOf<&Streams::local_pose>)->translation[0][0] +=
            float(runs++);
      });
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
  const VerifyReport report =
      RunAccessAtRest([&](const VerifyCase&, Plan& plan) { DeclareOut(plan, stage, stream); });
  const auto checks = ChecksOf(report, "access");
  ASSERT_TRUE(AnyFailed(checks, FindingKind::kReadsOut, "at rest")) << DescribeReport(report);
  const auto failed = std::find_if(checks.begin(), checks.end(), [](const CheckResult& c) {
    return c.kind == FindingKind::kReadsOut;
  });
  EXPECT_EQ(failed->stage, stage);
  EXPECT_EQ(failed->stream, DescribeStream(stream).name);
}

TEST(VerifyAccess, SortKeysDeclaredOutAreFound) {
  if (!ExecutorKind("guarded")->IsAvailable()) GTEST_SKIP() << "no pages to close";
  ExpectReadsOutFound("sort_key4", StreamOf<&Streams::sort_keys>);
}

TEST(VerifyAccess, ActivatesStateDeclaredOutIsFound) {
  if (!ExecutorKind("guarded")->IsAvailable()) GTEST_SKIP() << "no pages to close";
  ExpectReadsOutFound("activate", StreamOf<&Streams::chunk_state>);
  ExpectReadsOutFound("activate_followers", StreamOf<&Streams::chunk_state>);
  ExpectReadsOutFound("activate_patch", StreamOf<&Streams::patch_state>);
}

TEST(VerifyAccess, HealthyScenePassesAtRest) {
  const VerifyReport report = RunAccessAtRest({});
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
}

// Lanes that do not live, of the last group that is worked on, read vertices that no kernel skins:
// vertices live from the last strand of such a group on, and not from its first.
void ActivateWithoutTheLastLaneGroup(const void* params, const Binding* bindings) {
  healthy.run(params, bindings);
  auto& state = *healthy.As<ChunkStateBlock>(bindings, StreamOf<&Streams::patch_state>);
  const auto& patch = *healthy.As<const PatchBlock>(bindings, StreamOf<&Streams::patches>);
  const auto& lod = *healthy.As<const LodBlock>(bindings, StreamOf<&Streams::lod>);
  const float late = float(kLaneGroup - 1) / float(kStrandsPerChunk);
  uint32_t groups = 0;
  while (groups < kVertexGroups && lod.fraction > patch.live_from[groups] + late) ++groups;
  state.live_vertices = std::min(state.live_vertices, groups * kLaneGroup);
}

TEST(VerifyAccess, VerticesOfTheLastLaneGroupLeftOutAreFound) {
  const VerifyReport report =
      RunAccessAtRest(Planting("activate_patch", ActivateWithoutTheLastLaneGroup));
  EXPECT_TRUE(AnyFailed(ChecksOf(report, "access"), FindingKind::kReadsOut, "whole lane groups"));
}

}  // namespace
}  // namespace pelt::testing
