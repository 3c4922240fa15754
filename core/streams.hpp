// The streams of a frame of fur: one row says everything about each. Digests, memory, mismatch
// reports, ports and the local-store executor all read this table; its order is that of memory and
// digests.
#pragma once

#include "core/chunk.hpp"
#include "core/layer.hpp"
#include "core/modal/modal_block.hpp"
#include "core/stream_table.hpp"

namespace pelt {

namespace streams_detail {

using enum Domain;
using enum Role;
using enum Kept;

uint32_t CountStrands(const FrameMemory& memory, uint32_t chunk);   // live ones
uint32_t CountVertices(const FrameMemory& memory, uint32_t patch);  // live ones
uint32_t CountLiveChains(const FrameMemory& memory, uint32_t patch);
uint32_t CountFollowing(const FrameMemory& memory,
                        uint32_t patch);  // live ones, if chains follow others
uint32_t CountPlaces(const FrameMemory& memory, uint32_t chunk);  // of the layer's order, drawn
uint32_t CountInDrawOrder(const FrameMemory& memory, uint32_t chunk);
uint32_t CountInEitherOrder(const FrameMemory& memory, uint32_t chunk);

inline constexpr Lanes kAll{}, kLiveStrands{&CountStrands, kLaneGroup},
    kLiveVertices{&CountVertices, kLaneGroup}, kLiveChains{&CountLiveChains, kLaneGroup},
    kFollowing{&CountFollowing, kLaneGroup}, kKeyed{&CountStrands, 1, true},
    kPainted{&CountStrands, kLaneGroup, true}, kPlaces{&CountPlaces},
    kInDrawOrder{&CountInDrawOrder}, kInEitherOrder{&CountInEitherOrder};

inline constexpr uint32_t kFive = kLayerFivePoints, kNine = kLayerNinePoints, kModal = kLayerModal,
                          kShells = kLayerShells;
inline constexpr KindMask kOnVertices{kLayerVertexChains, 0}, kStrandChains{0, kLayerVertexChains},
    kOf4{0, kFive | kNine | kShells}, kOf5{kFive, 0}, kOf9{kNine, 0},
    kChains{kLayerVertexChains, kShells}, kOfStrands{0, kShells};
inline constexpr KindMask kInstanced{0, kLayerOutputFlags}, kRibboned{kLayerRibbons, 0},
    kLined{kLayerLines, 0}, kCubic{0, kLayerRibbons | kShells},  // instances, and lines along them
    kLit{kLayerLit, 0}, kLitStrands{kLayerLit, kShells}, kShelled{kShells, 0},
    kOfPaint{kLayerPainted | kLayerLit, kShells}, kInPieces{kLayerSortInPieces, kShells},
    kSortedWhole{0, kLayerSortInPieces | kShells}, kFinned{kShells | kLayerFins, 0},
    kRated{kModal | kLayerRates, 0}, kHeld{kModal | kLayerSagFree, 0}, kApart{kLayerApart, 0},
    kRatedVertices{kModal | kLayerRates | kLayerVertexChains, 0},
    kRatedStrands{kModal | kLayerRates, kLayerVertexChains},
    kHeldVertices{kModal | kLayerSagFree | kLayerVertexChains, 0},
    kHeldStrands{kModal | kLayerSagFree, kLayerVertexChains}, kTraited{kLayerTraits, kShells},
    kTraitedVertices{kLayerTraits | kLayerVertexChains, kShells};

struct Streams {
  static constexpr uint32_t kChunkLanes = kStrandsPerChunk;

  // Baked; or, those that are state, filled before the frame.
  StreamRow<PoseBlock> pose{"pose", kCharacter, kInput, kAll, {}, kState};
  StreamRow<SkeletonBlock> skeleton{"skeleton", kCharacter, kInput};
  StreamRow<LayerBlock> layers{"layers", kLayer, kInput, kAll, {}, kState};
  StreamRow<LayerJointBlock> layer_joints{"layer_joints", kLayer, kInput};
  StreamRow<PatchBlock> patches{"patches", kPatch, kInput};
  StreamRow<MeshBlock> mesh{"mesh", kPatch, kInput, kLiveVertices};
  StreamRow<StrandBlock> strands{"strands", kChunk, kInput, kLiveStrands};
  StreamRow<HaloBlock> halo{"halo", kChunk, kInput};
  StreamRow<PatchListBlock> patch_list{"patch_list", kChunk, kInput, kAll, kOnVertices};
  // Of chains at mesh vertices; of strands that follow them, and chains of 4 and 5 points.
  StreamRow<RestBlock<4>> vertex_rest{"vertex_rest", kPatch, kInput, kLiveChains, kOnVertices};
  StreamRow<RestBlock<4>> strand_rest4{"strand_rest4", kChunk, kInput, kLiveStrands, kOf4};
  StreamRow<RestBlock<5>> strand_rest5{"strand_rest5", kChunk, kInput, kLiveStrands, kOf5};

