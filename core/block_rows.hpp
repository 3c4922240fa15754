// What the blocks of fur are made of (core/block_members.hpp).
//
// Digests, mismatch reports, the groom file, `pelt diff`, the check of a groom and the tests' own
// check go through these lists, in their order, which is that of the block and of the file.
#pragma once

#include "core/block_members.hpp"
#include "core/chunk.hpp"
#include "core/layer.hpp"
#include "core/modal/modal_block.hpp"

namespace pelt {

// Far outside any character, and small enough that the square of a skinned position is finite.
inline constexpr float kLargest = 1.0e6f;
inline constexpr float kLongest_m = 100.0f;

// clang-format off
template <>
inline constexpr auto kBlockMembers<PoseBlock> = std::tuple{
    PELT_MEMBER(PoseBlock, translation_key),
    PELT_MEMBER(PoseBlock, rotation_key),
    PELT_MEMBER(PoseBlock, scale_key),
    PELT_MEMBER(PoseBlock, translation_weight),
    PELT_MEMBER(PoseBlock, rotation_weight),
    PELT_MEMBER(PoseBlock, scale_weight),
    PELT_MEMBER(PoseBlock, root),
    PELT_MEMBER(PoseBlock, joint_count),
    PELT_MEMBER(PoseBlock, teleported)};
template <>
inline constexpr auto kBlockMembers<PoseRateBlock> = std::tuple{
    PELT_MEMBER(PoseRateBlock, translation),
    PELT_MEMBER(PoseRateBlock, spin),
    PELT_MEMBER(PoseRateBlock, scale),
    PELT_MEMBER(PoseRateBlock, root),
    PELT_MEMBER(PoseRateBlock, given)};
template <>
inline constexpr auto kBlockMembers<PaletteRateBlock> = std::tuple{
    PELT_MEMBER(PaletteRateBlock, matrix).ByLane()};
template <>
inline constexpr auto kBlockMembers<SkeletonBlock> = std::tuple{
    PELT_MEMBER(SkeletonBlock, parent),
    PELT_MEMBER(SkeletonBlock, inverse_bind).ByLane()};
template <>
inline constexpr auto kBlockMembers<LocalPoseBlock> = std::tuple{
    PELT_MEMBER(LocalPoseBlock, translation),
    PELT_MEMBER(LocalPoseBlock, rotation),
    PELT_MEMBER(LocalPoseBlock, scale)};
template <>
inline constexpr auto kBlockMembers<PaletteBlock> = std::tuple{
    PELT_MEMBER(PaletteBlock, matrix).ByLane(),
    PELT_MEMBER(PaletteBlock, moved),
    PELT_MEMBER(PaletteBlock, teleported)};
template <>
inline constexpr auto kBlockMembers<LayerBlock> = std::tuple{
    BlockRecord<LayerBlock>{"parameters"}};
template <>
inline constexpr auto kBlockMembers<LayerOriginBlock> = std::tuple{
    PELT_MEMBER(LayerOriginBlock, shift),
    PELT_MEMBER(LayerOriginBlock, shifted),
    PELT_MEMBER(LayerOriginBlock, eye)};
template <>
inline constexpr auto kBlockMembers<LayerJointBlock> = std::tuple{
    PELT_MEMBER(LayerJointBlock, joint),
    PELT_MEMBER(LayerJointBlock, low).Within(-kLargest, kLargest),
    PELT_MEMBER(LayerJointBlock, high).Within(-kLargest, kLargest),
    PELT_MEMBER(LayerJointBlock, count)};
template <>
inline constexpr auto kBlockMembers<BoundsBlock> = std::tuple{
    PELT_MEMBER(BoundsBlock, low),
    PELT_MEMBER(BoundsBlock, high)};
template <>
inline constexpr auto kBlockMembers<LodBlock> = std::tuple{
    PELT_MEMBER(LodBlock, fraction),
    PELT_MEMBER(LodBlock, fade),
    PELT_MEMBER(LodBlock, visible),
    PELT_MEMBER(LodBlock, was_visible),
    PELT_MEMBER(LodBlock, wanted),
    PELT_MEMBER(LodBlock, chain_level),
    PELT_MEMBER(LodBlock, parent_share)};
template <>
inline constexpr auto kBlockMembers<LayerSortBlock> = std::tuple{
    PELT_MEMBER(LayerSortBlock, visible_count),
    PELT_MEMBER(LayerSortBlock, keys_changed),
    PELT_MEMBER(LayerSortBlock, records_changed)};
template <>
inline constexpr auto kBlockMembers<PatchBlock> = std::tuple{
    PELT_MEMBER(PatchBlock, joint_mask),
    PELT_MEMBER(PatchBlock, live_from).Within(0.0f, 1.0f),
    PELT_MEMBER(PatchBlock, vertex_count)};
template <>
inline constexpr auto kBlockMembers<ChainParentBlock> = std::tuple{
    PELT_MEMBER(ChainParentBlock, lanes),
    PELT_MEMBER(ChainParentBlock, share).Within(0.0f, 1.001f)};
template <>
inline constexpr auto kBlockMembers<MeshBlock> = std::tuple{
    PELT_MEMBER(MeshBlock, position).Within(-kLargest, kLargest),
    PELT_MEMBER(MeshBlock, normal).Within(-2.0f, 2.0f),
    PELT_MEMBER(MeshBlock, tangent).Within(-2.0f, 2.0f),
    PELT_MEMBER(MeshBlock, weight).Within(0.0f, 1.001f),
    PELT_MEMBER(MeshBlock, row_joint),
    PELT_MEMBER(MeshBlock, group_first_row),
    PELT_MEMBER(MeshBlock, vertex_count)};
template <>
inline constexpr auto kBlockMembers<StrandBlock> = std::tuple{
    PELT_MEMBER(StrandBlock, bary).Within(-1.0e-3f, 1.001f),
    PELT_MEMBER(StrandBlock, length).Within(0.0f, kLongest_m),
    PELT_MEMBER(StrandBlock, width).Within(0.0f, kLongest_m),
    PELT_MEMBER(StrandBlock, base_colour),
    PELT_MEMBER(StrandBlock, tip_colour),
    PELT_MEMBER(StrandBlock, vertex),
    PELT_MEMBER(StrandBlock, control),
    PELT_MEMBER(StrandBlock, film_strip),
    PELT_MEMBER(StrandBlock, joint_mask),
    PELT_MEMBER(StrandBlock, strand_count),
    PELT_MEMBER(StrandBlock, vertex_count),
    PELT_MEMBER(StrandBlock, control_count),
    PELT_MEMBER(StrandBlock, first_strand)};
template <>
inline constexpr auto kBlockMembers<HaloBlock> = std::tuple{PELT_MEMBER(HaloBlock, vertex)};
template <>
inline constexpr auto kBlockMembers<PatchListBlock> = std::tuple{PELT_MEMBER(PatchListBlock, patch)};
template <uint32_t N>
inline constexpr auto kBlockMembers<RestBlock<N>> = std::tuple{
    PELT_MEMBER(RestBlock<N>, offset).Within(-kLongest_m, kLongest_m),
    PELT_MEMBER(RestBlock<N>, segment_length).Within(0.0f, kLongest_m),
    PELT_MEMBER(RestBlock<N>, strength).Within(0.0f, 1.0f)};
template <>
inline constexpr auto kBlockMembers<ChunkStateBlock> = std::tuple{
    PELT_MEMBER(ChunkStateBlock, flags),
    PELT_MEMBER(ChunkStateBlock, live_strands),
    PELT_MEMBER(ChunkStateBlock, live_vertices),
    PELT_MEMBER(ChunkStateBlock, first_new_strand),
    PELT_MEMBER(ChunkStateBlock, first_new_vertex),
    PELT_MEMBER(ChunkStateBlock, live_exact),
    PELT_MEMBER(ChunkStateBlock, fade_count),
    PELT_MEMBER(ChunkStateBlock, moved),
    PELT_MEMBER(ChunkStateBlock, was_moved),
    PELT_MEMBER(ChunkStateBlock, state_changed),
    PELT_MEMBER(ChunkStateBlock, keys_changed),
    PELT_MEMBER(ChunkStateBlock, records_changed),
    PELT_MEMBER(ChunkStateBlock, first_place),
    PELT_MEMBER(ChunkStateBlock, visible_strands),
    PELT_MEMBER(ChunkStateBlock, live_chains),
    PELT_MEMBER(ChunkStateBlock, first_new_chain),
    PELT_MEMBER(ChunkStateBlock, whole_chains),
    PELT_MEMBER(ChunkStateBlock, parent_share),
    PELT_MEMBER(ChunkStateBlock, cut)};
template <>
inline constexpr auto kBlockMembers<SkinnedBlock> = std::tuple{PELT_MEMBER(SkinnedBlock, vertex)};
template <>
inline constexpr auto kBlockMembers<RootBlock> = std::tuple{
    PELT_MEMBER(RootBlock, position),
    PELT_MEMBER(RootBlock, normal),
    PELT_MEMBER(RootBlock, tangent),
    PELT_MEMBER(RootBlock, motion)};
template <>
inline constexpr auto kBlockMembers<RootRateBlock> = std::tuple{
    PELT_MEMBER(RootRateBlock, velocity),
    PELT_MEMBER(RootRateBlock, spin)};
template <>
inline constexpr auto kBlockMembers<WindBlock> = std::tuple{PELT_MEMBER(WindBlock, acceleration)};
template <uint32_t N>
inline constexpr auto kBlockMembers<PointBlock<N>> = std::tuple{
    PELT_MEMBER(PointBlock<N>, position)};
template <>
inline constexpr auto kBlockMembers<LoadBlock> = std::tuple{PELT_MEMBER(LoadBlock, vertex)};
template <>
inline constexpr auto kBlockMembers<VertexRateBlock> = std::tuple{
    PELT_MEMBER(VertexRateBlock, vertex)};
template <>
inline constexpr auto kBlockMembers<CurveBlock> = std::tuple{PELT_MEMBER(CurveBlock, record)};
template <>
inline constexpr auto kBlockMembers<RibbonBlock> = std::tuple{PELT_MEMBER(RibbonBlock, record)};
template <>
inline constexpr auto kBlockMembers<SortKeyBlock> = std::tuple{PELT_MEMBER(SortKeyBlock, key)};
template <>
inline constexpr auto kBlockMembers<SortPairBlock> = std::tuple{PELT_MEMBER(SortPairBlock, pair)};
template <>
inline constexpr auto kBlockMembers<DigitBlock> = std::tuple{PELT_MEMBER(DigitBlock, bin)};
template <>
inline constexpr auto kBlockMembers<OrderBlock> = std::tuple{PELT_MEMBER(OrderBlock, strand)};
template <>
inline constexpr auto kBlockMembers<DrawListBlock> = std::tuple{
    PELT_MEMBER(DrawListBlock, layer),
    PELT_MEMBER(DrawListBlock, count)};
template <>
inline constexpr auto kBlockMembers<InstanceBlock> = std::tuple{
    PELT_MEMBER(InstanceBlock, instance)};
template <>
inline constexpr auto kBlockMembers<RibbonVertexBlock> = std::tuple{
    PELT_MEMBER(RibbonVertexBlock, vertex)};
template <>
inline constexpr auto kBlockMembers<LineVertexBlock> = std::tuple{
    PELT_MEMBER(LineVertexBlock, vertex)};
template <>
inline constexpr auto kBlockMembers<StrandUvBlock> = std::tuple{PELT_MEMBER(StrandUvBlock, uv)};
template <>
inline constexpr auto kBlockMembers<PaintBlock> = std::tuple{PELT_MEMBER(PaintBlock, amounts)};
template <>
inline constexpr auto kBlockMembers<LookBlock> = std::tuple{PELT_MEMBER(LookBlock, record)};
template <>
inline constexpr auto kBlockMembers<LayerLightBlock> = std::tuple{
    PELT_MEMBER(LayerLightBlock, harmonics),
    PELT_MEMBER(LayerLightBlock, ambient),
    PELT_MEMBER(LayerLightBlock, sun_direction),
    PELT_MEMBER(LayerLightBlock, sun_rgb),
    PELT_MEMBER(LayerLightBlock, rim_direction),
    PELT_MEMBER(LayerLightBlock, rim_rgb),
    PELT_MEMBER(LayerLightBlock, rim_exponent)};
template <>
inline constexpr auto kBlockMembers<ShellLayerBlock> = std::tuple{
    PELT_MEMBER(ShellLayerBlock, most),
    PELT_MEMBER(ShellLayerBlock, shadow),
    PELT_MEMBER(ShellLayerBlock, texture_repeat),
    PELT_MEMBER(ShellLayerBlock, cone),
    PELT_MEMBER(ShellLayerBlock, cone_kind)};
template <>
inline constexpr auto kBlockMembers<ShellSkinBlock> = std::tuple{
    PELT_MEMBER(ShellSkinBlock, uv).ByLane().Within(-kLargest, kLargest),
    PELT_MEMBER(ShellSkinBlock, base_colour),
    PELT_MEMBER(ShellSkinBlock, tip_colour)};
template <>
inline constexpr auto kBlockMembers<ShellVertexBlock> = std::tuple{
    PELT_MEMBER(ShellVertexBlock, vertex)};
template <>
inline constexpr auto kBlockMembers<ShellLodBlock> = std::tuple{
    PELT_MEMBER(ShellLodBlock, shell),
    PELT_MEMBER(ShellLodBlock, count),
    PELT_MEMBER(ShellLodBlock, texture_repeat)};
template <>
inline constexpr auto kBlockMembers<DownBlock> = std::tuple{
    PELT_MEMBER(DownBlock, down).Within(-1.01f, 1.01f)};
template <>
inline constexpr auto kBlockMembers<TraitBlock> = std::tuple{
    PELT_MEMBER(TraitBlock, stiffness).Within(0.0f, 100.0f),
    PELT_MEMBER(TraitBlock, drag).Within(-1.0e3f, 1.0e4f),
    PELT_MEMBER(TraitBlock, clump).Within(0.0f, 10.0f),
    PELT_MEMBER(TraitBlock, weight).Within(0.0f, 10.0f),
    PELT_MEMBER(TraitBlock, bounce).Within(0.0f, 10.0f),
    PELT_MEMBER(TraitBlock, least_cosine).Within(-2.0f, 1.0f)};
template <>
inline constexpr auto kBlockMembers<FinEdgeBlock> = std::tuple{PELT_MEMBER(FinEdgeBlock, owned)};
template <>
inline constexpr auto kBlockMembers<FinBlock> = std::tuple{PELT_MEMBER(FinBlock, fade)};
template <>
inline constexpr auto kBlockMembers<ModalTableBlock> = std::tuple{
    BlockRecord<ModalTableBlock>{"table"}};
template <uint32_t N>
inline constexpr auto kBlockMembers<ModalStateBlock<N>> = std::tuple{
    PELT_MEMBER(ModalStateBlock<N>, direction),
    PELT_MEMBER(ModalStateBlock<N>, velocity),
    PELT_MEMBER(ModalStateBlock<N>, multiplier),
    PELT_MEMBER(ModalStateBlock<N>, bend),
    PELT_MEMBER(ModalStateBlock<N>, bend_step),
    PELT_MEMBER(ModalStateBlock<N>, bend_turn),
    PELT_MEMBER(ModalStateBlock<N>, root_step),
    PELT_MEMBER(ModalStateBlock<N>, root_turn),
    PELT_MEMBER(ModalStateBlock<N>, wind),
    PELT_MEMBER(ModalStateBlock<N>, normal),
    PELT_MEMBER(ModalStateBlock<N>, quiet_s)};
// clang-format on

}  // namespace pelt
