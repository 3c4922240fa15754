// The memory of a scene: a budget held before the first frame, a report that adds up, and what the
// scene keeps outside the block.
#include <gtest/gtest.h>

#include <string>

#include "core/error.hpp"
#include "jobs/scene.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "traces/digest.hpp"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace pelt::testing {
namespace {

bool Says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

struct Measured {
  Scenario scenario = TinyScenario();
  std::vector<const Groom*> grooms = scenario.ActorGrooms();
  SceneLayout layout = MeasureScene(grooms, {}).OrThrow();
};

TEST(MemoryBudget, ExactlyEnoughIsEnough) {
  const Measured m;
  EXPECT_EQ(FindBudgetFault(m.layout, m.layout.total_bytes), "");
  EXPECT_EQ(MeasureScene(m.grooms, {.memory_budget_bytes = m.layout.total_bytes}).error(), "");
}

TEST(MemoryBudget, OneByteLessIsRefusedAndSaysWhy) {
  const Measured m;
  const SceneOptions options{.memory_budget_bytes = m.layout.total_bytes - 1};
  const std::string error = MeasureScene(m.grooms, options).error();
  EXPECT_TRUE(Says(error, std::to_string(m.layout.total_bytes) + " bytes, 1 more")) << error;
  EXPECT_TRUE(Says(error, "strands would fit")) << error;
  EXPECT_TRUE(Says(error, "max_strands")) << error;
  EXPECT_THROW(MeasureScene(m.grooms, options).OrThrow(), Error);
  EXPECT_EQ(FurScene::Create(m.grooms, options).error(), error);
}

TEST(MemoryBudget, NamesTheLargestRangesLargestFirst) {
  const Measured m;
  const std::string fault = FindBudgetFault(m.layout, m.layout.total_bytes / 2);
  const MemoryRange *first = &m.layout.ranges[0], *second = nullptr;
  for (const MemoryRange& range : m.layout.ranges)
    if (range.bytes > first->bytes) first = &range;
  for (const MemoryRange& range : m.layout.ranges)
    if (&range != first && (!second || range.bytes > second->bytes)) second = &range;
  const size_t a = fault.find(" " + std::string(first->name) + " (");
  const size_t b = fault.find(" " + std::string(second->name) + " (");
  EXPECT_LT(a, b) << fault;
  EXPECT_NE(b, std::string::npos) << fault;
  // Half the memory: half the strands.
  const std::string half = "about " + std::to_string(m.layout.strand_count / 2);
  EXPECT_TRUE(Says(fault, half.substr(0, half.size() - 1))) << fault;
}

TEST(MemoryReport, HasEveryRangeAndTheSum) {
  const Measured m;
  const std::string table = DescribeMemory(m.layout);
  for (const MemoryRange& range : m.layout.ranges)
    EXPECT_EQ(Says(table, std::string(range.name) + " "), range.bytes != 0) << range.name;
  EXPECT_TRUE(Says(table, std::to_string(m.layout.total_bytes))) << table;
}

#if defined(__GLIBC__)
TEST(MemoryReport, TellsWhatTheSceneTakesOutsideTheBlock) {
  const Measured m;
  SceneBlock block(m.layout.total_bytes);
  const size_t before = mallinfo2().uordblks;
  const auto scene = FurScene::Create(m.grooms, {}, {block.bytes()}).OrThrow();
  const size_t taken = mallinfo2().uordblks - before;
  if (taken == 0) GTEST_SKIP() << "a sanitizer's allocator does not count";
  const uint64_t said = scene->HeapBytes();
  EXPECT_GT(said, taken / 2);
  EXPECT_LT(said, taken + taken / 2 + 16384);
}
#endif

// Streams are digested side by side: it must be what their blocks give one after another.
TEST(FrameDigest, IsThatOfItsBlocksInOrder) {
  Scenario scenario = EveryOutputScenario();
  RunningScenario running(scenario, {});
  RunFrame(running, 0);
  const FrameMemory& memory = *running.scene().CurrentFrame().memory;
  Digest frame;
  for (uint32_t s = 0; s < memory.streams.size(); ++s) {
    const StreamDesc& stream = (*memory.table)[Stream(s)];
    if (stream.role != Role::kValue || memory.streams[s].block_count == 0) continue;
    Digest digest;
    for (uint32_t i = 0; i < memory.shape->ItemCount(stream.domain); ++i) {
      const std::byte* block = memory.Block(Stream(s), i);
      if (!block) continue;
      digest.Add(memory.LiveLanes(Stream(s), i));
      AddBlock(digest, stream, block, memory.LiveLanes(Stream(s), i));
    }
    EXPECT_EQ(DigestStream(memory, Stream(s)), digest.Value()) << stream.name;
    frame.Add64(digest.Value());
  }
  EXPECT_EQ(running.scene().DigestFrame(), frame.Value());
}

}  // namespace
}  // namespace pelt::testing
