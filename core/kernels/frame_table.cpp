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
constexpr KindMask kPbd{0, kLayerVerlet | kLayerModal}, kVerlet{kLayerVerlet, 0};
constexpr KindMask kBare{0, kLayerRates | kLayerSagFree}, kUnrated{0, kLayerRates},
    kUnheld{0, kLayerSagFree};
constexpr KindMask kTogether{0, kLayerApart}, kModalStrands{kLayerModal, kLayerVertexChains};
constexpr KindMask kStrandChains{0, kLayerVertexChains};
constexpr KindMask kDisplaced{0, kLayerModal};
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

template <class K>
constexpr FrameRow Row(Domain domain, Gate gate, KindMask kinds = {},
                       std::optional<VertexOrder> vertices = {}) {
  FrameRow row{MakeKernelDesc<K>(), nullptr, domain, gate, kinds, vertices};
  if constexpr (requires { typename K::Params; }) row.params = &ParamsOf<typename K::Params>;
  return row;
}

constexpr FrameRow kRows[] = {
    // Where everything is, what is seen and what needs doing.
    Row<SamplePose<V>>(kCharacter, kPosed),
    Row<JointPalette<V>>(kCharacter, kPosed),
    Row<JointRates<V>>(kCharacter, kPosedWithRates),
    Row<BoundLayer<V>>(kLayer, kAlways),
    Row<SelectLod<V>>(kLayer, kAlways),
    Row<LightLayer<V>>(kLayer, kRelit),
    Row<SelectShells<V>>(kLayer, kAlways),

    // A patch from mesh to what strands take of it: nothing outside it but the pose.
    Row<ActivatePatch<V>>(kPatch, kAlways),
    Row<ShiftSkin<V>>(kPatch, kShifted<kPatch>),
    Row<ShiftChains<V, 4, true>>(kPatch, kShifted<kPatch>),
    Row<Skin<W>>(kPatch, kSkinned),
    Row<Anchors<W>>(kPatch, kRooted<kPatch>),
    Row<AnchorRates<W>>(kPatch, kRated<kPatch>),
    Row<MeshRates<W>>(kPatch, kMeshRated),
    Row<Wind<W, true>>(kPatch, kBlown<kPatch>),
    Row<SimulatePbd<V, 4, true>>(kPatch, kSimulated<kPatch>, kPbd),
    Row<SimulateModal<W, 4, true>>(kPatch, kSimulated<kPatch>, kBare),
    Row<SimulateModalRated<W, 4, true>>(kPatch, kSimulated<kPatch>, kUnheld),
    Row<SimulateModalHeld<W, 4, true>>(kPatch, kSimulated<kPatch>, kUnrated),
    Row<SimulateModalRatedHeld<W, 4, true>>(kPatch, kSimulated<kPatch>),
    Row<ChainLoads<W>>(kPatch, kLoaded),
    Row<ChainDisplacements<W>>(kPatch, kLoaded),
    Row<ShellForce<V>>(kPatch, kBent),

    // A chunk from patches to curves.
    Row<Activate<V>>(kChunk, kAlways, kStrandChains),
    Row<ActivateFollowers<V>>(kChunk, kAlways),
    Row<ShiftChains<V, 4, false>>(kChunk, kShifted<kChunk>),
    Row<ShiftChains<V, 5, false>>(kChunk, kShifted<kChunk>),
    Row<ShiftModal<V, 4>>(kChunk, kShifted<kChunk>, kModalStrands),
    Row<ShiftModal<V, 5>>(kChunk, kShifted<kChunk>, kModalStrands),
    Row<ShiftModal<V, 9>>(kChunk, kShifted<kChunk>, kModalStrands),
    Row<Roots<W>>(kChunk, kRooted<kChunk>),
    Row<RootRates<W>>(kChunk, kRated<kChunk>),
    Row<Wind<W, false>>(kChunk, kBlown<kChunk>),
    Row<SimulatePbd<V, 4, false>>(kChunk, kSimulated<kChunk>, kPbd),
    Row<SimulatePbd<V, 5, false>>(kChunk, kSimulated<kChunk>, kPbd),
    Row<SimulateVerlet<V, 4>>(kChunk, kSimulated<kChunk>, kVerlet),
    Row<SimulateVerlet<V, 5>>(kChunk, kSimulated<kChunk>, kVerlet),
    Row<SimulateModal<W, 4, false>>(kChunk, kSimulated<kChunk>, kBare),
    Row<SimulateModal<W, 5, false>>(kChunk, kSimulated<kChunk>, kBare),
    Row<SimulateModal<W, 9, false>>(kChunk, kSimulated<kChunk>, kBare),
    Row<SimulateModalRated<W, 4, false>>(kChunk, kSimulated<kChunk>, kUnheld),
    Row<SimulateModalRated<W, 5, false>>(kChunk, kSimulated<kChunk>, kUnheld),
    Row<SimulateModalRated<W, 9, false>>(kChunk, kSimulated<kChunk>, kUnheld),
    Row<SimulateModalHeld<W, 4, false>>(kChunk, kSimulated<kChunk>, kUnrated),
    Row<SimulateModalHeld<W, 5, false>>(kChunk, kSimulated<kChunk>, kUnrated),
    Row<SimulateModalHeld<W, 9, false>>(kChunk, kSimulated<kChunk>, kUnrated),
    Row<SimulateModalRatedHeld<W, 4, false>>(kChunk, kSimulated<kChunk>),
    Row<SimulateModalRatedHeld<W, 5, false>>(kChunk, kSimulated<kChunk>),
    Row<SimulateModalRatedHeld<W, 9, false>>(kChunk, kSimulated<kChunk>),
    Row<Interpolate<W>>(kChunk, kFitted, kDisplaced),
    Row<InterpolateModal<W>>(kChunk, kFitted),
    Row<FitCubic<W, 4>>(kChunk, kFitted),
    Row<FitCubic<W, 5>>(kChunk, kFitted),
    Row<FitCubic<W, 9>>(kChunk, kFitted),
    Row<FitRibbon<W, 4>>(kChunk, kFitted),
    Row<FitRibbon<W, 5>>(kChunk, kFitted),
    Row<FitRibbon<W, 9>>(kChunk, kFitted),
    Row<PaintStrands<V>>(kChunk, kBrushed),
    Row<WriteLooks<V, false>>(kChunk, kFitted, kUnpainted),
    Row<WriteLooks<V, true>>(kChunk, kFittedOrPainted),
    Row<SelectFins<V>>(kChunk, kKeyed),
    Row<SortKey<W, 4>>(kChunk, kKeyed),
    Row<SortKey<W, 5>>(kChunk, kKeyed),
    Row<SortKey<W, 9>>(kChunk, kKeyed),

    // A layer sorts as one; layers too large for a local store in pieces, four 8-bit digits.
    Row<CollectChanges<V>>(kLayer, kCollected),
    Row<SortLayer<V>>(kLayer, kResorted, kWhole),
    Row<SortCount<V, 0>>(kChunk, kResorted, kPieces),
    Row<SortOffsets<V, 0>>(kLayer, kResorted, kPieces),
    Row<SortScatter<V, 0>>(kChunk, kResorted, kPieces),
    Row<SortCount<V, 1>>(kChunk, kResorted, kPieces),
    Row<SortOffsets<V, 1>>(kLayer, kResorted, kPieces),
    Row<SortScatter<V, 1>>(kChunk, kResorted, kPieces),
    Row<SortCount<V, 2>>(kChunk, kResorted, kPieces),
    Row<SortOffsets<V, 2>>(kLayer, kResorted, kPieces),
    Row<SortScatter<V, 2>>(kChunk, kResorted, kPieces),
    Row<SortCount<V, 3>>(kChunk, kResorted, kPieces),
    Row<SortOffsets<V, 3>>(kLayer, kResorted, kPieces),
    Row<SortScatter<V, 3>>(kChunk, kResorted, kPieces),
    Row<OrderLayers<V>>(kScene, kCollected, kTogether),
    Row<OrderLayersApart<V>>(kScene, kCollected),

    // Vertices, in pieces of a chunk's size.
    Row<WriteInstances<V>>(kChunk, kRedrawn, {}, VertexOrder::kSorted),
    Row<WriteRibbons<V>>(kChunk, kRedrawn, {}, VertexOrder::kSorted),
    Row<WriteRibbonsUnsorted<V>>(kChunk, kKeyed, {}, VertexOrder::kIndexBuffer),
    Row<WriteLines<V>>(kChunk, kRedrawn, {}, VertexOrder::kSorted),
    // Of strands alone, wherever the camera is: as often as their curves.
    Row<WriteLinesUnsorted<V>>(kChunk, kFitted, {}, VertexOrder::kIndexBuffer),
};
constexpr FrameTable kFrame{kRows};

}  // namespace

const FrameTable& PELT_KERNELS() { return kFrame; }

}  // namespace pelt
