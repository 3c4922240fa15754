// The kernels of one instruction set. Compiled once for each, with PELT_VECTOR the vector type,
// PELT_KERNELS the name of the table's function, and the flags that let the compiler use the set.
#include "core/kernels/kernel_table.hpp"

#include "core/float_rules.hpp"
#include "core/kernels/activate.hpp"
#include "core/kernels/anchors.hpp"
#include "core/kernels/bound_layer.hpp"
#include "core/kernels/collect_changes.hpp"
#include "core/kernels/fit_cubic.hpp"
#include "core/kernels/fit_ribbon.hpp"
#include "core/kernels/interpolate.hpp"
#include "core/kernels/joint_palette.hpp"
#include "core/kernels/order_layers.hpp"
#include "core/kernels/roots.hpp"
#include "core/kernels/sample_pose.hpp"
#include "core/kernels/select_lod.hpp"
#include "core/kernels/simulate_modal.hpp"
#include "core/kernels/simulate_pbd.hpp"
#include "core/kernels/simulate_verlet.hpp"
#include "core/kernels/skin.hpp"
#include "core/kernels/sort_key.hpp"
#include "core/kernels/sort_layer.hpp"
#include "core/kernels/sort_pieces.hpp"
#include "core/kernels/wind.hpp"
#include "core/kernels/write_instances.hpp"
#include "core/kernels/write_ribbons.hpp"

namespace pelt {

const KernelTable& PELT_KERNELS();

namespace {

using V = PELT_VECTOR;

// In the order of enum Kernel.
constexpr KernelTable kTable{{
    MakeKernelDesc<SamplePose<V>>(),
    MakeKernelDesc<JointPalette<V>>(),
    MakeKernelDesc<BoundLayer<V>>(),
    MakeKernelDesc<SelectLod<V>>(),
    MakeKernelDesc<Activate<V>>(),
    MakeKernelDesc<Skin<V>>(),
    MakeKernelDesc<Anchors<V>>(),
    MakeKernelDesc<Roots<V>>(),
    MakeKernelDesc<Wind<V, true>>(),
    MakeKernelDesc<Wind<V, false>>(),
    MakeKernelDesc<SimulatePbd<V, 4, true>>(),
    MakeKernelDesc<SimulatePbd<V, 4, false>>(),
    MakeKernelDesc<SimulatePbd<V, 5, false>>(),
    MakeKernelDesc<SimulateVerlet<V, 4>>(),
    MakeKernelDesc<SimulateVerlet<V, 5>>(),
    MakeKernelDesc<SimulateModal<V, 4, true>>(),
    MakeKernelDesc<SimulateModal<V, 4, false>>(),
    MakeKernelDesc<SimulateModal<V, 5, false>>(),
    MakeKernelDesc<Interpolate<V>>(),
    MakeKernelDesc<FitCubic<V, 4>>(),
    MakeKernelDesc<FitCubic<V, 5>>(),
    MakeKernelDesc<FitRibbon<V, 4>>(),
    MakeKernelDesc<FitRibbon<V, 5>>(),
    MakeKernelDesc<SortKey<V, 4>>(),
    MakeKernelDesc<SortKey<V, 5>>(),
    MakeKernelDesc<CollectChanges<V>>(),
    MakeKernelDesc<SortLayer<V>>(),
    MakeKernelDesc<SortCount<V, 0>>(),
    MakeKernelDesc<SortOffsets<V, 0>>(),
    MakeKernelDesc<SortScatter<V, 0>>(),
    MakeKernelDesc<SortCount<V, 1>>(),
    MakeKernelDesc<SortOffsets<V, 1>>(),
    MakeKernelDesc<SortScatter<V, 1>>(),
    MakeKernelDesc<SortCount<V, 2>>(),
    MakeKernelDesc<SortOffsets<V, 2>>(),
    MakeKernelDesc<SortScatter<V, 2>>(),
    MakeKernelDesc<SortCount<V, 3>>(),
    MakeKernelDesc<SortOffsets<V, 3>>(),
    MakeKernelDesc<SortScatter<V, 3>>(),
    MakeKernelDesc<OrderLayers<V>>(),
    MakeKernelDesc<WriteInstances<V>>(),
    MakeKernelDesc<WriteRibbons<V>>(),
    MakeKernelDesc<WriteRibbonsUnsorted<V>>(),
}};

}  // namespace

const KernelTable& PELT_KERNELS() { return kTable; }

}  // namespace pelt
