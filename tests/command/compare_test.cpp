// Two runs compared with each other: the intervals hold what they promise, and what cannot be
// compared is refused by its place.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "bench/report/report_page.hpp"
#include "bench/report/run_report.hpp"
#include "tests/error_from.hpp"

namespace pelt {
namespace {

using TimePairs = std::vector<std::pair<double, double>>;

TimePairs PairsOf(std::initializer_list<double> ratios) {
  TimePairs pairs;
  for (const double ratio : ratios) pairs.emplace_back(2.0, 2.0 * ratio);
  return pairs;
}

TEST(Compare, IntervalsAreTheRanksOfTheSignTest) {
  EXPECT_EQ(PairsNeeded(1), 6u) << "2 of 64 samples miss the median";
  EXPECT_EQ(PairsNeeded(2), 7u);
  EXPECT_EQ(PairsNeeded(819), 15u);
  EXPECT_EQ(PairsNeeded(820), 16u);
  const auto six = RatioOf(PairsOf({1.5, 1.1, 1.2, 1.4, 1.3, 1.6}), 1);
  ASSERT_TRUE(six);
  EXPECT_DOUBLE_EQ(six->ratio, 1.35);
  EXPECT_DOUBLE_EQ(six->low, 1.1);
  EXPECT_DOUBLE_EQ(six->high, 1.6);
  // Of nine the outermost on both sides lie outside: one round that went wrong moves nothing.
  const auto nine = PairsOf({1, 1, 1, 1, 1, 1, 1, 1, 30});
  ASSERT_TRUE(RatioOf(nine, 1));
  EXPECT_EQ(RatioOf(nine, 1)->high, 1.0);
  // With a second row beside it 2 (1 + 9) / 512 is more than it may miss.
  ASSERT_TRUE(RatioOf(nine, 2));
  EXPECT_EQ(RatioOf(nine, 2)->high, 30.0);
  EXPECT_TRUE(RatioOf(nine, 12));
  EXPECT_FALSE(RatioOf(nine, 13)) << "13 times 2 / 512 is above 0.05";
  EXPECT_FALSE(RatioOf(PairsOf({1, 1, 1, 1, 1}), 1));
  EXPECT_FALSE(RatioOf(PairsOf({1, 1, 1, 1, 1, 0}), 1)) << "a stage that slept has no ratio";
}

// A run's frames: dear at its end, spread by a fifth, and each as far off as half of the one before.
std::vector<double> DrawFrames(std::mt19937& random, double ms, size_t count) {
  std::vector<double> frames;
  double off = 0.0;
  for (size_t f = 0; f < count; ++f) {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += double(random()) / 4294967296.0;
    off = 0.5 * off + 0.2 * sum;
    frames.push_back(ms * (1.0 + double(f) / double(count)) * std::exp(off));
  }
  return frames;
}

TEST(Compare, IntervalsHoldTheRatioAsOftenAsTheySay) {
  std::mt19937 random(1);
  constexpr int kTrials = 1000;
  int held = 0, seen = 0;
  double width = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto a = DrawFrames(random, 4.0, 150), b = DrawFrames(random, 5.6, 150);
    const auto found = RatioOf(PairBlocks(a, b, 1), 1);
    ASSERT_TRUE(found);
    held += found->low <= 1.4 && 1.4 <= found->high;
    seen += found->low > 1.0;
    width += found->high - found->low;
  }
  EXPECT_GE(held, 0.93 * kTrials);
  EXPECT_GE(seen, 0.95 * kTrials) << "two fifths more are seen";
  EXPECT_LT(width / kTrials, 0.5);
}

TEST(Compare, BlocksPairTheSamePartsOfBothRuns) {
  std::vector<double> a(150), b(40);
  for (size_t i = 0; i < a.size(); ++i) a[i] = 1.0 + double(i) / 150;
  for (size_t i = 0; i < b.size(); ++i) b[i] = 1.0 + double(i) / 40;
  const TimePairs pairs = PairBlocks(a, b, 1);
  ASSERT_EQ(pairs.size(), 12u);
  for (const auto& [of_a, of_b] : pairs) EXPECT_NEAR(of_a, of_b, 0.05);
  EXPECT_EQ(PairBlocks(std::vector{1.0, 2.0}, b, 1).size(), 2u);
  EXPECT_EQ(PairBlocks(a, b, 819).size(), 16u) << "one more than are needed";
}

// What is the same for both in every row: `rounds` of each, or one of 150 frames.
ComparedSide DrawEqualRows(std::mt19937& random, size_t rows, size_t rounds) {
  ComparedSide side{"side", {}};
  for (size_t r = 0; r < rounds; ++r) {
    MeasuredRun& run = side.rounds.emplace_back();
    const size_t frames = rounds > 1 ? 2 : 150;
    run.frame_ms = DrawFrames(random, 4.0, frames);
    for (size_t row = 1; row < rows; ++row)
      run.stages_ms.emplace_back("stage " + std::to_string(row), DrawFrames(random, 1.0, frames));
  }
  return side;
}

// In how many of the trials a difference of equal rows is reported.
int CountFalse(size_t rows, size_t rounds, int trials) {
  std::mt19937 random(7);
  int wrong = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const ComparedSide a = DrawEqualRows(random, rows, rounds);
    const nlohmann::json found =
        nlohmann::json::parse(CompareRuns(a, DrawEqualRows(random, rows, rounds)).Json());
    EXPECT_EQ(found["rows"], rows);
    EXPECT_EQ(found["confidence"], kConfidence);
    wrong += std::ranges::any_of(found["costs"], [](const auto& row) {
      return row.contains("verdict") && row["verdict"] != "";
    });
  }
  return wrong;
}

