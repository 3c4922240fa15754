#include "jobs/frame_table.hpp"

namespace pelt {

std::vector<Stage> MakeFrameTable(const KernelTable& k, const FrameParams& p, VertexOrder order) {
  using enum Kernel;
  constexpr auto kCharacter = Domain::kCharacter, kLayer = Domain::kLayer, kChunk = Domain::kChunk;
  constexpr Gate kAlways{};
  constexpr Gate kPosed{.frame = FrameGate::kNewPose};
  constexpr Gate kSkinned{.chunk_flags = kChunkSkin};
  constexpr Gate kSimulated{.chunk_flags = kChunkSimulate};
  constexpr Gate kBlown{.chunk_flags = kChunkSimulate, .layer_flags = kLayerWind};
  constexpr Gate kFitted{.chunk_flags = kChunkFit};
  // What follows the view goes on when time does not.
  constexpr FrameGate kView = FrameGate::kAlsoPaused;
  constexpr Gate kKeyed{.chunk_flags = kChunkKeys, .frame = kView};
  constexpr Gate kCollected{.frame = kView};
  constexpr Gate kResorted{.layer = LayerGate::kKeysChanged, .frame = kView};
  constexpr Gate kRedrawn{.layer = LayerGate::kRedraw, .frame = kView};
  // Kinds a stage's streams do not tell apart.
  constexpr KindMask kPbd{0, kLayerVerlet | kLayerModal}, kVerlet{kLayerVerlet, 0};
  constexpr KindMask kStrandChains{0, kLayerVertexChains};
  constexpr KindMask kWhole{0, kKindSortInPieces}, kPieces{kKindSortInPieces, 0};

  const void* none = &p;  // kernels without parameters never look

  std::vector<Stage> table;
  const auto add = [&](Kernel id, const void* params, Domain domain, Gate gate,
                       KindMask kinds = {}) {
    table.push_back({k[id], params, domain, gate, kinds});
  };

  // Where everything is, what is seen and what needs doing.
  add(kSamplePose, none, kCharacter, kPosed);
  add(kJointPalette, none, kCharacter, kPosed);
  add(kBoundLayer, none, kLayer, kAlways);
  add(kSelectLod, &p.select_lod, kLayer, kAlways);

  // A chunk from mesh to strands: nothing outside it but the pose.
  add(kActivate, &p.activate, kChunk, kAlways);
  add(kSkin, none, kChunk, kSkinned);
  add(kAnchors, none, kChunk, kSkinned);
  add(kRoots, none, kChunk, kSkinned);
  add(kWindVertex, &p.wind, kChunk, kBlown);
  add(kWindStrand, &p.wind, kChunk, kBlown, kStrandChains);
  add(kPbdVertex4, &p.simulate, kChunk, kSimulated, kPbd);
  add(kPbdStrand4, &p.simulate, kChunk, kSimulated, kPbd);
  add(kPbdStrand5, &p.simulate, kChunk, kSimulated, kPbd);
  add(kVerlet4, &p.simulate, kChunk, kSimulated, kVerlet);
  add(kVerlet5, &p.simulate, kChunk, kSimulated, kVerlet);
  add(kModalVertex4, &p.simulate, kChunk, kSimulated);
  add(kModalStrand4, &p.simulate, kChunk, kSimulated);
  add(kModalStrand5, &p.simulate, kChunk, kSimulated);
  add(kInterpolate, none, kChunk, kFitted);
  add(kFitCubic4, none, kChunk, kFitted);
  add(kFitCubic5, none, kChunk, kFitted);
  add(kFitRibbon4, none, kChunk, kFitted);
  add(kFitRibbon5, none, kChunk, kFitted);
  add(kSortKey4, &p.sort_key, kChunk, kKeyed);
  add(kSortKey5, &p.sort_key, kChunk, kKeyed);

  // A layer sorts as one; layers too large for a local store in pieces, four 8-bit digits.
  add(kCollectChanges, &p.collect_changes, kLayer, kCollected);
  add(kSortLayer, none, kLayer, kResorted, kWhole);
  constexpr Kernel kCounts[] = {kSortCount0, kSortCount1, kSortCount2, kSortCount3};
  constexpr Kernel kOffsets[] = {kSortOffsets0, kSortOffsets1, kSortOffsets2, kSortOffsets3};
  constexpr Kernel kScatters[] = {kSortScatter0, kSortScatter1, kSortScatter2, kSortScatter3};
  for (int digit = 0; digit < 4; ++digit) {
    add(kCounts[digit], none, kChunk, kResorted, kPieces);
    add(kOffsets[digit], none, kLayer, kResorted, kPieces);
    add(kScatters[digit], none, kChunk, kResorted, kPieces);
  }
  add(kOrderLayers, &p.order_layers, Domain::kScene, kCollected);

  // Vertices, in pieces of a chunk's size.
  if (order == VertexOrder::kSorted) {
    add(kWriteInstances, none, kChunk, kRedrawn);
    add(kWriteRibbons, &p.write_ribbons, kChunk, kRedrawn);
  } else {
    add(kWriteRibbonsUnsorted, &p.write_ribbons, kChunk, kKeyed);
  }
  return table;
}

}  // namespace pelt