  // Written in the frame.
  StreamRow<LocalPoseBlock> local_pose{"local_pose", kCharacter, kValue};
  StreamRow<PaletteBlock> palette{"palette", kCharacter, kValue};
  StreamRow<BoundsBlock> bounds{"bounds", kLayer, kValue};
  StreamRow<LodBlock> lod{"lod", kLayer, kValue, kAll, {}, kOutput};
  StreamRow<ChunkStateBlock> chunk_state{"chunk_state", kChunk, kBookkeeping, kAll, {}, kOutput};
  StreamRow<ChunkStateBlock> patch_state{"patch_state", kPatch, kBookkeeping, kAll, {}, kOutput};
  StreamRow<SkinnedBlock> skinned{"skinned", kPatch, kValue, kLiveVertices};
  StreamRow<RootBlock> anchors{"anchors", kPatch, kValue, kLiveChains,
                               kOnVertices};  // of mesh vertices
  StreamRow<RootBlock> roots{"roots", kChunk, kValue, kLiveStrands, kOfStrands};
  StreamRow<WindBlock> vertex_wind{"vertex_wind", kPatch, kScratch, kLiveChains, kOnVertices};
  StreamRow<WindBlock> wind{"wind", kChunk, kScratch, kLiveStrands, kStrandChains};
  // Points without a last frame (strands that follow vertex chains) are made anew: no state.
  StreamRow<PointBlock<4>> vertex_points{
      "vertex_points", kPatch, kValue, kLiveChains, {kLayerVertexChains, kModal | kShells}};
  StreamRow<PointBlock<4>> vertex_previous{"vertex_previous",
                                           kPatch,
                                           kValue,
                                           kLiveChains,
                                           {kLayerVertexChains, kModal | kShells},
                                           kState};
  StreamRow<PointBlock<4>> strand_points4{"strand_points4", kChunk, kValue, kLiveStrands, kOf4};
  StreamRow<PointBlock<4>> strand_previous4{"strand_previous4",
                                            kChunk,
                                            kValue,
                                            kLiveStrands,
                                            {0, kFive | kLayerVertexChains | kModal},
                                            kState};
  StreamRow<PointBlock<5>> strand_points5{"strand_points5", kChunk, kValue, kLiveStrands, kOf5};
  StreamRow<PointBlock<5>> strand_previous5{"strand_previous5", kChunk,          kValue,
                                            kLiveStrands,       {kFive, kModal}, kState};
  StreamRow<CurveBlock> curves{"curves", kChunk, kValue, kLiveStrands, kCubic, kOutput};
  StreamRow<RibbonBlock> ribbons{"ribbons", kChunk, kValue, kLiveStrands, kRibboned};
  StreamRow<SortKeyBlock> sort_keys{"sort_keys", kChunk, kValue, kKeyed, kOfStrands};
  StreamRow<OrderBlock> sort_words{"sort_words", kChunk, kScratch, kAll, kSortedWhole};
  StreamRow<SortPairBlock> sort_pairs_a{"sort_pairs_a", kChunk, kScratch, kAll, kInPieces};
  StreamRow<SortPairBlock> sort_pairs_b{"sort_pairs_b", kChunk, kScratch, kAll, kInPieces};
  StreamRow<DigitBlock> digits{"digits", kChunk, kScratch, kAll, kInPieces};
  StreamRow<OrderBlock> order{"order", kChunk, kValue, kPlaces, kOfStrands, kOutput};
  StreamRow<LayerSortBlock> layer_sort{"layer_sort", kLayer, kBookkeeping, kAll, {}, kOutput};
  StreamRow<DrawListBlock> draw_list{"draw_list", kScene, kValue, kAll, {}, kOutput};
  StreamRow<InstanceBlock> instances{"instances",  kChunk,     kValue,
                                     kInDrawOrder, kInstanced, kOutput};
  StreamRow<RibbonVertexBlock> ribbon_vertices{"ribbon_vertices", kChunk,    kValue,
                                               kInEitherOrder,    kRibboned, kOutput};

