// The figures of a run: spreads, traffic, the budget's sums, JSON.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "bench/report/json_text.hpp"
#include "bench/report/machine_use.hpp"
#include "bench/report/run_report.hpp"
#include "bench/verify/verified_scene.hpp"

namespace pelt {
namespace {

TEST(Report, SpreadIsMedianPercentileAndWorst) {
  std::vector<double> values(101);
  std::iota(values.rbegin(), values.rend(), 0.0);
  const Spread spread = SpreadOf(values);
  EXPECT_EQ(spread.median, 50.0);
  EXPECT_EQ(spread.p95, 95.0);
  EXPECT_EQ(spread.worst, 100.0);
  EXPECT_EQ(SpreadOf({}).worst, 0.0);
}

TEST(Report, JsonTextReadsBackAsWritten) {
  JsonText json;
  json.BeginObject();
  json.Add("text", "a \"quoted\" \\ line\n");
  json.Add("flag", true);
  json.Add("count", 42);
  json.Add("not_a_number", std::numeric_limits<double>::quiet_NaN());
  json.BeginArray("list");
  json.Add("", 1.5);
  json.Add("", "x");
  json.EndArray();
  json.AddDigest("digest", 0x12);
  json.EndObject();
  const nlohmann::json read = nlohmann::json::parse(json.text());
  EXPECT_EQ(read["text"], "a \"quoted\" \\ line\n");
  EXPECT_EQ(read["flag"], true);
  EXPECT_EQ(read["count"], 42);
  EXPECT_TRUE(read["not_a_number"].is_null());
  EXPECT_EQ(read["list"], nlohmann::json::parse("[1.5, \"x\"]"));
  EXPECT_EQ(read["digest"], "0000000000000012");
}

TEST(Report, TrafficCountsWholeBlocksInAndOut) {
  Scenario tiny = LoadScenario("tiny");
  RunningScenario running(tiny, {});
  const SceneShape& shape = running.scene().shape();
  for (const Stage& stage : running.scene().plan().stages) {
    if (stage.kernel.name == "roots") {
      const PortTraffic traffic = StageTraffic(stage, shape, 0);
      EXPECT_EQ(traffic.out_bytes, sizeof(RootBlock));
      EXPECT_EQ(traffic.in_bytes,
                sizeof(ChunkStateBlock) + sizeof(StrandBlock) + sizeof(SkinnedBlock));
    }
    if (stage.kernel.name == "sort_layer") {
      // Keys of every chunk of the layer come in.
      const PortTraffic traffic = StageTraffic(stage, shape, 0);
      EXPECT_GE(traffic.in_bytes, shape.LayerChunks(0) * sizeof(SortKeyBlock));
    }
  }
}

TEST(Report, RunAccountsForEveryItemOfEveryFrame) {
  Scenario tiny = LoadScenario("tiny");
  RunOptions options;
  options.executor = "serial";
  options.frames = 10;
  RunningScenario running(tiny, options.scene);
  const RunReport report = RunFrames(tiny, running, options);
  EXPECT_EQ(report.frames, 10u);
  EXPECT_EQ(report.budget.frames, 10u);
  EXPECT_NE(report.digest, 0u);
  EXPECT_GT(report.drawn_strands, 0u);
  EXPECT_LE(report.drawn_strands, report.live_strands);
  uint64_t bytes = 0;
  for (const MemoryRange& range : report.layout.ranges) bytes += range.bytes;
  EXPECT_EQ(bytes, report.layout.total_bytes);
  double patches = 0.0, chunks = 0.0;
  for (const StageBudget& stage : report.budget.stages) {
    const bool of_patches = stage.name == "activate_patch";
    if (!of_patches && stage.name != "activate" && stage.name != "activate_followers") continue;
    (of_patches ? patches : chunks) += stage.ran;
    EXPECT_EQ(stage.skipped, 0.0);
    EXPECT_GT(stage.bytes, 0.0);
    EXPECT_GT(stage.core_ms.median, 0.0);
  }
  EXPECT_EQ(patches, double(running.scene().shape().patch_count));
  EXPECT_EQ(chunks, double(report.chunks));
  EXPECT_GE(report.budget.wall_ms.worst, report.budget.wall_ms.median);
}

TEST(Report, TheDigestDoesNotDependOnWhatRanIt) {
  Scenario tiny = LoadScenario("tiny");
  uint64_t digests[2];
  for (int i = 0; i < 2; ++i) {
    RunOptions options;
    options.executor = i ? "tbb" : "serial";
    options.workers = 3;
    options.frames = 8;
    options.scene.isa = i ? BestIsa() : Isa::kReference;
    RunningScenario running(tiny, options.scene);
    digests[i] = RunFrames(tiny, running, options).digest;
  }
  EXPECT_EQ(digests[0], digests[1]);
}

TEST(Report, ADisturbedTimeIsNoVerdict) {
  EXPECT_EQ(JudgeTime(8.0, 8.0, false), Fit::kFits);
  EXPECT_EQ(JudgeTime(8.1, 8.0, false), Fit::kDoesNotFit);
  for (const double ms : {1.0, 8.1}) EXPECT_EQ(JudgeTime(ms, 8.0, true), Fit::kUnsure) << ms;
  const auto all = [](std::initializer_list<Fit> fits) { return JudgeAll(std::vector<Fit>(fits)); };
  EXPECT_EQ(all({Fit::kFits, Fit::kFits}), Fit::kFits);
  EXPECT_EQ(all({Fit::kFits, Fit::kUnsure, Fit::kFits}), Fit::kUnsure);
  EXPECT_EQ(all({Fit::kUnsure, Fit::kDoesNotFit, Fit::kFits}), Fit::kDoesNotFit);
}

TEST(Report, WhatDisturbsARunIsTold) {
  const MachineUse own{.wait = {.preemptions = 3, .waited_ms = 2.0},
                       .cores_allowed = 4,
                       .load_average = 0.3,
                       .wall_ms = 1000.0};
  EXPECT_TRUE(FindDisturbances(own, 4).empty());
  const auto expect_told = [](const MachineUse& use, uint32_t workers, const std::string& word) {
    const std::vector<std::string> found = FindDisturbances(use, workers);
    ASSERT_EQ(found.size(), 1u) << word;
    EXPECT_NE(found[0].find(word), std::string::npos) << found[0];
  };
  MachineUse use = own;
  use.wait.waited_ms = 81.0;  // of 4 s of cores
  expect_told(use, 4, "ready for 81 ms without a core");
  use.cores_allowed = 2;  // half as much waiting is the same share of half the cores
  use.wait.waited_ms = 41.0;
  use.load_average = 0.0;
  expect_told(use, 2, "on 2 cores");
  use = own;
  use.load_average = 2.6;
  EXPECT_TRUE(FindDisturbances(use, 2).empty()) << "who ran before is gone: nothing waited";
  use.wait.waited_ms = {};
  expect_told(use, 2, "load average 2.60");
  EXPECT_TRUE(FindDisturbances(use, 1).empty()) << "a core was free";
  use = own;
  use.wait.waited_ms = {};
  EXPECT_TRUE(FindDisturbances(use, 4).empty());
  use.wait.preemptions = 21;
  expect_told(use, 4, "21 preemptions");
  use = own;
  use.cores_allowed = 1;
  use.load_average = {};
  expect_told(use, 2, "2 workers had 1 core:");
}

TEST(Report, ARunsTreeHasItsFigures) {
  Scenario tiny = LoadScenario("tiny");
  RunOptions options;
  options.frames = 4;
  options.workers = 2;
  RunningScenario running(tiny, options.scene);
  const RunReport report = RunFrames(tiny, running, options);
  const nlohmann::json json = nlohmann::json::parse(MakeRunTree(report).Json());
  EXPECT_EQ(json["strands"], report.strands);
  EXPECT_EQ(json["workers_observed"], 2);
  EXPECT_FALSE(json["stages"].empty());
  EXPECT_FALSE(json["passes"].empty());
}

// In every frame in which stages were timed, all of them together took what all owners did.
TEST(Report, ARunsLayersAndCharactersHaveTheirPartOfEachFrame) {
  Scenario two = MakeVerifiedScene(LoadScenario("tiny"));
  RunOptions options;
  options.frames = 7;
  RunningScenario running(two, options.scene);
  const RunReport report = RunFrames(two, running, options);
  const nlohmann::json json = nlohmann::json::parse(MakeRunTree(report).Json());
  ASSERT_EQ(json["layer_costs"].size(), report.layers);
  ASSERT_EQ(json["character_costs"].size(), 2u);
  uint64_t strands = 0, of_characters = 0;
  for (const auto& layer : json["layer_costs"]) {
    strands += uint64_t(layer["strands"]);
    EXPECT_GT(double(layer["core_ms"]["median"]), 0.0) << layer;
    EXPECT_GT(double(layer["dearest_share"]), 0.0) << layer;
    ASSERT_TRUE(json["samples"]["layers"].contains(std::string(layer["layer"]))) << layer;
  }
  for (const auto& character : json["character_costs"])
    of_characters += uint64_t(character["strands"]);
  EXPECT_EQ(strands, report.strands);
  EXPECT_EQ(of_characters, report.strands);
  const auto sum = [&](const char* owners) {
    std::vector<double> ms(3);  // of seven frames, those of odd numbers
    for (const auto& [name, times] : json["samples"][owners].items()) {
      EXPECT_EQ(times.size(), ms.size()) << name;
      for (size_t f = 0; f < ms.size(); ++f) ms[f] += double(times.at(f));
    }
    return ms;
  };
  const auto stages = sum("stages"), layers = sum("layers"), characters = sum("characters");
  for (size_t f = 0; f < stages.size(); ++f) {
    EXPECT_LT(layers[f], characters[f]) << "poses and joints are no layer's";
    EXPECT_LT(characters[f], stages[f]) << "the order of layers is the scene's";
    EXPECT_GT(layers[f], 0.8 * stages[f]);
  }
}

}  // namespace
}  // namespace pelt