TEST(Compare, IntervalsOfAllRowsHoldTogether) {
  // Of all trials, not of all rows.
  EXPECT_LE(CountFalse(46, 15, 300), 0.05 * 300);
  EXPECT_LE(CountFalse(200, 15, 200), 0.05 * 200);
  EXPECT_LE(CountFalse(100, 1, 200), 0.05 * 200);
}

TEST(Compare, TooFewRoundsForTheRowsAreTold) {
  std::mt19937 random(1);
  const ComparedSide a = DrawEqualRows(random, 46, 10), b = DrawEqualRows(random, 46, 10);
  const ReportTree tree = CompareRuns(a, b);
  const nlohmann::json found = nlohmann::json::parse(tree.Json());
  EXPECT_EQ(found["confidence"], 0.0);
  for (const auto& row : found["costs"]) EXPECT_FALSE(row.contains("low")) << row;
  EXPECT_NE(
      tree.Text().find("No intervals: of 10 pairs, and 11 are needed for all 46 rows together"),
      std::string::npos)
      << tree.Text();
}

// As of a machine of its own: who else used this one is no part of what is tested.
std::string RunTiny(Isa isa, uint32_t frames, bool digest = true) {
  Scenario tiny = LoadScenario("tiny");
  RunOptions options;
  options.executor = "serial";
  options.frames = frames;
  options.digest = digest;
  options.scene.isa = isa;
  RunningScenario running(tiny, options.scene);
  RunReport report = RunFrames(tiny, running, options);
  report.use = MachineUse();
  report.use.cores_allowed = report.workers;
  return MakeRunTree(report).Json();
}

nlohmann::json CompareTexts(const std::string& a, const std::string& b) {
  const ReportTree tree =
      CompareRuns({"a", {ReadMeasuredRun("a", a)}}, {"b", {ReadMeasuredRun("b", b)}});
  return nlohmann::json::parse(tree.Json());
}

TEST(Compare, ARunIsReadAsItWasPrinted) {
  const std::string a = RunTiny(BestIsa(), 30), b = RunTiny(Isa::kReference, 30);
  const nlohmann::json run = nlohmann::json::parse(a), found = CompareTexts(a, b);
  EXPECT_TRUE(found["digest"]["same"]);
  EXPECT_EQ(found["digest"]["a"], run["digest"]);
  EXPECT_EQ(found["pairs"], 12);
  ASSERT_EQ(found["settings"].size(), 1u) << found["settings"];
  EXPECT_EQ(found["settings"][0]["differs"], "isa");
  EXPECT_EQ(found["settings"][0]["b"], "reference");
  ASSERT_EQ(found["costs"].size(),
            1 + run["stages"].size() + run["layer_costs"].size() + run["character_costs"].size());
  EXPECT_NEAR(double(found["costs"][0]["a_ms"]), double(run["frame_ms"]["median"]), 1e-6);
  for (size_t s = 0; s < run["stages"].size(); ++s) {
    const nlohmann::json& cost = found["costs"][s + 1];
    EXPECT_EQ(cost["of"], run["stages"][s]["stage"]);
    EXPECT_NEAR(double(cost["a_ms"]), double(run["stages"][s]["core_ms"]["median"]), 1e-6);
    // What an interval is of can be any ratio; that it is one is not chance.
    if (cost.contains("ratio")) {
      EXPECT_LE(cost["low"], cost["ratio"]);
      EXPECT_LE(cost["ratio"], cost["high"]);
    }
  }
  EXPECT_FALSE(CompareTexts(a, RunTiny(BestIsa(), 29))["digest"]["same"]);
  EXPECT_FALSE(CompareTexts(a, RunTiny(BestIsa(), 30, false)).contains("digest"));
}

