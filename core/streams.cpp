#include "core/streams.hpp"

#include <array>
#include <cstddef>

#include "core/float_rules.hpp"

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

// What a block is made of.
template <class Block>
constexpr std::array<RowDesc, 0> kRows{};

template <>
constexpr std::array kRows<PoseBlock>{ROW(PoseBlock, translation_key),
                                      ROW(PoseBlock, rotation_key),
                                      ROW(PoseBlock, scale_key),
                                      ROW(PoseBlock, translation_weight),
                                      ROW(PoseBlock, rotation_weight),
                                      ROW(PoseBlock, scale_weight),
                                      ROW(PoseBlock, root),
                                      ROW(PoseBlock, joint_count),
                                      ROW(PoseBlock, teleported)};
template <>
constexpr std::array kRows<SkeletonBlock>{
    ROW(SkeletonBlock, parent), MakeRow<decltype(SkeletonBlock::inverse_bind)>(
                                    "inverse_bind", offsetof(SkeletonBlock, inverse_bind), true)};
template <>
constexpr std::array kRows<LocalPoseBlock>{
    ROW(LocalPoseBlock, translation), ROW(LocalPoseBlock, rotation), ROW(LocalPoseBlock, scale)};
template <>
constexpr std::array kRows<PaletteBlock>{
    MakeRow<decltype(PaletteBlock::matrix)>("matrix", offsetof(PaletteBlock, matrix), true),
    ROW(PaletteBlock, moved), ROW(PaletteBlock, teleported)};
template <>
constexpr std::array kRows<LayerBlock>{MakeRecords("parameters", 1, sizeof(LayerBlock))};
template <>
constexpr std::array kRows<LayerJointBlock>{ROW(LayerJointBlock, joint), ROW(LayerJointBlock, low),
                                            ROW(LayerJointBlock, high),
                                            ROW(LayerJointBlock, count)};
template <>
constexpr std::array kRows<BoundsBlock>{ROW(BoundsBlock, low), ROW(BoundsBlock, high)};
template <>
constexpr std::array kRows<LodBlock>{ROW(LodBlock, fraction), ROW(LodBlock, fade),
                                     ROW(LodBlock, visible), ROW(LodBlock, was_visible),
                                     ROW(LodBlock, wanted)};
template <>
constexpr std::array kRows<MeshBlock>{ROW(MeshBlock, position),    ROW(MeshBlock, normal),
                                      ROW(MeshBlock, tangent),     ROW(MeshBlock, weight),
                                      ROW(MeshBlock, row_joint),   ROW(MeshBlock, group_first_row),
                                      ROW(MeshBlock, vertex_count)};
template <>
constexpr std::array kRows<StrandBlock>{
    ROW(StrandBlock, bary),          ROW(StrandBlock, length),
    ROW(StrandBlock, width),         ROW(StrandBlock, base_colour),
    ROW(StrandBlock, tip_colour),    ROW(StrandBlock, vertex),
    ROW(StrandBlock, control),       ROW(StrandBlock, film_strip),
    ROW(StrandBlock, vertex_prefix), ROW(StrandBlock, joint_mask),
    ROW(StrandBlock, strand_count),  ROW(StrandBlock, vertex_count),
    ROW(StrandBlock, control_count), ROW(StrandBlock, first_strand)};
template <uint32_t N>
constexpr std::array kRows<RestBlock<N>>{
    ROW(RestBlock<N>, offset), ROW(RestBlock<N>, segment_length), ROW(RestBlock<N>, strength)};
template <>
constexpr std::array kRows<ChunkStateBlock>{ROW(ChunkStateBlock, flags),
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
template <>
constexpr std::array kRows<SkinnedBlock>{
    MakeRecords("vertex", kVerticesPerChunk, sizeof(SkinnedVertex))};
template <>
constexpr std::array kRows<RootBlock>{ROW(RootBlock, position), ROW(RootBlock, normal),
                                      ROW(RootBlock, tangent), ROW(RootBlock, motion)};
template <>
constexpr std::array kRows<WindBlock>{ROW(WindBlock, acceleration)};
template <uint32_t N>
constexpr std::array kRows<PointBlock<N>>{ROW(PointBlock<N>, position)};
template <>
constexpr std::array kRows<CurveBlock>{
    MakeRecords("record", kStrandsPerChunk, sizeof(CurveRecord))};
template <>
constexpr std::array kRows<RibbonBlock>{
    MakeRecords("record", kStrandsPerChunk, sizeof(RibbonRecord))};
template <>
constexpr std::array kRows<SortKeyBlock>{ROW(SortKeyBlock, key)};
template <>
constexpr std::array kRows<SortPairBlock>{MakeRecords("pair", kStrandsPerChunk, sizeof(SortPair))};
template <>
constexpr std::array kRows<DigitBlock>{ROW(DigitBlock, bin)};
template <>
constexpr std::array kRows<OrderBlock>{ROW(OrderBlock, strand)};
template <>
constexpr std::array kRows<LayerSortBlock>{ROW(LayerSortBlock, visible_count),
                                           ROW(LayerSortBlock, keys_changed),
                                           ROW(LayerSortBlock, records_changed)};
template <>
constexpr std::array kRows<DrawListBlock>{ROW(DrawListBlock, layer), ROW(DrawListBlock, count)};
template <>
constexpr std::array kRows<RibbonVertexBlock>{
    MakeRecords("vertex", kStrandsPerChunk, sizeof(RibbonVertex) * kRibbonPoints * 2)};
template <>
constexpr std::array kRows<ModalTableBlock>{MakeRecords("table", 1, sizeof(ModalTableBlock))};
template <uint32_t N>
constexpr std::array kRows<ModalStateBlock<N>>{
    ROW(ModalStateBlock<N>, direction),  ROW(ModalStateBlock<N>, velocity),
    ROW(ModalStateBlock<N>, multiplier), ROW(ModalStateBlock<N>, bend),
    ROW(ModalStateBlock<N>, bend_step),  ROW(ModalStateBlock<N>, bend_turn),
    ROW(ModalStateBlock<N>, root_step),  ROW(ModalStateBlock<N>, root_turn),
    ROW(ModalStateBlock<N>, wind),       ROW(ModalStateBlock<N>, normal),
    ROW(ModalStateBlock<N>, quiet_s)};
template <>
constexpr std::array kRows<InstanceBlock> = kRows<CurveBlock>;
#undef ROW

template <class B>
constexpr StreamDesc Describe(const StreamRow<B>& row) {
  static_assert(!kRows<B>.empty(),
                "a block whose rows are not listed is neither hashed nor located");
  return {row.name, row.domain, uint32_t(sizeof(B)), row.role, row.lanes, row.kinds,
          row.kept, kRows<B>};
}
constexpr auto kStreams =
    WithMembers(kTable<Streams>, [](const auto&... row) { return std::array{Describe(row)...}; });

}  // namespace

const StreamDesc& DescribeStream(Stream stream) { return kStreams[size_t(stream)]; }

std::string_view RoleName(Role role) {
  constexpr std::string_view kNames[] = {"input", "value", "bookkeeping", "scratch"};
  return kNames[size_t(role)];
}

}  // namespace pelt
