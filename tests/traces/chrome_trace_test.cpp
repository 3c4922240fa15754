// Chrome traces as text: that what a timeline says is in the file as viewers want it, and that the
// checker which says so finds every kind of broken file.
#include "traces/chrome_trace.hpp"

#include <gtest/gtest.h>

#include "tests/traces/trace_checker.hpp"

namespace pelt::testing {
namespace {

// Two tracks; on the first a frame over two passes that touch, the second pass over two items that
// touch; on the second track one item. An arrow from the first pass to the item next door.
Timeline SmallTimeline() {
  Timeline timeline;
  timeline.process = "small";
  timeline.metadata = {{"scene", "a \"quoted\" <name>"}, {"digest", "0123456789abcdef"}};
  timeline.names = {"frame", "pass 0", "pass 1", "item", "palette"};
  timeline.tracks = {{"worker 0 (caller)",
                      {{0, 0, 1'000, 9'000},
                       {1, 1, 1'000, 4'001},
                       {2, 1, 4'001, 9'000},
                       {3, 2, 4'002, 5'123},
                       {3, 2, 5'123, 8'999}}},
                     {"worker 1", {{2, 0, 4'001, 9'000}, {3, 1, 4'500, 4'501}}}};
  timeline.flows = {{4, {0, 1}, {1, 1}}, {4, {0, 1}, {0, 3}}};
  timeline.counters = {
      {"strands", {"live", "drawn"}, {{1'000, {40'000, 20'000}}, {9'000, {0, 0.5}}}}};
  return timeline;
}

bool HasFault(const CheckedTrace& trace, const std::string& text) {
  for (const std::string& fault : trace.faults)
    if (fault.find(text) != std::string::npos) return true;
  return false;
}

TEST(ChromeTrace, SaysWhatTheTimelineSays) {
  const std::string text = ChromeTrace(SmallTimeline());
  const CheckedTrace trace = TraceChecker::Check(text);
  EXPECT_EQ(trace.faults, std::vector<std::string>{});
  EXPECT_EQ(trace.threads, (std::map<int, std::string>{{1, "worker 0 (caller)"}, {2, "worker 1"}}));
  ASSERT_EQ(trace.slices.size(), 7u);
  const TraceSlice& last = trace.slices.back();  // ends with the frame, and is on the second track
  EXPECT_EQ(last.name, "pass 1");
  EXPECT_EQ(last.tid, 2);
  EXPECT_DOUBLE_EQ(last.begin_us, 4.001);
  EXPECT_DOUBLE_EQ(last.end_us, 9.0);
  ASSERT_EQ(trace.flows.size(), 2u);
  const TraceFlow& flow = trace.flows.at(1);
  EXPECT_EQ(flow.name, "palette");
  EXPECT_EQ(flow.from, (std::vector<std::string>{"frame", "pass 0"}));
  EXPECT_EQ(flow.to, (std::vector<std::string>{"pass 1", "item"}));
  EXPECT_DOUBLE_EQ(flow.leave_us, 4.0);
  EXPECT_EQ(trace.samples.at("strands"), 2);
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["otherData"]["scene"], "a \"quoted\" <name>");
  EXPECT_EQ(json["otherData"]["digest"], "0123456789abcdef");
}

TEST(ChromeTrace, OfNothingIsStillATrace) {
  Timeline timeline;
  timeline.process = "nothing";
  const CheckedTrace trace = TraceChecker::Check(ChromeTrace(timeline));
  EXPECT_EQ(trace.faults, std::vector<std::string>{});
  EXPECT_TRUE(trace.slices.empty());
}

TEST(ChromeTrace, NamesOfAnyBytesStayJson) {
  Timeline timeline = SmallTimeline();
  // A quotation mark, a control character, a cut and an overlong sequence, a surrogate, Latin-1.
  for (const char* name :
       {"\"", "\\\n", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "gr\xfc\xdf", "\xf5"}) {
    timeline.names[3] = name;
    const CheckedTrace trace = TraceChecker::Check(ChromeTrace(timeline));
    EXPECT_EQ(trace.faults, std::vector<std::string>{}) << ::testing::PrintToString(name);
  }
  timeline.names[3] = "grün, 毛, 🦊";
  EXPECT_EQ(TraceChecker::Check(ChromeTrace(timeline)).slices.front().name, "pass 0");
  EXPECT_NE(ChromeTrace(timeline).find("\"grün, 毛, 🦊\""), std::string::npos);
}

// What must not be written, written: the checker has to see each.
TEST(ChromeTrace, ALeakingSliceIsSeen) {
  Timeline timeline = SmallTimeline();
  timeline.tracks[0].slices[4].end_ns = 9'500;  // past its pass and its frame
  EXPECT_TRUE(HasFault(TraceChecker::Check(ChromeTrace(timeline)), "leaks out of"));
}

TEST(ChromeTrace, AnOverlappingSliceIsSeen) {
  Timeline timeline = SmallTimeline();
  timeline.names.push_back("item 2");
  timeline.tracks[0].slices[4].name = 5;
  timeline.tracks[0].slices[4].begin_ns = 5'100;  // before the item ahead of it ends
  EXPECT_TRUE(HasFault(TraceChecker::Check(ChromeTrace(timeline)), "leaks out of"));
}

TEST(ChromeTrace, AFlowWithoutASliceIsSeen) {
  Timeline timeline = SmallTimeline();
  std::string text = ChromeTrace(timeline);
  const auto moved = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) changed.replace(at, from.size(), to);
    return TraceChecker::Check(changed);
  };
  EXPECT_TRUE(HasFault(moved("\"ph\": \"s\", \"ts\": 4.000, \"pid\": 1, \"tid\": 1",
                             "\"ph\": \"s\", \"ts\": 4.000, \"pid\": 1, \"tid\": 2"),
                       "leaves no slice"));
  EXPECT_TRUE(HasFault(moved("\"id\": 1}", "\"id\": 7}"), "has no end"));
  EXPECT_TRUE(HasFault(moved("\"id\": 1, \"bp\"", "\"id\": 2, \"bp\""), "two ends"));
  EXPECT_TRUE(HasFault(moved(", \"bp\": \"e\"", ""), "not bound"));
  EXPECT_TRUE(HasFault(moved("\"ts\": 9.000", "\"ts\": 0.500"), "comes after"));
  EXPECT_TRUE(HasFault(moved("\"thread_name\"", "\"thread_nam\""), "without a name"));
  EXPECT_TRUE(HasFault(moved("\"live\": 40000", "\"live\": \"many\""), "not a number"));
}

TEST(ChromeTrace, ACutFileIsSeen) {
  std::string text = ChromeTrace(SmallTimeline());
  EXPECT_FALSE(TraceChecker::Check(text.substr(0, text.size() / 2)).faults.empty());
  // And one that is cut between events, and closed.
  const size_t end = text.find(",\n{\"ph\": \"E\", \"ts\": 9.000");
  EXPECT_TRUE(HasFault(TraceChecker::Check(text.substr(0, end) + "\n]}"), "never ends"));
}

TEST(ChromeTrace, ABackwardFlowIsSeen) {
  Timeline timeline = SmallTimeline();
  timeline.flows = {{4, {0, 4}, {0, 1}}};
  EXPECT_TRUE(HasFault(TraceChecker::Check(ChromeTrace(timeline)), "backwards"));
}

}  // namespace
}  // namespace pelt::testing