TEST(Compare, StagesThatOnlyOneHasAndSlowerOnesAreTold) {
  nlohmann::json a = nlohmann::json::parse(RunTiny(BestIsa(), 40)), b = a;
  for (auto& ms : b["samples"]["stages"]["skin"]) ms = 1.5 * double(ms);
  for (auto& ms : b["samples"]["frame_ms"]) ms = 0.5 * double(ms);
  a["samples"]["stages"]["old"] = {1.0, 2.0};
  b["samples"]["stages"]["new"] = {1.0, 2.0};
  const nlohmann::json found = CompareTexts(a.dump(), b.dump());
  const auto cost = [&](const std::string& of) {
    for (const auto& row : found["costs"])
      if (row["of"] == of) return row;
    return nlohmann::json();
  };
  EXPECT_EQ(cost("whole frame")["verdict"], "faster");
  EXPECT_EQ(cost("skin")["verdict"], "slower");
  EXPECT_NEAR(double(cost("skin")["low"]), 1.5, 1e-3);
  EXPECT_EQ(cost("roots")["verdict"], "");
  EXPECT_EQ(cost("old")["verdict"], "only in A");
  EXPECT_EQ(cost("new")["verdict"], "only in B");
  EXPECT_FALSE(cost("new").contains("a_ms"));
}

TEST(Compare, LayersThatChangedAreTold) {
  const nlohmann::json a = nlohmann::json::parse(RunTiny(BestIsa(), 40));
  nlohmann::json b = a;
  for (auto& ms : b["samples"]["layers"]["layer 2 strand5"]) ms = 1.5 * double(ms);
  b["samples"]["layers"]["layer 8 new"] = {1.0, 2.0};
  const auto compare = [](const nlohmann::json& a, const nlohmann::json& b) {
    return CompareRuns({"a", {ReadMeasuredRun("a", a.dump())}},
                       {"b", {ReadMeasuredRun("b", b.dump())}});
  };
  const ReportTree tree = compare(a, b);
  for (const auto& row : nlohmann::json::parse(tree.Json())["costs"]) {
    const std::string of = row["of"];
    if (!of.starts_with("layer ") || of == "layer 8 new") continue;
    EXPECT_EQ(row["verdict"], of == "layer 2 strand5" ? "slower" : "") << row;
  }
  const std::string text = tree.Text();
  EXPECT_NE(text.find("layer 2 strand5"), text.npos) << text;
  EXPECT_NE(text.find("layer 8 new"), text.npos) << text;
  EXPECT_EQ(text.find("layer 3 "), text.npos) << "one that did not change is for programs";
  EXPECT_NE(text.find("Of 10 layers and characters, 2 differ"), text.npos) << text;
  // Those of a program that did not say.
  nlohmann::json before = a;
  before["samples"].erase("layers");
  before["samples"].erase("characters");
  const std::string old = compare(before, a).Text();
  EXPECT_NE(old.find("A does not say what its layers cost"), old.npos) << old;
}

TEST(Compare, ARunOnAMachineThatWasNotItsOwnMakesItUnsure) {
  const nlohmann::json a = nlohmann::json::parse(RunTiny(BestIsa(), 40));
  nlohmann::json b = a;
  for (auto& ms : b["samples"]["stages"]["skin"]) ms = 1.5 * double(ms);
  for (auto& ms : b["samples"]["stages"]["roots"]) ms = 0.5 * double(ms);
  const MeasuredRun own = ReadMeasuredRun("a", a.dump()), changed = ReadMeasuredRun("b", b.dump());
  b["machine_use"]["disturbances"] = {"threads were ready for 9 ms"};
  const MeasuredRun disturbed = ReadMeasuredRun("b", b.dump());
  EXPECT_TRUE(WhyUnsure({"a", {own}}, {"b", {changed}}).empty());

  const ReportTree tree = CompareRuns({"a", {own}}, {"b", {disturbed}});
  const nlohmann::json found = nlohmann::json::parse(tree.Json());
  const auto why = WhyUnsure({"a", {own}}, {"b", {disturbed}});
  ASSERT_EQ(why.size(), 1u);
  EXPECT_EQ(why[0], "the machine was not B's own in 1 of 1 runs: threads were ready for 9 ms");
  EXPECT_EQ(found["unsure"], nlohmann::json(why));
  int unsure = 0;
  for (const auto& row : found["costs"]) {
    EXPECT_NE(row.value("verdict", ""), "slower") << row;
    EXPECT_NE(row.value("verdict", ""), "faster") << row;
    unsure += row.value("verdict", "") == "UNSURE";
  }
  EXPECT_EQ(unsure, 2);
  EXPECT_NE(tree.Text().find("UNSURE: the machine was not B's own"), std::string::npos)
      << tree.Text();
  EXPECT_EQ(WhyUnsure({"a", {own, disturbed, disturbed}}, {"b", {own, own, own}}),
            std::vector<std::string>{
                "the machine was not A's own in 2 of 3 runs: threads were ready for 9 ms"});
}

