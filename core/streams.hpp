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
  // Layers with the modal solver.
  kModalTables,
  kVertexModal,  // ModalStateBlock<4>: lanes are mesh vertices
  kStrandModal4,
  kStrandModal5,
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

// What a stream is to the frame, and so to a digest.
enum class Role : uint8_t {
  kInput,    // constant, or filled by the caller before the frame
  kValue,    // what the frame computes: the same bits whatever runs it and whatever is skipped
  kBooking,  // what ran and why: the same on every executor, but not with other skip switches
  kScratch,  // meaningless after the pass that wrote it
};

// Which lanes of a block hold values after a frame. Lanes beyond are whatever was there before.
enum class Lanes : uint8_t {
  kAll,           // the whole block
  kLiveStrands,   // lanes below live_strands
  kLiveVertices,  // lanes below live_vertices
  kLiveChains,    // vertices in vertex-chain layers, strands otherwise
  kDrawn,         // places of the layer's order below visible_count
};

struct StreamDesc {
  std::string_view name;
  Domain domain;
  uint32_t block_bytes;
  Role role;
  Lanes lanes;
  // Chunk streams exist for layers that have all of `required` and none of `forbidden` (LayerFlag
  // bits that never change: kLayerKindFlags). This also says which stages run on which layers.
  uint32_t required;
  uint32_t forbidden;
  std::span<const RowDesc> rows;
};

const StreamDesc& DescribeStream(Stream stream);

}  // namespace pelt
