// Interpolate, modal: the strands of a vertex-chain layer bend as what bends the chains at the three
// vertices of their triangle bends them.
//
// The chains' loads and multipliers (modal_load.hpp) are blended by the strand's barycentrics, taken
// for its own length, and laid on its own springs and its own rest directions. So a strand that was
// combed otherwise than its neighbours bends otherwise, which a blend of displacements cannot know.
// Off a chain for each strand, of the secondary motion, without contact: `tiny` 8.0 % (vertex layers
// alone) where displacements were 23, `monster` 10.4 where they were 15.8: body, arms and brows 1.6 to
// 1.8 (17, 9.3, 13), head 4.8 (16), tail 13.3 (15). In a tail that whips, three chains do not know
// what a strand combed between them remembers. Tried and not better: loads without the multipliers
// (15.7), along the chains' directions left out (17), inertia that turns with the groom (10.7), solved in
// sweeps with the curl on its parent (10.1 after 40), and Newton steps on the lengths (worse).
//
// Strength, clumping and what strands keep out of are a chain's own (modal_contact.hpp): a load that a
// contact puts on a chain is not what a strand beside it needs.
//
// Invariant: control strands are the first lanes; they are written first and never clump, so a
// follower reads points of this frame for any lane count. Where chains lie on their groom,
// start there or are sag-free and at rest, and nothing clumps, a strand lies on its groom (to
// rounding).
#pragma once

#include <string_view>

#include "core/kernel.hpp"
#include "core/kernels/lane_list.hpp"
#include "core/kernels/modal_contact.hpp"
#include "core/kernels/modal_load.hpp"
#include "core/kernels/prefetch.hpp"
#include "core/kernels/vertex_records.hpp"
#include "core/streams.hpp"

namespace pelt {

template <class V>
struct InterpolateModal {
  static constexpr std::string_view kName = "interpolate_modal";
  static constexpr uint32_t N = modal::kVertexNodes;
  using Params = SimulateParams;
  struct Ports {
    Shared<&Streams::layers> layer;
    Shared<&Streams::modal_tables> table;
    In<&Streams::chunk_state> state;
    In<&Streams::strands> strands;
    In<&Streams::strand_rest4> rest;
    In<&Streams::roots> roots;
    VertexLoads loads;
    Out<&Streams::strand_points4> points;
  };

  static constexpr auto kTraits = &Streams::strand_traits;
  PELT_INLINE static void Run(const Params& params, const Ports& ports,
                              const TraitBlock* block = nullptr) {
    const uint32_t end = RoundUpToLaneGroups(ports.state->live_strands);
    const modal::BarePivots bare(*ports.table);
    uint32_t controls = end;
    if (ports.layer->flags & kLayerClump) {
      const uint32_t count = ports.strands->control_count;
      if (count > 0 && count < end) controls = count;
    }
    Inside inside;
    WriteRange(params, ports, block, bare, 0, controls, end, false, inside);
    WriteRange(params, ports, block, bare, controls, end, end, true, inside);
  }

 private:
  using Few = typename AtMostLanes<V, 8>::Type;

  // Few lanes of many groups are inside of what they keep out of.
  struct Inside {
    PickedLanes<Few> group;
    LaneList<V> lanes;
  };

  PELT_INLINE static void WriteRange(const Params& params, const Ports& ports,
                                     const TraitBlock* block, const modal::BarePivots& bare,
                                     uint32_t begin, uint32_t end, uint32_t last, bool follows,
                                     Inside& inside) {
    inside.lanes.count = 0;
    for (uint32_t lane = begin; lane < end; lane += V::kLanes)
      WriteGroup(params, ports, block, bare, lane, last, follows, inside);
    if (inside.lanes.count > 0) KeepOut(params, ports, inside);
  }

