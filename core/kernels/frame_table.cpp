// The frame on one instruction set. Compiled once for each, with PELT_VECTOR the vector type,
// PELT_KERNELS the name of the table's function, and the flags that let the compiler use the set.
#include "core/kernels/frame_table.hpp"

#include "core/float_rules.hpp"
#include "core/kernels/activate.hpp"
#include "core/kernels/bound_layer.hpp"
#include "core/kernels/chain_loads.hpp"
#include "core/kernels/collect_changes.hpp"
#include "core/kernels/fit_cubic.hpp"
#include "core/kernels/fit_ribbon.hpp"
#include "core/kernels/frame_gates.hpp"
#include "core/kernels/frame_params.hpp"
#include "core/kernels/interpolate.hpp"
#include "core/kernels/interpolate_modal.hpp"
#include "core/kernels/joint_palette.hpp"
#include "core/kernels/light_layer.hpp"
#include "core/kernels/order_layers.hpp"
#include "core/kernels/paint_strands.hpp"
#include "core/kernels/roots.hpp"
#include "core/kernels/sample_pose.hpp"
#include "core/kernels/select_fins.hpp"
#include "core/kernels/select_lod.hpp"
#include "core/kernels/select_shells.hpp"
#include "core/kernels/shell_force.hpp"
#include "core/kernels/shift_origin.hpp"
#include "core/kernels/simulate_modal.hpp"
#include "core/kernels/simulate_pbd.hpp"
#include "core/kernels/simulate_verlet.hpp"
#include "core/kernels/skin.hpp"
#include "core/kernels/sort_key.hpp"
#include "core/kernels/sort_layer.hpp"
#include "core/kernels/sort_pieces.hpp"
#include "core/kernels/wind.hpp"
#include "core/kernels/write_instances.hpp"
#include "core/kernels/write_lines.hpp"
#include "core/kernels/write_looks.hpp"
#include "core/kernels/write_ribbons.hpp"

