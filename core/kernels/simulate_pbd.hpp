// Simulate, position-based: the solver of Once Upon a Monster, for chains at mesh vertices (one
// fixed and three free points) and for chains of their own.
//
// One iteration sweeps from the root to the tip three times. First the angular constraint turns
// each segment towards the rest direction the root frame carries: a share of the segment's
// difference from its rest vector is removed; hardness differs between the last joint and those
// above it. Then the distance constraint brings the segments back to their length, and links that are
// bent beyond their limit are turned back to it (traits.hpp). Then every point is pushed above the plane
// through the root and out of the colliders (collider.hpp).
//
// Both constraints move both ends of a segment, shared by mass. That matters: an angular constraint
// that moved the lower point alone would be a force without its reaction, and soft chains under
// gravity would whirl for ever (AStillSceneReachesAFixedPoint in the test fails on it). A limit turns what
// is below a joint alone, but only back towards where it may be: chains come to rest on it all the same.
//
// All points of a group stay in registers through all iterations; two groups are solved together
// (unrolled.hpp) because one waits for itself.
//
// What a layer does not use is left out for the whole chunk; leaving it out gives the same bits as
// doing it with a share of 0.
//
// Invariants: see chain.hpp. Control strands come first and never clump, so a follower reads points
// of this frame for any lane count.
#pragma once

#include <string_view>

#include "core/kernels/chain_step.hpp"

namespace pelt {

template <class V, uint32_t kPoints, bool kVertexChains>
struct SimulatePbd {
  static constexpr std::string_view kName = kVertexChains  ? "simulate_pbd_vertex"
                                            : kPoints == 4 ? "simulate_pbd_4"
                                                           : "simulate_pbd_5";
  static constexpr uint32_t kFree = kPoints - 1;
  using Params = SimulateParams;
  using Ports = chain::Ports<kPoints, kVertexChains>;

  static void Run(const Params& params, const Ports& ports) {
    chain::Step<V, kPoints, kVertexChains, SimulatePbd>::Run(params, ports);
  }
  static constexpr auto kTraits = Ports::Of::kTraits;
  static void Run(const Params& params, const Ports& ports, const TraitBlock* block) {
    chain::Step<V, kPoints, kVertexChains, SimulatePbd>::Run(params, ports,
                                                             traits::OwnTraits{block});
  }

  // Angular hardness of the joint at the upper end of segment i.
  template <class Terms>
  PELT_INLINE static auto HardnessAt(const Terms& terms, uint32_t i) {
    const LayerBlock& layer = terms.layer;
    return terms.Hardness(i + 1 == kFree ? layer.link.angular_end : layer.link.angular_middle, i);
  }

  template <class Terms, class W>
  PELT_INLINE static void Iterate(const Terms& terms, const Colliders<W>& colliders, bool clump,
                                  const Vec3<W> (&clump_pull)[kFree], chain::Group<W, kFree>& g) {
    const LayerBlock& layer = terms.layer;
    const chain::LengthRule<W> rule(g.length, layer.link.segment_hardness);
    Vec3<W> pull[kFree];  // rest segment vectors times the joint's hardness
    pull[0] = g.rest[0] * W(HardnessAt(terms, 0));
    for (uint32_t i = 1; i < kFree; ++i)
      pull[i] = (g.rest[i] - g.rest[i - 1]) * W(HardnessAt(terms, i));
    const bool surface = chain::HasSurface(layer);

    for (uint32_t iteration = 0; iteration < layer.link.iterations; ++iteration) {
      if (clump)
        for (uint32_t i = 0; i < kFree; ++i)
          g.point[i] = g.point[i] * W(traits::LeftOf(chain::ClumpShare(terms.Clump(), i, kFree))) +
                       clump_pull[i];
      g.point[0] = g.point[0] * W(traits::LeftOf(HardnessAt(terms, 0))) + pull[0];
      for (uint32_t i = 1; i < kFree; ++i) {
        const Vec3<W> turn = pull[i] - (g.point[i] - g.point[i - 1]) * W(HardnessAt(terms, i));
        g.point[i - 1] = g.point[i - 1] - turn * W(chain::kParentShare);
        g.point[i] = g.point[i] + turn * W(1.0f - chain::kParentShare);
      }
      chain::SetLengths(rule, g.point);
      terms.Limit(g.rest, g.point);
      if (surface) chain::PushAboveSurface(g, layer.surface_hardness);
      colliders.PushOut(g.point);
    }
  }
};

}  // namespace pelt
