// Where in a frame others had a core: what took far longer than usual while threads waited, and nothing else.
#include <gtest/gtest.h>

#include "bench/report/timeline.hpp"

namespace pelt {
namespace {

// Four items on two workers, of 1, 2, 3 and 4 ms; a tick is 0.1 ms.
constexpr double kMsPerTick = 0.1;
FrameRecord UsualFrame() {
  FrameRecord record;
  for (uint32_t i = 0; i < 4; ++i) {
    FrameRecord::Item item{};
    item.begin_ticks = 100 * i + 1;
    item.end_ticks = item.begin_ticks + 10 * (i + 1);
    item.worker = i % 2;
    item.item = i;
    item.run_count = 1;
    record.items.push_back(item);
  }
  return record;
}
FrameRecord FrameOf(uint32_t slow_item, uint64_t over_ticks, CoreWait wait) {
  FrameRecord record = UsualFrame();
  record.items[slow_item].end_ticks += over_ticks;
  record.wait = wait;
  return record;
}
const std::vector<FrameRecord> kUsual(6, UsualFrame());

std::vector<uint32_t> Found(const FrameRecord& record,
                            std::span<const FrameRecord> others = kUsual) {
  std::vector<uint32_t> at;
  for (const PreemptedItem& item : FindPreempted(record, others, kMsPerTick)) at.push_back(item.at);
  return at;
}

TEST(PreemptedItems, WhatTookLongerWhileThreadsWaitedIsFound) {
  const auto found = FindPreempted(FrameOf(1, 40, {2, 4.0}), kUsual, kMsPerTick);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].at, 1u);
  EXPECT_EQ(found[0].over_ticks, 40u);
  // A system that does not count waiting counts how often it happened.
  EXPECT_EQ(Found(FrameOf(2, 40, {1, {}})), std::vector<uint32_t>{2});
}

TEST(PreemptedItems, NoMoreIsTakenForItThanThreadsWaited) {
  EXPECT_TRUE(Found(FrameOf(1, 40, {0, 0.0})).empty()) << "no thread waited";
  EXPECT_TRUE(Found(FrameOf(1, 40, {0, {}})).empty()) << "no thread was preempted";
  EXPECT_TRUE(Found(FrameOf(1, 40, {1, 2.0})).empty()) << "half of it is something else";
  FrameRecord two = FrameOf(1, 40, {2, 5.0});
  two.items[0].end_ticks += 60;  // 6 ms and 4 ms more, of 5
  EXPECT_EQ(Found(two), std::vector<uint32_t>{0});
  two.wait.waited_ms = 10.0;
  EXPECT_EQ(Found(two), (std::vector<uint32_t>{0, 1}));
}

TEST(PreemptedItems, OtherWorkIsNotLongerWork) {
  EXPECT_TRUE(Found(FrameOf(3, 30, {1, 3.0})).empty()) << "not twice as long as usual";
  FrameRecord more = FrameOf(1, 40, {1, 4.0});
  more.items[1].run_count = 2;
  EXPECT_TRUE(Found(more).empty()) << "more stages ran on it than in any other frame";
  EXPECT_TRUE(Found(FrameOf(1, 40, {1, 4.0}), std::span(kUsual).first(4)).empty())
      << "too few frames to say what is usual";
}

}  // namespace
}  // namespace pelt
