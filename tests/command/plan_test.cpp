// `pelt plan` shows the plans that run: main memory's as every executor but one runs it, that of
// local stores, and that of a PS3 as `pelt budget` runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/command/commands.hpp"
#include "core/error.hpp"
#include "tests/test_folder.hpp"

namespace pelt {
namespace {

using nlohmann::json;

std::string Printed(const PlanArgs& args) {
  ::testing::internal::CaptureStdout();
  const int code = PrintPlan(args);
  const std::string out = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(code, 0);
  return out;
}

// The passes that `pelt run` took the times of, as it says itself.
std::vector<json> PassesOfRun(ExecutorKind executor) {
  RunArgs args;
  args.request.scene = "monster";
  args.options.executor = executor;
  args.options.frames = 1;
  args.options.digest = false;
  args.json = true;
  ::testing::internal::CaptureStdout();
  const int code = Run(args);
  const std::string out = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(code, 0);
  return json::parse(out)["passes"];
}

PlanArgs MonsterPlan(bool local_store) {
  PlanArgs args;
  args.request.scene = "monster";
  args.local_store = local_store;
  args.json = true;
  return args;
}

void ExpectPlanIsThatOfRun(bool local_store, ExecutorKind executor) {
  const json plan = json::parse(Printed(MonsterPlan(local_store)));
  const std::vector<json> run = PassesOfRun(executor);
  ASSERT_EQ(plan["passes"].size(), run.size());
  for (size_t p = 0; p < run.size(); ++p) {
    const json& stages = plan["passes"][p]["stages"];
    std::string ends = stages.front();
    if (stages.size() > 1) ends += " .. " + std::string(stages.back());
    EXPECT_EQ(run[p]["stages"], ends) << p;
  }
}

TEST(PlanCommand, ShowsThePlanThatRunRuns) { ExpectPlanIsThatOfRun(false, "serial"); }

TEST(PlanCommand, ShowsThePlanOfLocalStores) { ExpectPlanIsThatOfRun(true, "local-store"); }

TEST(PlanCommand, NamesWhichOfTheTwoItShows) {
  const json main = json::parse(Printed(MonsterPlan(false)));
  const json local = json::parse(Printed(MonsterPlan(true)));
  EXPECT_EQ(main["place"], "main memory");
  EXPECT_EQ(local["place"], "local store");
  EXPECT_LT(main["passes"].size(), local["passes"].size()) << "large layers sort in pieces there";
  PlanArgs text = MonsterPlan(true);
  text.json = false;
  EXPECT_NE(Printed(text).find("For local stores"), std::string::npos);
}

json BudgetOnPs3(const ScenarioRequest& request, int exit_code) {
  BudgetArgs args;
  args.request = request;
  args.platforms = {"ps3"};
  args.frames = 1;
  args.warm_up = 0;
  args.target_ms = 1000.0;
  args.advice = false;
  args.json = true;
  ::testing::internal::CaptureStdout();
  const int code = PrintBudget(args);
  const std::string out = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(code, exit_code);
  return json::parse(out)["platforms"][0];
}

TEST(PlanCommand, ShowsThePlanThatBudgetRunsOnAPs3) {
  PlanArgs args;
  args.request.scene = "tiny";
  args.request.quality = ModalQuality::kBest;
  args.ps3 = args.json = true;
  const json plan = json::parse(Printed(args)), budget = BudgetOnPs3(args.request, 0);
  EXPECT_EQ(plan["place"], "PS3");
  EXPECT_EQ(plan["passes"].size(), budget["passes"].size());
  args.ps3 = false;
  args.local_store = true;
  EXPECT_GE(plan["passes"].size(), json::parse(Printed(args))["passes"].size())
      << "code takes room that longer passes would need";
}

// The largest code there is: every feature of the coat at the best quality has room beside its blocks.
TEST(PlanCommand, TheBestQualityHasRoomOnAPs3) {
  PlanArgs args;
  args.request.scene = "eyepet";
  args.request.quality = ModalQuality::kBest;
  args.ps3 = args.json = true;
  const json plan = json::parse(Printed(args)), budget = BudgetOnPs3(args.request, 0);
  EXPECT_EQ(plan["passes"].size(), budget["passes"].size());
}

json SpreadOfMonster(const std::string& times = {}) {
  PlanArgs args = MonsterPlan(false);
  args.workers = 16;
  args.times = times;
  return json::parse(Printed(args));
}

TEST(PlanCommand, ForecastsTheSameOnEveryMachine) {
  const json plan = SpreadOfMonster();
  EXPECT_EQ(plan, SpreadOfMonster());
  EXPECT_LT(plan["critical_path"], plan["cost"]);
  double before = 1.0;
  for (const json& row : plan["spread"]) {
    EXPECT_GT(row["ours"], before) << "more workers are faster";
    EXPECT_LE(row["ours"], double(row["best"]) * 1.000001);
    EXPECT_LE(row["best"], row["workers"]);
    before = row["ours"];
  }
  EXPECT_EQ(plan["spread"].back()["workers"], 16);
  // Bytes, not times: half of the best is what no wait of a graph may cost.
  EXPECT_GT(plan["spread"].back()["ours"], 8.0);
}

TEST(PlanCommand, WaitsAreBesideThePasses) {
  const json passes = json::parse(Printed(MonsterPlan(false)))["passes"];
  EXPECT_EQ(passes[0]["waits_for"], json::array());
  EXPECT_EQ(passes[3]["waits_for"], json({"1 layer", "2 by patch_list", "2 by halo"}));
  EXPECT_EQ(passes[4]["waits_for"], json({"3 layer"}));
  EXPECT_EQ(passes[6]["waits_for"], json({"4 layer"})) << "and not for the order of the layers";
}

TEST(PlanCommand, ForecastsByTheTimesOfARun) {
  RunArgs run;
  run.request.scene = "monster";
  run.options.executor = "serial";
  run.options.frames = 4;
  run.options.digest = false;
  run.json = true;
  ::testing::internal::CaptureStdout();
  ASSERT_EQ(pelt::Run(run), 0);
  const std::string text = ::testing::internal::GetCapturedStdout();
  const std::string path = test::TestFile(text, ".json");
  double stages_ms = 0.0;
  const json ran = json::parse(text);
  for (const json& stage : ran["stages"]) stages_ms += double(stage["core_ms"]["median"]);
  const json plan = SpreadOfMonster(path);
  EXPECT_NEAR(plan["cost"], stages_ms, 0.05 * stages_ms);
  PlanArgs other = MonsterPlan(false);
  other.request.scene = "eyepet";
  other.workers = 2;
  other.times = path;
  EXPECT_THROW(PrintPlan(other), Error) << "the times of another scene";
}

}  // namespace
}  // namespace pelt
