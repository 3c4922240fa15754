// Verification passes what is right, and names the place of what is wrong.
#include "bench/verify/verify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/chunk.hpp"
#include "core/kernels/frame_table.hpp"
#include "jobs/frame.hpp"

namespace pelt {
namespace {

// A faulty copy of one kernel: runs it, then spoils one value. Kernels are plain functions, so what
// it needs is kept here.
struct Fault {
  void (*run)(const void*, const Binding*) = nullptr;
  size_t port = 0;         // whose block is spoiled
  uint32_t byte = 0;       // in the block, of a 32-bit word
  uint32_t calls = 0;      // so far
  uint32_t from_call = 0;  // spoils this call alone
};
Fault fault;

void RunWithFault(const void* params, const Binding* bindings) {
  fault.run(params, bindings);
  if (fault.calls++ != fault.from_call) return;
  uint32_t word;
  auto* at = static_cast<std::byte*>(bindings[fault.port].block) + fault.byte;
  std::memcpy(&word, at, 4);
  word ^= 1u;
  std::memcpy(at, &word, 4);
}

// Replaces the first stage of that name by its faulty copy; its faulty port is `stream`'s.
void PlantBit(Plan& plan, std::string_view stage, Stream stream, uint32_t byte) {
  for (Stage& s : plan.stages) {
    if (s.kernel.name != stage) continue;
    fault.run = s.kernel.run;
    fault.byte = byte;
    fault.calls = 0;
    for (size_t p = 0; p < s.kernel.ports.size(); ++p)
      if (s.kernel.ports[p].stream == stream) fault.port = p;
    s.kernel.run = RunWithFault;
    return;
  }
  FAIL() << "no stage " << stage;
}

VerifyOptions OneCase(ExecutorKind executor, uint32_t frames) {
  VerifyOptions options;
  options.frames = frames;
  options.skips = false;
  options.checks = false;
  options.filter = [executor](const VerifyCase& c) {
    return c.executor == executor && c.isa == Isa::kReference && c.fuse && !c.piecewise_sort &&
           c.vertex_order == VertexOrder::kSorted && c.settings == Settings::kSkips &&
           !c.odd_floats;
  };
  return options;
}

TEST(Verify, TinyIsTheSameEverywhere) {
  Scenario tiny = LoadScenario("tiny");
  VerifyOptions options;
  options.frames = 2;  // pelt_verify_tiny runs more of them, and the checks
  options.checks = false;
  const VerifyReport report = Verify(tiny, options);
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
  // Besides the matrix, for each of the settings: sorted vertices against the index buffer.
  EXPECT_EQ(report.cases.size(), AllCases().size() + 3);
  for (const CaseResult& c : report.cases)
    if (c.what.executor->HasWorkers()) {
      EXPECT_EQ(c.workers_observed, c.what.workers);
    }
  EXPECT_NE(DescribeReport(report).find("verdict: SAME BITS"), std::string::npos);
}

TEST(Verify, MatrixHasEveryExecutorPlanSortAndSet) {
  const std::vector<VerifyCase> cases = AllCases();
  EXPECT_GE(ExecutorEntries().size(), 7u);
  for (const Isa isa : kAllIsas)
    for (const ExecutorEntry& entry : ExecutorEntries()) {
      // On 1, 2, 3, 7, 16 threads; in 3 orders. Each x fusion x vertex order x sort x three
      // settings, and once where threads round and flush otherwise.
      const int64_t variants = entry.HasWorkers() ? 5 : entry.HasSeed() ? 3 : 1;
      // Stage by stage: with each of the settings.
      const int64_t expected = entry.stages_alone ? 3 : variants * 8 * 3 + 1;
      EXPECT_EQ(
          std::ranges::count_if(
              cases, [&](const VerifyCase& c) { return c.isa == isa && c.executor == entry; }),
          FindKernels(isa) && entry.IsAvailable() ? expected : 0)
          << entry.name;
    }
}

TEST(Verify, EverySkipThatRestAllowsSavesWorkAndChangesNothing) {
  Scenario tiny = LoadScenario("tiny");
  VerifyOptions options;
  options.frames = 120;  // a third of the way it stops; hair needs a second to come to rest
  options.checks = false;
  options.filter = [](const VerifyCase&) { return false; };
  const VerifyReport report = Verify(tiny, options);
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
  ASSERT_EQ(report.skips.size(), 14u);
  for (const SkipResult& s : report.skips) {
    // Nothing leaves the view in this scene and no layer is lit, so neither has anything to save;
    // tests/jobs/lighting_test.cpp has lit layers.
    if (s.course != "coming to rest" || s.name == "cull" || s.name == "light") continue;
    EXPECT_TRUE(s.compared) << s.reason;
    EXPECT_GT(s.items_skipped, 0u) << s.name << " skipped nothing, so nothing was proven";
  }
}

TEST(Verify, APlantedFaultIsNamedToTheLane) {
  Scenario tiny = LoadScenario("tiny");
  VerifyOptions options = OneCase("serial", 4);
  constexpr uint32_t kLane = 5;
  constexpr uint32_t kByte = uint32_t(offsetof(RootBlock, normal)) +
                             4 * (1 * kStrandsPerChunk + kLane);  // normal y of lane 5
  fault.from_call = 0;
  options.tamper = [&](const VerifyCase&, Plan& plan) {
    PlantBit(plan, "roots", StreamOf<&Streams::roots>, kByte);
  };
  const VerifyReport report = Verify(tiny, options);
  EXPECT_FALSE(report.Passed());
  const CaseResult& failed = report.cases.back();
  ASSERT_TRUE(failed.mismatch.has_value()) << failed.reason;
  const Mismatch& m = *failed.mismatch;
  EXPECT_TRUE(m.reproduced);
  EXPECT_EQ(m.frame, 0u);
  EXPECT_EQ(m.stage, "roots");
  EXPECT_EQ(m.stream, "roots");
  EXPECT_EQ(m.layer, "vertex");
  EXPECT_EQ(m.domain, Domain::kChunk);
  EXPECT_EQ(m.place_in_layer, 0u);
  EXPECT_EQ(m.row, "normal");
  EXPECT_EQ(m.component, 1u);
  EXPECT_EQ(m.lane, kLane);
  EXPECT_EQ(m.expected ^ m.found, 1u);
  const std::string text = DescribeReport(report);
  EXPECT_NE(text.find("verdict: DIFFERENT BITS"), std::string::npos);
  EXPECT_NE(text.find("stage roots"), std::string::npos) << text;
  EXPECT_NE(text.find("lane 5"), std::string::npos) << text;
  const std::string place = DescribeMismatch(m);
  EXPECT_NE(place.find("layer 'vertex', chunk 0 (item 0)"), std::string::npos) << place;
}

// In a patch of another layer than the first.
TEST(Verify, APlantedFaultOfAPatchIsNamedToTheVertex) {
  Scenario tiny = LoadScenario("tiny");
  VerifyOptions options = OneCase("serial", 3);
  constexpr uint32_t kVertex = 5;
  constexpr uint32_t kByte =
      uint32_t(offsetof(SkinnedVertex, normal)) + kVertex * uint32_t(sizeof(SkinnedVertex));
  const uint32_t before = tiny.grooms[0].layers[0].patch_count;
  fault.from_call = before;  // in the first frame every patch is skinned, in order
  options.tamper = [&](const VerifyCase&, Plan& plan) {
    PlantBit(plan, "skin", StreamOf<&Streams::skinned>, kByte);
  };
  const VerifyReport report = Verify(tiny, options);
  EXPECT_FALSE(report.Passed());
  const CaseResult& failed = report.cases.back();
  ASSERT_TRUE(failed.mismatch.has_value()) << failed.reason;
  const Mismatch& m = *failed.mismatch;
  EXPECT_EQ(m.stage, "skin");
  EXPECT_EQ(m.stream, "skinned");
  EXPECT_EQ(m.domain, Domain::kPatch);
  EXPECT_EQ(m.item, before);
  EXPECT_EQ(m.layer_index, 1u);
  EXPECT_EQ(m.place_in_layer, 0u);
  EXPECT_EQ(m.lane, kVertex);
  const std::string place = DescribeMismatch(m);
  EXPECT_NE(place.find("layer 'strand4', patch 0 (item "), std::string::npos) << place;
}

TEST(Verify, TheFrameOfALateFaultIsFound) {
  Scenario tiny = LoadScenario("tiny");
  VerifyOptions options = OneCase("serial", 5);
  // Verified with a neighbour, as any scene of one character.
  const uint32_t characters = uint32_t(tiny.actors.size()) + 1;
  fault.from_call = 3 * characters;  // the pose is sampled once per frame and character
  options.tamper = [&](const VerifyCase&, Plan& plan) {
    PlantBit(plan, "sample_pose", StreamOf<&Streams::local_pose>, 0);
  };
  const VerifyReport report = Verify(tiny, options);
  ASSERT_TRUE(report.cases.back().mismatch.has_value());
  EXPECT_EQ(report.cases.back().mismatch->frame, 3u);
  EXPECT_EQ(report.cases.back().mismatch->stage, "sample_pose");
}

TEST(Verify, AWriteThroughAReadOnlyPortIsALocalStoreFault) {
  Scenario tiny = LoadScenario("tiny");
  VerifyOptions options = OneCase("local-store", 2);
  fault.from_call = 0;
  options.tamper = [&](const VerifyCase&, Plan& plan) {
    PlantBit(plan, "skin", StreamOf<&Streams::mesh>, uint32_t(offsetof(MeshBlock, tangent)));
  };
  const VerifyReport report = Verify(tiny, options);
  EXPECT_FALSE(report.cases.back().passed);
  EXPECT_NE(report.cases.back().reason.find("local store"), std::string::npos)
      << report.cases.back().reason;
  EXPECT_NE(report.cases.back().reason.find("skin"), std::string::npos);
}

TEST(Verify, JsonIsValidAndCarriesTheVerdict) {
  Scenario tiny = LoadScenario("tiny");
  VerifyOptions options = OneCase("permuted", 2);
  const VerifyReport report = Verify(tiny, options);
  const nlohmann::json json = nlohmann::json::parse(ReportAsJson(report));
  EXPECT_EQ(json["passed"], true);
  EXPECT_EQ(json["cases"].size(), report.cases.size());
  EXPECT_EQ(json["characters"], 2);
  EXPECT_EQ(json["digest"].get<std::string>().size(), 16u);
}

}  // namespace
}  // namespace pelt