namespace pelt {

const FrameTable& PELT_KERNELS();

namespace {

using V = PELT_VECTOR;
using W = AtOnce<V>::Type;  // of kernels that do the same to each strand or vertex
using enum Domain;
using namespace frame_gates;

// Kinds a stage's streams do not tell apart.
constexpr KindMask kPbd{0, kLayerVerlet | kLayerModal | kLayerTraits},
    kVerlet{kLayerVerlet, kLayerTraits}, kBare{0, kLayerRates | kLayerSagFree | kLayerTraits},
    kUnrated{0, kLayerRates}, kUnheld{0, kLayerSagFree | kLayerTraits}, kAlike{0, kLayerTraits};
// With traits, which sag-free layers have not.
constexpr KindMask kTraitedPbd{0, kLayerVerlet | kLayerModal}, kTraitedVerlet{kLayerVerlet, 0},
    kTraitedModal{0, kLayerRates};
constexpr KindMask kTogether{0, kLayerApart}, kModalStrands{kLayerModal, kLayerVertexChains};
constexpr KindMask kStrandChains{0, kLayerVertexChains};
constexpr KindMask kDisplaced{0, kLayerModal | kLayerTraits}, kTraitedDisplaced{0, kLayerModal};
constexpr KindMask kUnpainted{0, kLayerPainted};
constexpr KindMask kWhole{0, kLayerSortInPieces}, kPieces{kLayerSortInPieces, 0};

template <class P>
const void* ParamsOf(const FrameParams& all) {
  const void* found = nullptr;
  WithMembers(all, [&](const auto&... member) {
    ((std::is_same_v<decltype(member), const P&> ? void(found = &member) : void()), ...);
  });
  return found;
}

// Of the solvers, which take most of the time to compile, the verdict's build has those of its scene alone: the others
// are null, and its program refuses scenes that have them.
constexpr bool IsBuilt([[maybe_unused]] std::string_view kernel) {
#ifdef PELT_FIRST
  return !kernel.starts_with("simulate_") || kernel == "simulate_modal_4" ||
         kernel == "simulate_modal_vertex";
#else
  return true;
#endif
}

template <class K>
constexpr KernelDesc Describe() {
  if constexpr (IsBuilt(K::kName))
    return MakeKernelDesc<K>();
  else
    return MakeKernelDesc<K>(nullptr);
}

template <class K>
constexpr FrameEntry Entry(Domain domain, Gate gate, KindMask kinds = {},
                           std::optional<VertexOrder> vertices = {}) {
  FrameEntry entry{Describe<K>(), nullptr, domain, gate, kinds, vertices};
  if constexpr (requires { typename K::Params; }) entry.params = &ParamsOf<typename K::Params>;
  return entry;
}

constexpr FrameEntry kEntries[] = {
    // Where everything is, what is seen and what needs doing.
    Entry<SamplePose<V>>(kCharacter, kPosed),
    Entry<JointPalette<V>>(kCharacter, kPosed),
    Entry<JointRates<V>>(kCharacter, kPosedWithRates),
    Entry<BoundLayer<V>>(kLayer, kAlways),
    Entry<SelectLod<V>>(kLayer, kAlways),
    Entry<LightLayer<V>>(kLayer, kRelit),
    Entry<SelectShells<V>>(kLayer, kAlways),

    // A patch from mesh to what strands take of it: nothing outside it but the pose.
    Entry<ActivatePatch<V>>(kPatch, kAlways),
    Entry<ShiftSkin<V>>(kPatch, kShifted<kPatch>),
    Entry<ShiftChains<V, 4, true>>(kPatch, kShifted<kPatch>),
    Entry<Skin<W>>(kPatch, kSkinned),
    Entry<Anchors<W>>(kPatch, kRooted<kPatch>),
    Entry<AnchorRates<W>>(kPatch, kRated<kPatch>),
    Entry<MeshRates<W>>(kPatch, kMeshRated),
    Entry<Wind<W, true>>(kPatch, kBlown<kPatch>),
    Entry<SimulatePbd<V, 4, true>>(kPatch, kSimulated<kPatch>, kPbd),
    Entry<WithTraits<SimulatePbd<V, 4, true>>>(kPatch, kSimulated<kPatch>, kTraitedPbd),
    Entry<SimulateModal<W, 4, true>>(kPatch, kSimulated<kPatch>, kBare),
    Entry<SimulateModalRated<W, 4, true>>(kPatch, kSimulated<kPatch>, kUnheld),
    Entry<SimulateModalHeld<W, 4, true>>(kPatch, kSimulated<kPatch>, kUnrated),
    Entry<SimulateModalRatedHeld<W, 4, true>>(kPatch, kSimulated<kPatch>),
    Entry<WithTraits<SimulateModal<W, 4, true>>>(kPatch, kSimulated<kPatch>, kTraitedModal),
    Entry<WithTraits<SimulateModalRated<W, 4, true>>>(kPatch, kSimulated<kPatch>),
    Entry<ChainLoads<W>>(kPatch, kLoaded),
    Entry<ChainDisplacements<W>>(kPatch, kLoaded),
    Entry<ShellForce<V>>(kPatch, kBent),

    // A chunk from patches to curves.
    Entry<Activate<V>>(kChunk, kAlways, kStrandChains),
    Entry<ActivateFollowers<V>>(kChunk, kAlways),
    Entry<ShiftChains<V, 4, false>>(kChunk, kShifted<kChunk>),
    Entry<ShiftChains<V, 5, false>>(kChunk, kShifted<kChunk>),
    Entry<ShiftModal<V, 4>>(kChunk, kShifted<kChunk>, kModalStrands),
    Entry<ShiftModal<V, 5>>(kChunk, kShifted<kChunk>, kModalStrands),
    Entry<ShiftModal<V, 9>>(kChunk, kShifted<kChunk>, kModalStrands),
    Entry<Roots<W>>(kChunk, kRooted<kChunk>),
    Entry<RootRates<W>>(kChunk, kRated<kChunk>),
    Entry<Wind<W, false>>(kChunk, kBlown<kChunk>),
    Entry<SimulatePbd<V, 4, false>>(kChunk, kSimulated<kChunk>, kPbd),
    Entry<SimulatePbd<V, 5, false>>(kChunk, kSimulated<kChunk>, kPbd),
    Entry<SimulateVerlet<V, 4>>(kChunk, kSimulated<kChunk>, kVerlet),
    Entry<SimulateVerlet<V, 5>>(kChunk, kSimulated<kChunk>, kVerlet),
    Entry<WithTraits<SimulatePbd<V, 4, false>>>(kChunk, kSimulated<kChunk>, kTraitedPbd),
    Entry<WithTraits<SimulatePbd<V, 5, false>>>(kChunk, kSimulated<kChunk>, kTraitedPbd),
    Entry<WithTraits<SimulateVerlet<V, 4>>>(kChunk, kSimulated<kChunk>, kTraitedVerlet),
    Entry<WithTraits<SimulateVerlet<V, 5>>>(kChunk, kSimulated<kChunk>, kTraitedVerlet),
    Entry<SimulateModal<W, 4, false>>(kChunk, kSimulated<kChunk>, kBare),
    Entry<SimulateModal<W, 5, false>>(kChunk, kSimulated<kChunk>, kBare),
    Entry<SimulateModal<W, 9, false>>(kChunk, kSimulated<kChunk>, kBare),
    Entry<SimulateModalRated<W, 4, false>>(kChunk, kSimulated<kChunk>, kUnheld),
    Entry<SimulateModalRated<W, 5, false>>(kChunk, kSimulated<kChunk>, kUnheld),
    Entry<SimulateModalRated<W, 9, false>>(kChunk, kSimulated<kChunk>, kUnheld),
    Entry<SimulateModalHeld<W, 4, false>>(kChunk, kSimulated<kChunk>, kUnrated),
    Entry<SimulateModalHeld<W, 5, false>>(kChunk, kSimulated<kChunk>, kUnrated),
    Entry<SimulateModalHeld<W, 9, false>>(kChunk, kSimulated<kChunk>, kUnrated),
    Entry<SimulateModalRatedHeld<W, 4, false>>(kChunk, kSimulated<kChunk>),
    Entry<SimulateModalRatedHeld<W, 5, false>>(kChunk, kSimulated<kChunk>),
    Entry<SimulateModalRatedHeld<W, 9, false>>(kChunk, kSimulated<kChunk>),
    Entry<WithTraits<SimulateModal<W, 4, false>>>(kChunk, kSimulated<kChunk>, kTraitedModal),
    Entry<WithTraits<SimulateModal<W, 5, false>>>(kChunk, kSimulated<kChunk>, kTraitedModal),
    Entry<WithTraits<SimulateModal<W, 9, false>>>(kChunk, kSimulated<kChunk>, kTraitedModal),
    Entry<WithTraits<SimulateModalRated<W, 4, false>>>(kChunk, kSimulated<kChunk>),
    Entry<WithTraits<SimulateModalRated<W, 5, false>>>(kChunk, kSimulated<kChunk>),
    Entry<WithTraits<SimulateModalRated<W, 9, false>>>(kChunk, kSimulated<kChunk>),
    Entry<Interpolate<W>>(kChunk, kFitted, kDisplaced),
    Entry<InterpolateModal<W>>(kChunk, kFitted, kAlike),
    Entry<WithTraits<Interpolate<W>>>(kChunk, kFitted, kTraitedDisplaced),
    Entry<WithTraits<InterpolateModal<W>>>(kChunk, kFitted),
    Entry<FitCubic<W, 4>>(kChunk, kFitted),
    Entry<FitCubic<W, 5>>(kChunk, kFitted),
    Entry<FitCubic<W, 9>>(kChunk, kFitted),
    Entry<FitRibbon<W, 4>>(kChunk, kFitted),
    Entry<FitRibbon<W, 5>>(kChunk, kFitted),
    Entry<FitRibbon<W, 9>>(kChunk, kFitted),
    Entry<PaintStrands<V>>(kChunk, kBrushed),
    Entry<WriteLooks<V, false>>(kChunk, kFitted, kUnpainted),
    Entry<WriteLooks<V, true>>(kChunk, kFittedOrPainted),
    Entry<SelectFins<V>>(kChunk, kKeyed),
    Entry<SortKey<W, 4>>(kChunk, kKeyed),
    Entry<SortKey<W, 5>>(kChunk, kKeyed),
    Entry<SortKey<W, 9>>(kChunk, kKeyed),

    // A layer sorts as one; layers too large for a local store in pieces, four 8-bit digits.
    Entry<CollectChanges<V>>(kLayer, kCollected),
    Entry<SortLayer<V>>(kLayer, kResorted, kWhole),
    Entry<SortCount<V, 0>>(kChunk, kResorted, kPieces),
    Entry<SortOffsets<V, 0>>(kLayer, kResorted, kPieces),
    Entry<SortScatter<V, 0>>(kChunk, kResorted, kPieces),
    Entry<SortCount<V, 1>>(kChunk, kResorted, kPieces),
    Entry<SortOffsets<V, 1>>(kLayer, kResorted, kPieces),
    Entry<SortScatter<V, 1>>(kChunk, kResorted, kPieces),
    Entry<SortCount<V, 2>>(kChunk, kResorted, kPieces),
    Entry<SortOffsets<V, 2>>(kLayer, kResorted, kPieces),
    Entry<SortScatter<V, 2>>(kChunk, kResorted, kPieces),
    Entry<SortCount<V, 3>>(kChunk, kResorted, kPieces),
    Entry<SortOffsets<V, 3>>(kLayer, kResorted, kPieces),
    Entry<SortScatter<V, 3>>(kChunk, kResorted, kPieces),
    Entry<OrderLayers<V>>(kScene, kCollected, kTogether),
    Entry<OrderLayersApart<V>>(kScene, kCollected),

    // Vertices, in pieces of a chunk's size.
    Entry<WriteInstances<V>>(kChunk, kRedrawn, {}, VertexOrder::kSorted),
    Entry<WriteRibbons<V>>(kChunk, kRedrawn, {}, VertexOrder::kSorted),
    Entry<WriteRibbonsUnsorted<V>>(kChunk, kKeyed, {}, VertexOrder::kIndexBuffer),
    Entry<WriteLines<V>>(kChunk, kRedrawn, {}, VertexOrder::kSorted),
    // Of strands alone, wherever the camera is: as often as their curves.
    Entry<WriteLinesUnsorted<V>>(kChunk, kFitted, {}, VertexOrder::kIndexBuffer),
};
constexpr FrameTable kFrame{kEntries};

}  // namespace

const FrameTable& PELT_KERNELS() { return kFrame; }

}  // namespace pelt
