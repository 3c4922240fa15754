// The streams of a frame: every named array of blocks, what its items stand for and which rows it
// has. Adding a stream is one line in the enum and one in streams.cpp; digests, memory, mismatch
// reports and the local-store executor all read this table.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/kernel.hpp"

namespace pelt {

enum class Stream : uint8_t {
  kNone,
  // Baked or filled by the caller before the frame.
  kPose,
  kSkeleton,
  kLayers,
  kLayerJoints,
  kMesh,
  kStrands,
  kVertexRest,   // RestBlock<4>: chains at mesh vertices
  kStrandRest4,  // RestBlock<4>: strands of vertex-chain layers, and 4-point chains
  kStrandRest5,
  // Written in the frame.
  kLocalPose,
  kPalette,
  kBounds,
  kLod,
  kChunkState,
  kSkinned,
  kAnchors,  // RootBlock: lanes are mesh vertices
  kRoots,    // RootBlock: lanes are strands
  kWind,     // lanes are chains
  kVertexPoints,
  kVertexPrevious,
  kStrandPoints4,
  kStrandPrevious4,
  kStrandPoints5,
  kStrandPrevious5,
  kCurves,
  kRibbons,
  kSortKeys,
  kSortPairsA,
  kSortPairsB,
  kDigits,
  kOrder,
  kLayerSort,
  kDrawList,
  kInstances,
  kRibbonVertices,
  kCount,
};
inline constexpr uint32_t kStreamCount = uint32_t(Stream::kCount);

enum class ElementType : uint8_t { kFloat, kU32, kU16, kU8 };

// One named array of a block. Rows are [component][lane]; records (lane_major) are
// [lane][component].
struct RowDesc {
  std::string_view name;
  uint32_t offset_bytes;
  uint32_t element_count;
  uint32_t lane_count;
  ElementType type;
  bool lane_major;
};

struct StreamDesc {
  std::string_view name;
  Domain domain;
  uint32_t block_bytes;
  bool baked;  // an input: constant or filled by the caller
  std::span<const RowDesc> rows;
};

const StreamDesc& DescribeStream(Stream stream);

}  // namespace pelt