  PELT_INLINE static void WriteGroup(const Params& params, const Ports& ports,
                                     const TraitBlock* block, const modal::BarePivots& bare,
                                     uint32_t lane, uint32_t end, bool follows, Inside& inside) {
    const auto ahead =
        PrefetchInPieces<V::kLanes, 4>(lane, end, AllRows(*ports.rest), AllRows(*ports.points));
    const LayerBlock& layer = *ports.layer;
    const StrandBlock& strands = *ports.strands;
    chain::Group<V, N> g;
    ahead(Piece<0>());
    chain::LoadGroom<V, N + 1>(*ports.rest, *ports.roots, 0.0f, layer.scale, lane, g);
    ahead(Piece<1>());
    const V per_length = V(1.0f) / g.length;
    Vec3<V> rest[N], load[N], d[N];
    V bary[3], stretch[N];
    for (int k = 0; k < 3; ++k) bary[k] = V::Load(strands.bary[k] + lane) * per_length;
    const BlendedRecords<V, N> blend(ports.loads, strands, bary, lane);
    modal::RestTangents(*ports.table, g, per_length, rest);
    modal::StretchOfWeight(layer, *ports.table, per_length, rest, stretch);
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) load[i] = blend.Row(i);
    modal::BendUnderLoad(*ports.table, bare, rest, load, blend.w, stretch, d);
    ahead(Piece<2>());
    modal::DrawCurve(*ports.table, d, rest, g);
    const V strength = V::Load(ports.rest->strength + lane);
    const typename V::Mask full = strength >= V(1.0f);
    if (!AllSet(full)) modal::Weaken(full, strength, g);
    ahead(Piece<3>());
    if (follows) {
      const auto controls = chain::ControlsOf<V>(strands.control, strands.control_count, lane);
      Vec3<V> control[N];
      for (uint32_t i = 0; i < N; ++i)
        control[i] = Load3<V>(ports.points->position[i], controls) - g.root;
      if (block)
        modal::Gather(traits::ShareOf<V>(layer.clump, block->clump, lane), control, g);
      else
        modal::Gather(layer.clump, control, g);
    }
    for (uint32_t i = 0; i < N; ++i) Store3(ports.points->position[i], lane, g.root + g.point[i]);
    // Chains that start afresh lie on their groom wherever that is, and their strands too.
    if ((layer.flags & kLayerSimulate) == 0 || (ports.state->flags & kChunkRestart)) return;
    if (!chain::HasSurface(layer) && !Colliders<V>::HasAny(params)) return;
    const typename V::Mask keeps_out = strength > V(0.0f);
    const typename V::Mask is_inside = IsInside(params, layer, g) & keeps_out;
    if (Any(is_inside)) inside.lanes.Add(is_inside, lane);
  }

  PELT_INLINE static typename V::Mask IsInside(const Params& params, const LayerBlock& layer,
                                               const chain::Group<V, N>& g) {
    if (Colliders<V>::HasAny(params)) return IsInsideAny(params, layer, g);
    V lowest = Dot(g.point[0], g.normal);
    PELT_UNROLL
    for (uint32_t i = 1; i < N; ++i) lowest = Min(lowest, Dot(g.point[i], g.normal));
    return lowest < V(0.0f);
  }

  static __attribute__((noinline)) typename V::Mask IsInsideAny(const Params& params,
                                                                const LayerBlock& layer,
                                                                const chain::Group<V, N>& g) {
    return modal::IsInside(modal::DrawnWalls(layer, params, g), g);
  }

  static __attribute__((noinline)) void KeepOut(const Params& params, const Ports& ports,
                                                Inside& inside) {
    PointBlock<N + 1>& points = *ports.points;
    for (uint32_t first = 0; first < inside.lanes.count; first += uint32_t(Few::kLanes)) {
      const PickedLanes<Few>& at = inside.lanes.Group(first, inside.group);
      chain::Group<Few, N> g;
      g.root = Load3<Few>(ports.roots->position, at);
      g.normal = Load3<Few>(ports.roots->normal, at);
      g.length = chain::LinkLength<Few>(*ports.rest, ports.layer->scale, at);
      for (uint32_t i = 0; i < N; ++i) g.point[i] = Load3<Few>(points.position[i], at) - g.root;
      const auto walls = modal::DrawnWalls(*ports.layer, params, g);
      const typename Few::Mask all = Few(0.0f) < Few(1.0f);
      modal::LeanPartsOut(walls, all, g);
      for (uint32_t i = 0; i < N; ++i) {
        const Vec3<Few> to = g.root + g.point[i];
        StoreLanes(to.x, points.position[i][0], at);
        StoreLanes(to.y, points.position[i][1], at);
        StoreLanes(to.z, points.position[i][2], at);
      }
    }
  }
};

}  // namespace pelt
