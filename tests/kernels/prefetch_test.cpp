// What kernels prefetch: between them a chunk's groups ask for every line of the rows that is
// still to come in the chunk, and for those that the next chunk begins with, and for no other twice.
#include "core/kernels/prefetch.hpp"

#include <gtest/gtest.h>

#include <map>

namespace pelt::test {
namespace {

constexpr uint32_t kPitch = 512;
struct Block {
  std::byte bytes[40 * kPitch];
};

// How often each address was asked for, in bytes from the first row on.
template <int kLanes, uint32_t kRows, uint32_t kLines>
std::map<int64_t, int> CountLines(uint32_t end) {
  std::map<int64_t, int> count;
  static const Block block{};
  for (uint32_t lane = 0; lane < end; lane += kLanes) {
    const RowsAhead<Block, kLanes, kRows, kPitch, kLines> ahead(&block, lane, end);
    const auto note = [&](const std::byte* line) { ++count[line - block.bytes]; };
    ahead.template ForEachLine<0, 3>(note);
    ahead.template ForEachLine<1, 3>(note);
    ahead.template ForEachLine<2, 3>(note);
  }
  return count;
}

template <int kLanes, uint32_t kRows, uint32_t kLines>
void ExpectEachLineOnce(uint32_t end) {
  SCOPED_TRACE(testing::Message() << kLanes << " lanes, " << kRows << " rows, " << kLines
                                  << " lines on, end " << end);
  const uint32_t line_lanes = kLanes < 16 ? 16 : uint32_t(kLanes), step = 4 * line_lanes;
  const uint32_t lines = (end + line_lanes - 1) / line_lanes;
  auto count = CountLines<kLanes, kRows, kLines>(end);
  for (uint32_t row = 0; row < kRows; ++row) {
    for (uint32_t line = kLines; line < lines + kLines; ++line) {
      const int64_t at = line < lines ? line * step : sizeof(Block) + (line - lines) * step;
      const auto found = count.find(at + row * kPitch);
      ASSERT_NE(found, count.end()) << "row " << row << ", line " << line;
      EXPECT_EQ(found->second, 1) << "row " << row << ", line " << line;
      count.erase(found);
    }
  }
  // Shares are whole rows: what is over lies behind the last row, and is less than a row a group.
  const uint32_t groups = line_lanes / kLanes;
  EXPECT_LE(count.size(), (groups - 1) * lines);
  for (const auto& [at, times] : count) EXPECT_GE(at % int64_t(sizeof(Block)), kRows * kPitch);
}

template <int kLanes>
void ExpectEachLineOnceAt() {
  for (const uint32_t end : {16u, 32u, 40u, 48u, 96u, 112u}) {
    if (end % kLanes != 0) continue;
    ExpectEachLineOnce<kLanes, 11, 1>(end);
    ExpectEachLineOnce<kLanes, 12, 2>(end);
    ExpectEachLineOnce<kLanes, 3, 1>(end);
  }
}

TEST(RowsAhead, AsksForEveryLineToComeOnce) {
  ExpectEachLineOnceAt<4>();
  ExpectEachLineOnceAt<8>();
  ExpectEachLineOnceAt<16>();
  ExpectEachLineOnceAt<32>();
}

}  // namespace
}  // namespace pelt::test
