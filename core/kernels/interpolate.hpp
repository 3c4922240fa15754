// Interpolate: the strands of a vertex-chain layer follow the chains at the three vertices of their
// triangle.
//
// A chain says how far its points are from where the groom would have them; that displacement, as a
// share of the chain's length, is blended by the strand's barycentrics, scaled to the strand's
// length and added to the strand's own groomed shape in the strand's own frame:
//
//   strand point i = root + R_s rest_i + L_s * sum over k of bary_k * (c_ki - r_ki) / L_k
//
// Strands of modal layers bend under their chains' loads instead (interpolate_modal.hpp), which is
// a third less wrong in `monster`, two thirds in `tiny`.
//
// Then clumping pulls it towards its control strand of this frame, and last each segment is set to
// its length, root to tip: blending directions shortens, and the groom promised a length.
//
// The displacements are made once for each vertex (chain_loads.hpp).
//
// Invariant: control strands are the first lanes; they are written first and never clump, so a
// follower reads points of this frame for any lane count. Where chains lie on their groom and
// nothing clumps, a strand lies on its groom (to rounding).
#pragma once

#include <string_view>

#include "core/kernel.hpp"
#include "core/kernels/chain.hpp"
#include "core/kernels/prefetch.hpp"
#include "core/kernels/vertex_records.hpp"
#include "core/streams.hpp"

namespace pelt {

template <class V>
struct Interpolate {
  static constexpr std::string_view kName = "interpolate";
  static constexpr uint32_t kFree = 3;
  struct Ports {
    Shared<&Streams::layers> layer;
    In<&Streams::chunk_state> state;
    In<&Streams::strands> strands;
    In<&Streams::strand_rest4> strand_rest;
    In<&Streams::roots> roots;
    VertexLoads loads;
    Out<&Streams::strand_points4> points;
  };

  static constexpr auto kTraits = &Streams::strand_traits;
  PELT_INLINE static void Run(const Ports& ports, const TraitBlock* block = nullptr) {
    const uint32_t end = RoundUpToLaneGroups(ports.state->live_strands);
    uint32_t controls = end;
    if (ports.layer->flags & kLayerClump) {
      const uint32_t count = ports.strands->control_count;
      if (count > 0 && count < end) controls = count;
    }
    WriteRange(ports, block, 0, controls, false);
    if (controls < end) WriteRange(ports, block, controls, end, true);
  }

 private:
  // Two loops: making unit segments waits for square roots, and only short bodies let the machine
  // overlap the waits of several groups with the gathers of others.
  PELT_INLINE static void WriteRange(const Ports& ports, const TraitBlock* block, uint32_t begin,
                                     uint32_t end, bool follows) {
    ForEachPrefetched<V::kLanes>(
        begin, end, [&](uint32_t lane) __attribute__((always_inline)) { BlendGroup(ports, lane); },
        AllRows(*ports.strand_rest), AllRows(*ports.points));
    for (uint32_t lane = begin; lane < end; lane += V::kLanes)
      FinishGroup(ports, block, lane, follows);
  }

  // Offsets from the root, lengths as they come.
  PELT_INLINE static void BlendGroup(const Ports& ports, uint32_t lane) {
    const StrandBlock& strands = *ports.strands;
    chain::Group<V, kFree> g;
    chain::LoadGroom<V, 4>(*ports.strand_rest, *ports.roots, 0.0f, ports.layer->scale, lane, g);
    V bary[3];
    for (int k = 0; k < 3; ++k) bary[k] = V::Load(strands.bary[k] + lane) * g.length;
    const BlendedRecords<V, kFree> blend(ports.loads, strands, bary, lane);
    PELT_UNROLL
    for (uint32_t i = 0; i < kFree; ++i) {
      const Vec3<V> off = blend.Row(i);
      Store3(ports.points->position[i], lane, g.rest[i] + off);
    }
  }

  // Clumps, then sets each segment to its length, root to tip. A segment of no direction stays a
  // point.
  PELT_INLINE static void FinishGroup(const Ports& ports, const TraitBlock* block, uint32_t lane,
                                      bool follows) {
    const Vec3<V> root = Load3<V>(ports.roots->position, lane);
    const V length = chain::LinkLength<V>(*ports.strand_rest, ports.layer->scale, lane);
    Vec3<V> upper{V(0.0f), V(0.0f), V(0.0f)}, at = upper;
    PickedLanes<V> controls;
    if (follows)
      controls = chain::ControlsOf<V>(ports.strands->control, ports.strands->control_count, lane);
    for (uint32_t i = 0; i < kFree; ++i) {
      Vec3<V> point = Load3<V>(ports.points->position[i], lane);
      if (follows) {
        const Vec3<V> to = Load3<V>(ports.points->position[i], controls) - root;
        V share = V(chain::ClumpShare(ports.layer->clump, i, kFree));
        if (block) {
          const V clump = traits::ShareOf<V>(ports.layer->clump, block->clump, lane);
          share = chain::ClumpShare(clump, i, kFree);
        }
        point = point + (to - point) * share;
      }
      const Vec3<V> d = point - upper;
      const Vec3<V> segment = d * (length * Rsqrt(Max(Dot(d, d), V(1.0e-24f))));
      upper = point;
      at = at + segment;
      Store3(ports.points->position[i], lane, root + at);
    }
  }
};

}  // namespace pelt
