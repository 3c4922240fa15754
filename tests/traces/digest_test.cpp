// Digests: every live value counts, nothing else does, and a difference is named.
#include "traces/digest.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "core/chunk.hpp"
#include "core/kernels/frame_table.hpp"

namespace pelt {
namespace {

uint64_t DigestOf(Stream stream, const void* block, uint32_t lanes) {
  Digest digest;
  AddBlock(digest, DescribeStream(stream), block, lanes);
  return digest.Value();
}

TEST(Digest, FollowsTheWordsAndTheirOrder) {
  const auto of = [](std::initializer_list<uint32_t> words) {
    Digest d;
    for (uint32_t w : words) d.Add(w);
    return d.Value();
  };
  EXPECT_EQ(of({1, 2, 3}), of({1, 2, 3}));
  EXPECT_NE(of({1, 2, 3}), of({1, 3, 2}));
  EXPECT_NE(of({1, 2}), of({1, 2, 0}));
  EXPECT_NE(of({}), of({0}));
}

// The algorithm is part of every golden file: a change of it must be seen here first.
TEST(Digest, IsWhatItWas) {
  Digest d;
  d.Add(1);
  d.Add64(0x0123456789abcdefull);
  EXPECT_EQ(d.Value(), 0x71e7ff814e2cfc8dull);  // worked out by hand from the header's words
}

TEST(Digest, EveryBitOfEveryLiveLaneCounts) {
  auto block = std::make_unique<RootBlock>();
  const uint64_t before = DigestOf(StreamOf<&Streams::roots>, block.get(), 5);
  auto* words = reinterpret_cast<uint32_t*>(block.get());
  for (uint32_t w = 0; w < sizeof(RootBlock) / 4; ++w) {
    for (const uint32_t bit : {0u, 31u}) {
      words[w] ^= 1u << bit;
      const bool live = w % kStrandsPerChunk < 5;
      EXPECT_EQ(DigestOf(StreamOf<&Streams::roots>, block.get(), 5) != before, live) << w;
      words[w] ^= 1u << bit;
    }
  }
}

TEST(Digest, RecordsCountLaneByLane) {
  auto block = std::make_unique<CurveBlock>();
  const uint64_t before = DigestOf(StreamOf<&Streams::curves>, block.get(), 3);
  block->record[2].tag = 1;
  EXPECT_NE(DigestOf(StreamOf<&Streams::curves>, block.get(), 3), before);
  block->record[2].tag = 0;
  block->record[3].tag = 1;
  EXPECT_EQ(DigestOf(StreamOf<&Streams::curves>, block.get(), 3), before);
}

TEST(Digest, StreamsOfWholeBlocksIgnoreTheLaneCount) {
  auto keys = std::make_unique<SortKeyBlock>();
  EXPECT_EQ(DigestOf(StreamOf<&Streams::sort_keys>, keys.get(), 0),
            DigestOf(StreamOf<&Streams::sort_keys>, keys.get(), kStrandsPerChunk));
  const uint64_t before = DigestOf(StreamOf<&Streams::sort_keys>, keys.get(), 0);
  keys->key[kStrandsPerChunk - 1] = 1;
  EXPECT_NE(DigestOf(StreamOf<&Streams::sort_keys>, keys.get(), 0), before);
}

TEST(Digest, SignsOfZeroAndPayloadsOfNanCount) {
  auto block = std::make_unique<RootBlock>();
  const uint64_t plus = DigestOf(StreamOf<&Streams::roots>, block.get(), 1);
  block->position[0][0] = -0.0f;
  EXPECT_NE(DigestOf(StreamOf<&Streams::roots>, block.get(), 1), plus);
}

TEST(FindDifference, NamesRowComponentLaneAndBothValues) {
  auto left = std::make_unique<RootBlock>(), right = std::make_unique<RootBlock>();
  const StreamDesc& stream = DescribeStream(StreamOf<&Streams::roots>);
  EXPECT_FALSE(FindDifference(stream, left.get(), right.get(), kStrandsPerChunk).differs);
  right->tangent[2][7] = 1.0f;
  const BlockDifference d = FindDifference(stream, left.get(), right.get(), kStrandsPerChunk);
  ASSERT_TRUE(d.differs);
  EXPECT_EQ(d.row->name, "tangent");
  EXPECT_EQ(d.component, 2u);
  EXPECT_EQ(d.lane, 7u);
  EXPECT_EQ(d.left, 0u);
  EXPECT_EQ(d.right, 0x3f800000u);
  EXPECT_FALSE(FindDifference(stream, left.get(), right.get(), 7).differs) << "lane 7 is not live";
}

TEST(FindDifference, CountsWordsOfRecords) {
  auto left = std::make_unique<CurveBlock>(), right = std::make_unique<CurveBlock>();
  right->record[9].curve[1][2] = -2.0f;  // word 5 of the record
  const BlockDifference d = FindDifference(DescribeStream(StreamOf<&Streams::curves>), left.get(),
                                           right.get(), kStrandsPerChunk);
  ASSERT_TRUE(d.differs);
  EXPECT_EQ(d.lane, 9u);
  EXPECT_EQ(d.component, 5u);
  EXPECT_EQ(d.right, 0xc0000000u);
}

// The table of rows must cover every byte a block has but its padding: what no row names no digest
// would ever see.
TEST(StreamTable, RowsCoverBlocksUpToTheirPadding) {
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& stream = DescribeStream(Stream(s));
    std::vector<bool> covered(stream.block_bytes, false);
    uint32_t end = 0;
    for (const RowDesc& row : stream.rows) {
      const uint32_t element = row.type == ElementType::kU8    ? 1
                               : row.type == ElementType::kU16 ? 2
                                                               : 4;
      ASSERT_LE(row.offset_bytes + element * row.element_count, stream.block_bytes)
          << stream.name << '.' << row.name;
      EXPECT_EQ(row.element_count % row.lane_count, 0u) << stream.name << '.' << row.name;
      for (uint32_t b = 0; b < element * row.element_count; ++b) {
        EXPECT_FALSE(covered[row.offset_bytes + b]) << stream.name << '.' << row.name << " twice";
        covered[row.offset_bytes + b] = true;
      }
      end = std::max(end, row.offset_bytes + element * row.element_count);
    }
    for (uint32_t b = 0; b < end; ++b)
      ASSERT_TRUE(covered[b]) << stream.name << ": byte " << b << " belongs to no row";
    EXPECT_LT(stream.block_bytes - end, 128u) << stream.name << ": rows missing at the end";
    EXPECT_EQ(stream.block_bytes % 128, 0u) << stream.name;
  }
}

}  // namespace
}  // namespace pelt