  // Layers with the modal solver: response tables, and the state of their chains.
  StreamRow<ModalTableBlock> modal_tables{"modal_tables", kLayer,      kInput,
                                          kAll,           {kModal, 0}, kState};
  StreamRow<ModalStateBlock<3>> vertex_modal{
      "vertex_modal", kPatch, kValue, kLiveChains, {kModal | kLayerVertexChains, 0}, kState};
  StreamRow<ModalStateBlock<3>> strand_modal4{
      "strand_modal4", kChunk, kValue, kLiveStrands, {kModal, kFive | kNine | kLayerVertexChains},
      kState};
  StreamRow<ModalStateBlock<4>> strand_modal5{"strand_modal5",     kChunk, kValue, kLiveStrands,
                                              {kModal | kFive, 0}, kState};

  StreamRow<LineVertexBlock> line_vertices{"line_vertices", kChunk, kValue,
                                           kInEitherOrder,  kLined, kOutput};

  // What lit layers are shaded with.
  StreamRow<LayerLightBlock> layer_light{"layer_light", kLayer, kValue, kAll, kLit, kOutput};
  StreamRow<StrandUvBlock> strand_uv{"strand_uv", kChunk, kInput, kAll, kLitStrands};
  StreamRow<LookBlock> looks{"looks", kChunk, kValue, kLiveStrands, kLitStrands, kOutput};

  // Layers of shells.
  StreamRow<ShellLayerBlock> shell_layers{"shell_layers", kLayer, kInput, kAll, kShelled};
  StreamRow<ShellSkinBlock> shell_skin{"shell_skin", kPatch, kInput, kAll, kShelled};
  StreamRow<ShellLodBlock> shell_lod{"shell_lod", kLayer, kValue, kAll, kShelled, kOutput};
  StreamRow<ShellVertexBlock> shell_vertices{"shell_vertices", kPatch,   kValue,
                                             kLiveVertices,    kShelled, kOutput};

  // Of strands that do not live too: they keep what is on them.
  StreamRow<PaintBlock> paint{"paint", kChunk, kValue, kPainted, kOfPaint, kState};

