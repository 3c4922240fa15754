// One tree, two ways to print it: the text's layout and the JSON's shape.
#include "bench/report/report_tree.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

namespace pelt {
namespace {

using nlohmann::json;

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(ReportTree, ValuesThatFollowEachOtherAreOneLine) {
  ReportTree report;
  report.Add({"scene"}, "tiny")
      .Add({"frame_ms", "ms", 2}, 0.12345)
      .Add({"share", "%", 1, "", 100}, 0.5);
  report.Add({"fused"}, true).Add({"left_out"}, Value{});
  EXPECT_EQ(report.Text(), "scene tiny, frame ms 0.12 ms, share 50.0 %, fused yes\n");
  EXPECT_EQ(json::parse(report.Json()),
            json::parse(R"({"scene": "tiny", "frame_ms": 0.12345, "share": 0.5, "fused": true})"));
}

TEST(ReportTree, NumbersKeepTheirBitsAndWhatIsNoneIsNull) {
  ReportTree report;
  report.Add({"large"}, uint64_t(18446744073709551615u)).Add({"negative"}, int32_t(-3));
  report.Add({"third"}, 1.0 / 3.0).Add({"nan"}, std::numeric_limits<double>::quiet_NaN());
  report.Add({"digest"}, DigestText(0x12));
  const json read = json::parse(report.Json());
  EXPECT_EQ(read["large"], 18446744073709551615u);
  EXPECT_EQ(read["negative"], -3);
  EXPECT_EQ(read["third"].get<double>(), 1.0 / 3.0);
  EXPECT_TRUE(read["nan"].is_null());
  EXPECT_EQ(read["digest"], "0000000000000012");
}

TEST(ReportTree, TextsAreQuotedAndBadBytesReplaced) {
  ReportTree report;
  report.Add({"name"}, "a \"quoted\" \\ line\n</script>").Add({"bytes"}, "\xff!");
  const json read = json::parse(report.Json());
  EXPECT_EQ(read["name"], "a \"quoted\" \\ line\n</script>");
  EXPECT_EQ(read["bytes"], "\xef\xbf\xbd!");
}

ReportTree WideTable() {
  ReportTree report;
  report.Say("before");
  ReportTable& table = report.AddTable("passes", {{"stage"},
                                                  {"core_ms.median", "ms", 3, "median"},
                                                  {"items", "", -1, "", 1, Show::kJson},
                                                  {"stages"}});
  std::string many;
  for (int i = 0; i < 30; ++i) many += "stage_" + std::to_string(i) + ", ";
  table.Add({"skin", 0.5, 7u, many});
  table.Add({"sum", 12.25, {}, "all"}, Show::kText);
  return report;
}

TEST(ReportTree, TablesWrapTheirLastColumnAndFitTheWidth) {
  const std::vector<std::string> lines = LinesOf(WideTable().Text());
  ASSERT_GE(lines.size(), 7u);
  EXPECT_EQ(lines[0], "before");
  EXPECT_EQ(lines[1], "");
  EXPECT_EQ(lines[2], "stage  median  stages");
  EXPECT_EQ(lines[3], "           ms");
  EXPECT_TRUE(lines[4].starts_with("skin    0.500  stage_0, stage_1,")) << lines[4];
  EXPECT_TRUE(lines[5].starts_with("               stage_")) << "the rest below its beginning";
  EXPECT_EQ(lines.back(), "sum    12.250  all");
  for (const std::string& line : lines) EXPECT_LE(line.size(), kReportColumns) << line;
}

TEST(ReportTree, TheWidestTextsWrapWhereverTheyStand) {
  ReportTree report;
  ReportTable& table = report.AddTable("numbers", {{"name"}, {"value"}, {"source"}});
  std::string words;
  while (words.size() < 150) words += "word ";
  table.Add({words + "end", 5, words + "done"});
  table.Add({"short", 7, "one"});
  const std::string text = report.Text();
  size_t lines = 0;
  for (const std::string& line : LinesOf(text)) {
    EXPECT_LE(line.size(), kReportColumns) << line;
    ++lines;
  }
  EXPECT_GT(lines, 5u);
  EXPECT_NE(text.find(" end"), std::string::npos) << text;
  EXPECT_NE(text.find(" done"), std::string::npos) << text;
}

TEST(ReportTree, DottedKeysNestAndTextRowsAreNotInJson) {
  const json read = json::parse(WideTable().Json());
  ASSERT_EQ(read["passes"].size(), 1u);
  EXPECT_EQ(read["passes"][0]["core_ms"]["median"], 0.5);
  EXPECT_EQ(read["passes"][0]["items"], 7);
  EXPECT_FALSE(read.contains("before"));
}

TEST(ReportTree, MapsSectionsListsAndTexts) {
  ReportTree report;
  report.AddTable("memory", {{"name"}, {"bytes"}}).is_map = true;
  report.BeginList("loops");
  ReportTree& section = report.AddSection("totals", "in all");
  section.Add({"cycles"}, 12u).Add({"binds"}, "even pipe");
  report.AddTexts("faults", {"one", "two"}, "FAULT");
  report.AddEntry("loops", "loop a").Add({"iterations"}, 3);
  const json read = json::parse(report.Json());
  EXPECT_EQ(read["memory"], json::object());
  EXPECT_EQ(read["loops"], json::parse(R"([{"iterations": 3}])"));
  EXPECT_EQ(read["totals"]["cycles"], 12);
  EXPECT_EQ(read["faults"], json::parse(R"(["one", "two"])"));
  EXPECT_EQ(report.Text(),
            "loop a: iterations 3\nin all: cycles 12, binds even pipe\nFAULT: one\nFAULT: two\n");
}

}  // namespace
}  // namespace pelt