// The page is drawn by tests/command/browser_test.sh.
TEST(Compare, ThePageHasAllFramesAndNoMarkup) {
  const ComparedSide a{"<b>", {ReadMeasuredRun("a", RunTiny(BestIsa(), 12))}}, b{"b", a.rounds};
  const std::string page = ComparisonPage(a, b, CompareRuns(a, b));
  EXPECT_EQ(page.find("@PELT_"), page.npos);
  EXPECT_EQ(page.find("<b>"), page.npos);
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const size_t from = page.find(begin) + begin.size();
  const nlohmann::json data =
      nlohmann::json::parse(page.substr(from, page.find("</script", from) - from));
  EXPECT_EQ(data["comparison"]["a"], "<b>");
  EXPECT_EQ(data["frame_ms"]["a"].size(), 6u);
  EXPECT_EQ(data["frame_ms"]["b"], data["frame_ms"]["a"]);
}

void ExpectNoRun(const std::string& text, const std::string& place) {
  const std::string said = test::ErrorFrom([&] { ReadMeasuredRun("run 'a.json'", text); });
  EXPECT_EQ(said.find("run 'a.json'"), 0u) << said << " of " << text.substr(0, 60);
  EXPECT_NE(said.find(place), said.npos) << said;
}

TEST(Compare, WhatIsNoRunIsRefusedByItsPlace) {
  const std::string whole = RunTiny(BestIsa(), 4);
  ExpectNoRun(whole.substr(0, whole.size() / 2), "not one whole JSON value: line ");
  ExpectNoRun("", "not one whole JSON value: line 1");
  ExpectNoRun("[1]", "'samples' is missing");
  nlohmann::json run = nlohmann::json::parse(whole);
  const auto with = [&](const char* pointer, nlohmann::json value) {
    nlohmann::json other = run;
    other[nlohmann::json::json_pointer(pointer)] = std::move(value);
    return other.dump();
  };
  ExpectNoRun(with("/samples", nlohmann::json::object()), "'samples.frame_ms' is missing");
  ExpectNoRun(with("/samples/frame_ms/1", "x"), "'samples.frame_ms[1]' is no time: \"x\"");
  ExpectNoRun(with("/samples/frame_ms/1", -1), "'samples.frame_ms[1]' is no time: -1");
  ExpectNoRun(with("/samples/stages/skin", nlohmann::json::array()), "'samples.stages.skin'");
  ExpectNoRun(with("/samples/layers", 1), "'samples.layers' is not an object");
  ExpectNoRun(with("/samples/characters/character 0", 1), "'samples.characters.character 0'");
  ExpectNoRun(with("/digest", 4), "'digest'");
  ExpectNoRun(with("/machine_use", nlohmann::json::object()),
              "'machine_use.disturbances' is missing");
  ExpectNoRun(with("/machine_use/disturbances", {1}), "'machine_use.disturbances' is no list");
}

TEST(Compare, RoundsOfACommandAreOneRun) {
  const auto read = [](uint32_t frames) {
    return ReadMeasuredRun("x", RunTiny(BestIsa(), frames));
  };
  const ComparedSide same{"same", {read(8), read(8)}}, other{"other", {read(8), read(9)}};
  EXPECT_NO_THROW(CompareRuns(same, same));
  const std::string said = test::ErrorFrom([&] { CompareRuns(same, other); });
  EXPECT_NE(said.find("'other'"), said.npos) << said;
  EXPECT_NE(said.find("'frames' is 8 in round 1 and 9 in round 2"), said.npos) << said;
  // A digest that changes is a finding, not an error.
  ComparedSide changed = same;
  changed.rounds[1].digest = "0";
  const nlohmann::json found = nlohmann::json::parse(CompareRuns(same, changed).Json());
  EXPECT_FALSE(found["digest"]["same"]);
  EXPECT_EQ(found["digest"]["b"], "");
}

}  // namespace
}  // namespace pelt
