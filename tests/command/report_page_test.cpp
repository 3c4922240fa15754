// The report's page as text and data: complete, consistent, and harmless for any names of things.
#include "bench/report/report_page.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>
#include <string>

#include "bench/consoles/console_budget.hpp"
#include "bench/consoles/console_report.hpp"
#include "bench/verify/verified_scene.hpp"
#include "core/error.hpp"
#include "jobs/tick_clock.hpp"

namespace pelt {
namespace {

struct Report {
  std::string page;
  RunReport run;
  nlohmann::json data;
};

Report MakeReport(Scenario& scenario, uint32_t frames, ExecutorKind executor, uint32_t workers,
                  const std::function<void(JsonText&)>& add_consoles = {}) {
  RunOptions options;
  options.executor = executor;
  options.workers = workers;
  options.frames = frames;
  RunningScenario running(scenario, options.scene);
  ReportRecorder recorder(running.scene());
  options.observed_as = Recording::kAll;
  options.observe = [&](const FinishedFrame& frame) { recorder.Add(frame); };
  const TickScale scale;
  Report report;
  report.run = RunFrames(scenario, running, options);
  report.page = recorder.Page(report.run, scale.NsPerTick(), add_consoles);
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const size_t from = report.page.find(begin) + begin.size();
  // As a browser does it: up to the first end of a script.
  report.data = nlohmann::json::parse(
      report.page.substr(from, report.page.find("</script", from) - from), nullptr, false);
  return report;
}

size_t CountTags(const std::string& text, const std::string& what) {
  size_t count = 0;
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++count;
  return count;
}

TEST(ReportPage, HoldsAllPartsAndNothingFromOutside) {
  Scenario tiny = LoadScenario("tiny");
  const Report report = MakeReport(tiny, 12, "tbb", 3);
  ASSERT_TRUE(report.data.is_object());
  EXPECT_EQ(report.page.find("@PELT_"), std::string::npos);
  for (const char* outside : {" src=", " href=", "@import", "url(", "fetch(", "https:"})
    EXPECT_EQ(report.page.find(outside), std::string::npos) << outside;
  EXPECT_EQ(CountTags(report.page, "<script"), 2u);
  EXPECT_EQ(CountTags(report.page, "</script>"), 2u);
  EXPECT_EQ(report.data["scene"], "tiny");
  EXPECT_EQ(report.data["digest"], fmt::format("{:016x}", report.run.digest));
  EXPECT_EQ(report.data["commit"], report.run.machine.commit);
  EXPECT_EQ(report.data["workers"], 3);
}

TEST(ReportPage, FiguresAgreeWithEachOther) {
  Scenario tiny = LoadScenario("tiny");
  const Report report = MakeReport(tiny, 20, "tbb", 2);
  const nlohmann::json& data = report.data;
  ASSERT_EQ(data["columns"].size(), 20u);
  double worst = 0.0;
  for (const auto& column : data["columns"]) {
    // The bands of a column fill the frame, regardless of what ran beside what.
    double sum = double(column["caller"]) + double(column["others"]) + double(column["waiting"]);
    for (const auto& ms : column["stages"]) sum += double(ms);
    EXPECT_NEAR(sum, column["ms"], 0.001 + 0.02 * double(column["ms"]));
    worst = std::max(worst, double(column["ms"]));
  }
  EXPECT_NEAR(data["frame_ms"]["worst"], worst, 1e-4);
  for (const char* key : {"frame_ms", "caller_ms"}) {
    EXPECT_LE(data[key]["median"], data[key]["p95"]);
    EXPECT_LE(data[key]["p95"], data[key]["p99"]);
    EXPECT_LE(data[key]["p99"], data[key]["worst"]);
  }
  uint64_t bytes = 0;
  for (const auto& range : data["memory"]) bytes += uint64_t(range["bytes"]);
  EXPECT_EQ(bytes, report.run.layout.total_bytes);
  double activated = 0.0;
  for (const auto& stage : data["stages"])
    if (stage["name"] == "activate" || stage["name"] == "activate_followers") {
      activated += double(stage["ran"]);
      EXPECT_EQ(stage["skipped"], 0.0);
    }
  EXPECT_EQ(activated, report.run.chunks);
  uint32_t stages = 0;
  for (const auto& pass : data["passes"]) stages += uint32_t(pass["stage_count"]);
  EXPECT_EQ(stages, data["stages"].size());
}

// Of one frame the medians add up: all that a stage took, some layer, character or the scene has.
TEST(ReportPage, CostsOfLayersAndCharactersAreThoseOfStages) {
  Scenario two = MakeVerifiedScene(LoadScenario("tiny"));
  const Report report = MakeReport(two, 1, "tbb", 2);
  const nlohmann::json& data = report.data;
  const auto median = [](const nlohmann::json& of) { return double(of["core_ms"]["median"]); };
  double stages = 0.0, layers = 0.0, characters = 0.0, own = 0.0;
  uint64_t strands = 0;
  for (const auto& stage : data["stages"]) stages += median(stage);
  ASSERT_EQ(data["layer_costs"].size(), report.run.layers);
  std::vector<double> of_character(report.run.characters);
  for (const auto& layer : data["layer_costs"]) {
    layers += median(layer);
    of_character.at(size_t(layer["character"])) += median(layer);
    strands += uint64_t(layer["strands"]);
    EXPECT_GT(median(layer), 0.0) << layer["name"];
    EXPECT_GT(double(layer["most_share"]), 0.0);
    EXPECT_LE(double(layer["most_share"]), 1.0);
    EXPECT_EQ(data["stages"].at(size_t(layer["most_stage"]))["domain"] == "character", false);
    ASSERT_EQ(layer.contains("ran"), layer["solver"] == "modal") << layer;
    if (!layer.contains("ran")) continue;
    const auto ran = layer["ran"].get<std::vector<uint32_t>>();
    EXPECT_EQ(std::accumulate(ran.begin(), ran.end(), 0u), uint32_t(data["frames"])) << layer;
    EXPECT_GT(double(layer["error_px"]), 0.0) << layer;
  }
  EXPECT_EQ(strands, report.run.strands);
  ASSERT_EQ(data["character_costs"].size(), 2u);
  for (size_t c = 0; c < 2; ++c) {
    const auto& character = data["character_costs"][c];
    EXPECT_NEAR(median(character), of_character[c] + double(character["own_ms"]), 1e-9);
    EXPECT_GT(double(character["own_ms"]), 0.0);
    characters += median(character);
    own += double(character["own_ms"]);
  }
  const double scene = median(data["scene_cost"]);
  EXPECT_GT(scene, 0.0);
  EXPECT_NEAR(layers + own + scene, stages, 1e-9);
  EXPECT_NEAR(characters + scene, stages, 1e-9);
  EXPECT_NEAR(median(data["cost"]), stages, 1e-9);
}

TEST(ReportPage, TimelinesAreOfTheMedianAndTheWorstFrame) {
  Scenario tiny = LoadScenario("tiny");
  const Report report = MakeReport(tiny, 30, "serial", 1);
  const nlohmann::json& data = report.data;
  ASSERT_EQ(data["timelines"].size(), 2u);
  EXPECT_NEAR(double(data["timelines"][0]["ns"]) * 1e-6, data["frame_ms"]["median"], 2e-4);
  EXPECT_NEAR(double(data["timelines"][1]["ns"]) * 1e-6, data["frame_ms"]["worst"], 2e-4);
  for (const auto& timeline : data["timelines"]) {
    ASSERT_EQ(timeline["workers"].size(), 1u);
    const auto& runs = timeline["workers"][0]["runs"];
    ASSERT_GT(runs.size(), 0u);
    ASSERT_EQ(runs.size() % 4, 0u);
    int64_t last = 0;
    for (size_t i = 0; i < runs.size(); i += 4) {
      const auto& stage = data["stages"].at(size_t(runs[i]));
      EXPECT_LT(size_t(runs[i + 1]), data["items"][std::string(stage["domain"])].size());
      EXPECT_LE(last, int64_t(runs[i + 2]));
      EXPECT_LE(int64_t(runs[i + 2]), int64_t(runs[i + 3]));
      last = runs[i + 3];
    }
    EXPECT_LE(last, int64_t(timeline["ns"]));
  }
}

// Long runs keep few whole frames, spread over all of it, and one column for several frames.
TEST(ReportPage, LongRunsStaySmall) {
  Scenario tiny = LoadScenario("tiny");
  const Report report = MakeReport(tiny, 1300, "serial", 1);
  EXPECT_EQ(report.data["frames_a_column"], 3);
  EXPECT_EQ(report.data["columns"].size(), 434u);
  EXPECT_EQ(report.data["timelines"].size(), 2u);
  EXPECT_LT(report.page.size(), 1'000'000u);
  double worst = 0.0;
  for (const auto& column : report.data["columns"]) worst = std::max(worst, double(column["ms"]));
  EXPECT_NEAR(report.data["frame_ms"]["worst"], worst, 1e-4);
}

// Names come from files.
TEST(ReportPage, HostileNamesStayText) {
  Scenario tiny = LoadScenario("tiny");
  // A layer's name is printable: a groom with another is refused.
  const std::string hostile = "</script><script>alert(\"1\")</script><!-- ' & @PELT_SCRIPT@ \"";
  tiny.name = hostile + " \xff\xfe";
  for (Groom& groom : tiny.grooms)
    for (auto& layer : groom.layers) layer.name = hostile;
  const Report report = MakeReport(tiny, 3, "serial", 1);
  ASSERT_TRUE(report.data.is_object()) << "the name ended the data";
  EXPECT_EQ(CountTags(report.page, "<script"), 2u);
  EXPECT_EQ(CountTags(report.page, "</script>"), 2u);
  EXPECT_EQ(CountTags(report.page, "<!--"), 0u);
  const std::string scene = report.data["scene"];
  EXPECT_EQ(scene.substr(0, 9), "</script>");
  EXPECT_NE(scene.find("@PELT_SCRIPT@"), std::string::npos);
  const std::string layer = report.data["items"]["layer"][0];
  EXPECT_NE(layer.find("alert(\"1\")"), std::string::npos);
}

TEST(ReportPage, ConsolesAreThereWhenTheyWereModelled) {
  Scenario tiny = LoadScenario("tiny");
  const Report without = MakeReport(tiny, 2, "serial", 1);
  EXPECT_TRUE(without.data["consoles"].is_array());
  EXPECT_TRUE(without.data["consoles"].empty());
  const Report with = MakeReport(tiny, 2, "serial", 1, [&](JsonText& json) {
    for (const Console console : kAllConsoles) {
      ConsoleRun run(tiny, {.console = console, .frames = 2});
      const ConsoleBudget budget = run.Run();
      AddConsoleFrame(json, budget, run.scene());
    }
  });
  ASSERT_EQ(with.data["consoles"].size(), 2u);
  for (const auto& console : with.data["consoles"]) {
    EXPECT_EQ(console["units"].size(), 6u);
    EXPECT_FALSE(console["stages"].empty());
    EXPECT_NE(std::string(console["verdict"]).find("fits 5 ms"), std::string::npos);
    EXPECT_NE(std::string(console["verdict"]).find("availability of 0.92"), std::string::npos);
    // The page names a slice's item by its pass's domain.
    for (const auto& unit : console["units"])
      for (size_t i = 0; i < unit["slices"].size(); i += 5) {
        const int64_t pass = unit["slices"][i + 1], item = unit["slices"][i + 2];
        if (pass < 0 || item < 0) continue;
        const std::string domain = console["plan"].at(size_t(pass))["domain"];
        EXPECT_LT(size_t(item), with.data["items"][domain].size()) << domain;
      }
  }
  EXPECT_EQ(with.data["consoles"][0]["name"], "PS3");
  EXPECT_EQ(with.data["consoles"][1]["name"], "Xbox 360");
}

TEST(ReportPage, LocalStoreHasNoTimesToShow) {
  EXPECT_THROW(CheckRecords("local-store"), Error);
  EXPECT_NO_THROW(CheckRecords("permuted"));
}

}  // namespace
}  // namespace pelt
