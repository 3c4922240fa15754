#include "core/streams.hpp"

#include <array>
#include <cstddef>

#include "core/chunk.hpp"
#include "core/float_rules.hpp"
#include "core/modal/modal_block.hpp"

namespace pelt {
namespace {

template <class T>
constexpr ElementType TypeOf() {
  using E = std::remove_all_extents_t<T>;
  if constexpr (std::is_same_v<E, float>) return ElementType::kFloat;
  if constexpr (sizeof(E) == 1) return ElementType::kU8;
  if constexpr (sizeof(E) == 2) return ElementType::kU16;
  return ElementType::kU32;
}

// A row of type T, an array whose last extent is the lanes (or, lane-major, whose first is).
template <class T>
constexpr RowDesc MakeRow(std::string_view name, size_t offset, bool lane_major = false) {
  using E = std::remove_all_extents_t<T>;
  constexpr size_t kRank = std::rank_v<T>;
  constexpr size_t kLast = kRank == 0 ? 1 : std::extent_v < T, kRank == 0 ? 0 : kRank - 1 > ;
  const size_t lanes = kRank == 0 ? 1 : lane_major ? std::extent_v<T, 0> : kLast;
  return {name,        uint32_t(offset), uint32_t(sizeof(T) / sizeof(E)), uint32_t(lanes),
          TypeOf<T>(), lane_major};
}

// An array of records made of 32-bit words: hashed and reported word by word.
constexpr RowDesc MakeRecords(std::string_view name, uint32_t records, size_t record_bytes) {
  return {name, 0, uint32_t(records * record_bytes / 4), records, ElementType::kU32, true};
}

#define ROW(Block, member) MakeRow<decltype(Block::member)>(#member, offsetof(Block, member))

using Rest4 = RestBlock<4>;
using Rest5 = RestBlock<5>;
using Points4 = PointBlock<4>;
using Points5 = PointBlock<5>;
using Modal4 = ModalStateBlock<4>;
using Modal5 = ModalStateBlock<5>;

constexpr std::array kPoseRows{ROW(PoseBlock, translation_key),
                               ROW(PoseBlock, rotation_key),
                               ROW(PoseBlock, scale_key),
                               ROW(PoseBlock, translation_weight),
                               ROW(PoseBlock, rotation_weight),
                               ROW(PoseBlock, scale_weight),
                               ROW(PoseBlock, root),
                               ROW(PoseBlock, joint_count),
                               ROW(PoseBlock, teleported)};
constexpr std::array kSkeletonRows{
    ROW(SkeletonBlock, parent), MakeRow<decltype(SkeletonBlock::inverse_bind)>(
                                    "inverse_bind", offsetof(SkeletonBlock, inverse_bind), true)};
constexpr std::array kLocalPoseRows{ROW(LocalPoseBlock, translation), ROW(LocalPoseBlock, rotation),
                                    ROW(LocalPoseBlock, scale)};
constexpr std::array kPaletteRows{
    MakeRow<decltype(PaletteBlock::matrix)>("matrix", offsetof(PaletteBlock, matrix), true),
    ROW(PaletteBlock, moved), ROW(PaletteBlock, teleported)};
constexpr std::array kLayerRows{MakeRecords("parameters", 1, sizeof(LayerBlock))};
constexpr std::array kLayerJointRows{ROW(LayerJointBlock, joint), ROW(LayerJointBlock, low),
                                     ROW(LayerJointBlock, high), ROW(LayerJointBlock, count)};
constexpr std::array kBoundsRows{ROW(BoundsBlock, low), ROW(BoundsBlock, high)};
constexpr std::array kLodRows{ROW(LodBlock, fraction), ROW(LodBlock, fade), ROW(LodBlock, visible),
                              ROW(LodBlock, was_visible), ROW(LodBlock, wanted)};
constexpr std::array kMeshRows{ROW(MeshBlock, position),    ROW(MeshBlock, normal),
                               ROW(MeshBlock, tangent),     ROW(MeshBlock, weight),
                               ROW(MeshBlock, row_joint),   ROW(MeshBlock, group_first_row),
                               ROW(MeshBlock, vertex_count)};
constexpr std::array kStrandRows{ROW(StrandBlock, bary),          ROW(StrandBlock, length),
                                 ROW(StrandBlock, width),         ROW(StrandBlock, base_colour),
                                 ROW(StrandBlock, tip_colour),    ROW(StrandBlock, vertex),
                                 ROW(StrandBlock, control),       ROW(StrandBlock, film_strip),
                                 ROW(StrandBlock, vertex_prefix), ROW(StrandBlock, joint_mask),
                                 ROW(StrandBlock, strand_count),  ROW(StrandBlock, vertex_count),
                                 ROW(StrandBlock, control_count), ROW(StrandBlock, first_strand)};
constexpr std::array kRest4Rows{ROW(Rest4, offset), ROW(Rest4, segment_length),
                                ROW(Rest4, strength)};
constexpr std::array kRest5Rows{ROW(Rest5, offset), ROW(Rest5, segment_length),
                                ROW(Rest5, strength)};
constexpr std::array kChunkStateRows{ROW(ChunkStateBlock, flags),
                                     ROW(ChunkStateBlock, live_strands),
                                     ROW(ChunkStateBlock, live_vertices),
                                     ROW(ChunkStateBlock, first_new_strand),
                                     ROW(ChunkStateBlock, first_new_vertex),
                                     ROW(ChunkStateBlock, live_exact),
                                     ROW(ChunkStateBlock, fade_count),
                                     ROW(ChunkStateBlock, moved),
                                     ROW(ChunkStateBlock, was_moved),
                                     ROW(ChunkStateBlock, state_changed),
                                     ROW(ChunkStateBlock, keys_changed),
                                     ROW(ChunkStateBlock, records_changed),
                                     ROW(ChunkStateBlock, first_place),
                                     ROW(ChunkStateBlock, visible_strands)};
constexpr std::array kSkinnedRows{MakeRecords("vertex", kVerticesPerChunk, sizeof(SkinnedVertex))};
constexpr std::array kRootRows{ROW(RootBlock, position), ROW(RootBlock, normal),
                               ROW(RootBlock, tangent), ROW(RootBlock, motion)};
constexpr std::array kWindRows{ROW(WindBlock, acceleration)};
constexpr std::array kPoints4Rows{ROW(Points4, position)};
constexpr std::array kPoints5Rows{ROW(Points5, position)};
constexpr std::array kCurveRows{MakeRecords("record", kStrandsPerChunk, sizeof(CurveRecord))};
constexpr std::array kRibbonRows{MakeRecords("record", kStrandsPerChunk, sizeof(RibbonRecord))};
constexpr std::array kKeyRows{ROW(SortKeyBlock, key)};
constexpr std::array kPairRows{MakeRecords("pair", kStrandsPerChunk, sizeof(SortPair))};
constexpr std::array kDigitRows{ROW(DigitBlock, bin)};
constexpr std::array kOrderRows{ROW(OrderBlock, strand)};
constexpr std::array kLayerSortRows{ROW(LayerSortBlock, visible_count),
                                    ROW(LayerSortBlock, keys_changed),
                                    ROW(LayerSortBlock, records_changed)};
constexpr std::array kDrawListRows{ROW(DrawListBlock, layer), ROW(DrawListBlock, count)};
constexpr std::array kVertexRows{
    MakeRecords("vertex", kStrandsPerChunk, sizeof(RibbonVertex) * kRibbonPoints * 2)};
constexpr std::array kModalTableRows{MakeRecords("table", 1, sizeof(ModalTableBlock))};
#define MODAL_ROWS(Block)                                                                  \
  {                                                                                        \
    ROW(Block, direction), ROW(Block, velocity), ROW(Block, multiplier), ROW(Block, bend), \
        ROW(Block, bend_step), ROW(Block, bend_turn), ROW(Block, root_step),               \
        ROW(Block, root_turn), ROW(Block, wind), ROW(Block, normal), ROW(Block, quiet_s)   \
  }
constexpr std::array<RowDesc, 11> kModal4Rows MODAL_ROWS(Modal4);
constexpr std::array<RowDesc, 11> kModal5Rows MODAL_ROWS(Modal5);
#undef MODAL_ROWS
#undef ROW

constexpr uint32_t kVC = kLayerVertexChains, k5 = kLayerFivePoints, kRib = kLayerRibbons;
constexpr uint32_t kMod = kLayerModal;

constexpr std::array<StreamDesc, kStreamCount> kStreams{{
    {"none", Domain::kScene, 0, Role::kScratch, Lanes::kAll, 0, 0, {}},
#define STREAM(name, domain, Block, role, lanes, required, forbidden, rows)                      \
  {name, Domain::domain, uint32_t(sizeof(Block)), Role::role, Lanes::lanes, required, forbidden, \
   rows}
    STREAM("pose", kCharacter, PoseBlock, kInput, kAll, 0, 0, kPoseRows),
    STREAM("skeleton", kCharacter, SkeletonBlock, kInput, kAll, 0, 0, kSkeletonRows),
    STREAM("layers", kLayer, LayerBlock, kInput, kAll, 0, 0, kLayerRows),
    STREAM("layer_joints", kLayer, LayerJointBlock, kInput, kAll, 0, 0, kLayerJointRows),
    STREAM("mesh", kChunk, MeshBlock, kInput, kAll, 0, 0, kMeshRows),
    STREAM("strands", kChunk, StrandBlock, kInput, kAll, 0, 0, kStrandRows),
    STREAM("vertex_rest", kChunk, Rest4, kInput, kAll, kVC, 0, kRest4Rows),
    STREAM("strand_rest4", kChunk, Rest4, kInput, kAll, 0, k5, kRest4Rows),
    STREAM("strand_rest5", kChunk, Rest5, kInput, kAll, k5, 0, kRest5Rows),
    STREAM("local_pose", kCharacter, LocalPoseBlock, kValue, kAll, 0, 0, kLocalPoseRows),
    STREAM("palette", kCharacter, PaletteBlock, kValue, kAll, 0, 0, kPaletteRows),
    STREAM("bounds", kLayer, BoundsBlock, kValue, kAll, 0, 0, kBoundsRows),
    STREAM("lod", kLayer, LodBlock, kValue, kAll, 0, 0, kLodRows),
    STREAM("chunk_state", kChunk, ChunkStateBlock, kBooking, kAll, 0, 0, kChunkStateRows),
    STREAM("skinned", kChunk, SkinnedBlock, kValue, kLiveVertices, 0, 0, kSkinnedRows),
    STREAM("anchors", kChunk, RootBlock, kValue, kLiveVertices, kVC, 0, kRootRows),
    STREAM("roots", kChunk, RootBlock, kValue, kLiveStrands, 0, 0, kRootRows),
    STREAM("wind", kChunk, WindBlock, kScratch, kLiveChains, 0, 0, kWindRows),
    STREAM("vertex_points", kChunk, Points4, kValue, kLiveVertices, kVC, 0, kPoints4Rows),
    STREAM("vertex_previous", kChunk, Points4, kValue, kLiveVertices, kVC, kMod, kPoints4Rows),
    STREAM("strand_points4", kChunk, Points4, kValue, kLiveStrands, 0, k5, kPoints4Rows),
    STREAM("strand_previous4", kChunk, Points4, kValue, kLiveStrands, 0, k5 | kVC | kMod,
           kPoints4Rows),
    STREAM("strand_points5", kChunk, Points5, kValue, kLiveStrands, k5, 0, kPoints5Rows),
    STREAM("strand_previous5", kChunk, Points5, kValue, kLiveStrands, k5, kMod, kPoints5Rows),
    STREAM("curves", kChunk, CurveBlock, kValue, kLiveStrands, 0, kRib, kCurveRows),
    STREAM("ribbons", kChunk, RibbonBlock, kValue, kLiveStrands, kRib, 0, kRibbonRows),
    STREAM("sort_keys", kChunk, SortKeyBlock, kValue, kAll, 0, 0, kKeyRows),
    STREAM("sort_pairs_a", kChunk, SortPairBlock, kScratch, kAll, 0, 0, kPairRows),
    STREAM("sort_pairs_b", kChunk, SortPairBlock, kScratch, kAll, 0, 0, kPairRows),
    STREAM("digits", kChunk, DigitBlock, kScratch, kAll, 0, 0, kDigitRows),
    STREAM("order", kChunk, OrderBlock, kValue, kDrawn, 0, 0, kOrderRows),
    STREAM("layer_sort", kLayer, LayerSortBlock, kBooking, kAll, 0, 0, kLayerSortRows),
    STREAM("draw_list", kScene, DrawListBlock, kValue, kAll, 0, 0, kDrawListRows),
    STREAM("instances", kChunk, InstanceBlock, kValue, kDrawn, 0, kRib, kCurveRows),
    STREAM("ribbon_vertices", kChunk, RibbonVertexBlock, kValue, kDrawn, kRib, 0, kVertexRows),
    STREAM("modal_tables", kLayer, ModalTableBlock, kInput, kAll, kMod, 0, kModalTableRows),
    STREAM("vertex_modal", kChunk, Modal4, kValue, kLiveVertices, kMod | kVC, 0, kModal4Rows),
    STREAM("strand_modal4", kChunk, Modal4, kValue, kLiveStrands, kMod, k5 | kVC, kModal4Rows),
    STREAM("strand_modal5", kChunk, Modal5, kValue, kLiveStrands, kMod | k5, 0, kModal5Rows),
#undef STREAM
}};

}  // namespace

const StreamDesc& DescribeStream(Stream stream) { return kStreams[size_t(stream)]; }

}  // namespace pelt