  // Shells' fins.
  StreamRow<FinEdgeBlock> fin_edges{"fin_edges", kChunk, kInput, kAll, kFinned};
  StreamRow<FinBlock> fins{"fins", kChunk, kValue, kKeyed, kFinned, kOutput};
  // Of scenes that are given velocities with their poses.
  StreamRow<PoseRateBlock> pose_rates{"pose_rates", kCharacter, kInput, kAll, kRated, kState};
  StreamRow<PaletteRateBlock> palette_rates{"palette_rates", kCharacter, kValue, kAll, kRated};
  StreamRow<RootRateBlock> anchor_rates{"anchor_rates", kPatch, kScratch, kLiveChains,
                                        kRatedVertices};
  StreamRow<VertexRateBlock> vertex_rates{"vertex_rates", kPatch, kScratch, kLiveVertices,
                                          kRatedStrands};
  StreamRow<RootRateBlock> root_rates{"root_rates", kChunk, kScratch, kLiveStrands, kRatedStrands};
  // Of scenes whose characters have origins of their own.
  StreamRow<LayerOriginBlock> layer_origins{"layer_origins", kLayer, kInput, kAll, kApart, kState};
  // Of sag-free layers.
  StreamRow<DownBlock> vertex_down{"vertex_down", kPatch, kInput, kAll, kHeldVertices};
  StreamRow<DownBlock> strand_down{"strand_down", kChunk, kInput, kAll, kHeldStrands};
  // Of chains of 9 points, which the modal solver alone moves.
  StreamRow<RestBlock<9>> strand_rest9{"strand_rest9", kChunk, kInput, kLiveStrands, kOf9};
  StreamRow<PointBlock<9>> strand_points9{"strand_points9", kChunk, kValue, kLiveStrands, kOf9};
  StreamRow<ModalStateBlock<4>> strand_modal9{"strand_modal9", kChunk, kValue,
                                              kLiveStrands,    kOf9,   kState};
  // Of strands that follow chains: what those do.
  StreamRow<LoadBlock> vertex_loads{"vertex_loads", kPatch, kValue, kLiveVertices, kChains};
  // Of chains that a level leaves out: whom they follow.
  StreamRow<ChainParentBlock> chain_parents{"chain_parents", kPatch, kInput, kFollowing, kChains};
  // Of layers whose strands have traits.
  StreamRow<TraitBlock> vertex_traits{"vertex_traits", kPatch, kInput, kAll, kTraitedVertices};
  StreamRow<TraitBlock> strand_traits{"strand_traits", kChunk, kInput, kAll, kTraited};
};

}  // namespace streams_detail

using streams_detail::Streams;

// The streams of a chunk's chains, by their points and by where they stand: at mesh vertices, or at
// each strand.
template <uint32_t kPoints, bool kVertexChains>
struct ChainStreams;
struct StrandChainStreams {
  static constexpr auto kState = &Streams::chunk_state;
  static constexpr auto kRoots = &Streams::roots;
  static constexpr auto kWind = &Streams::wind;
  static constexpr auto kRates = &Streams::root_rates;
  static constexpr auto kDown = &Streams::strand_down;
  static constexpr auto kTraits = &Streams::strand_traits;
  static constexpr auto kTable = &Streams::modal_tables;
};
template <>
struct ChainStreams<4, true> {
  static constexpr auto kState = &Streams::patch_state;
  static constexpr auto kWind = &Streams::vertex_wind;
  static constexpr auto kRates = &Streams::anchor_rates;
  static constexpr auto kDown = &Streams::vertex_down;
  static constexpr auto kTraits = &Streams::vertex_traits;
  static constexpr auto kRest = &Streams::vertex_rest;
  static constexpr auto kRoots = &Streams::anchors;
  static constexpr auto kPosition = &Streams::vertex_points;
  static constexpr auto kPrevious = &Streams::vertex_previous;
  static constexpr auto kModal = &Streams::vertex_modal;
  static constexpr auto kTable = &Streams::modal_tables;
};
template <>
struct ChainStreams<4, false> : StrandChainStreams {
  static constexpr auto kRest = &Streams::strand_rest4;
  static constexpr auto kPosition = &Streams::strand_points4;
  static constexpr auto kPrevious = &Streams::strand_previous4;
  static constexpr auto kModal = &Streams::strand_modal4;
};
template <>
struct ChainStreams<5, false> : StrandChainStreams {
  static constexpr auto kRest = &Streams::strand_rest5;
  static constexpr auto kPosition = &Streams::strand_points5;
  static constexpr auto kPrevious = &Streams::strand_previous5;
  static constexpr auto kModal = &Streams::strand_modal5;
};
template <>
struct ChainStreams<9, false> : StrandChainStreams {
  static constexpr auto kRest = &Streams::strand_rest9;
  static constexpr auto kPosition = &Streams::strand_points9;
  static constexpr auto kModal = &Streams::strand_modal9;
};

// What a kernel for strands of so many points is called.
template <uint32_t kPoints>
constexpr std::string_view ByPoints(std::string_view of_4, std::string_view of_5,
                                    std::string_view of_9) {
  static_assert(kPoints == 4 || kPoints == 5 || kPoints == 9);
  return kPoints == 4 ? of_4 : kPoints == 5 ? of_5 : of_9;
}

// Made in streams.cpp, which alone knows the blocks' members (core/block_rows.hpp).
template <>
const StreamTable& TableOf<Streams>();
// Where the vertex stands that is number `corner` of a chunk's halo.
struct VertexPlace {
  uint32_t patch;  // of the scene
  uint32_t lane;
};
VertexPlace FindVertex(const FrameMemory& memory, uint32_t chunk, uint32_t corner);

// A bit of FrameMemory::marks: vertices lie in strand order.
inline constexpr uint32_t kInStrandOrder = 1u << 0;

inline constexpr uint32_t kStreamCount = kMemberCount<Streams>;
inline const StreamDesc& DescribeStream(Stream stream) { return TableOf<Streams>()[stream]; }

}  // namespace pelt
