// Simulate, Verlet: the solver of EyePet, for chains of their own (five points as shipped, or
// four).
//
// Verlet integration, then in each iteration, in the original's order: stiffness (every point goes
// a share of the way to its rest point, which the root frame carries), clumping (a share of the way
// to the same point of its control strand, growing from root to tip), and last the position
// constraints: segment lengths from root to tip, limits of bends (traits.hpp), the plane through the root,
// colliders. There is no pull on angles here: stiffness towards absolute rest points does its work.
//
// What a layer does not use is left out for the whole chunk; leaving it out gives the same bits as
// doing it with a share of 0. Invariants: see chain.hpp and chain_step.hpp.
#pragma once

#include <string_view>

#include "core/kernels/chain_step.hpp"

namespace pelt {

template <class V, uint32_t kPoints>
struct SimulateVerlet {
  static constexpr std::string_view kName =
      kPoints == 4 ? "simulate_verlet_4" : "simulate_verlet_5";
  static constexpr uint32_t kFree = kPoints - 1;
  using Params = SimulateParams;
  using Ports = chain::Ports<kPoints, false>;

  static void Run(const Params& params, const Ports& ports) {
    chain::Step<V, kPoints, false, SimulateVerlet>::Run(params, ports);
  }
  static constexpr auto kTraits = Ports::Of::kTraits;
  static void Run(const Params& params, const Ports& ports, const TraitBlock* block) {
    chain::Step<V, kPoints, false, SimulateVerlet>::Run(params, ports, traits::OwnTraits{block});
  }

  template <class Terms, class W>
  PELT_INLINE static void Iterate(const Terms& terms, const Colliders<W>& colliders, bool clump,
                                  const Vec3<W> (&clump_pull)[kFree], chain::Group<W, kFree>& g) {
    const LayerBlock& layer = terms.layer;
    const chain::LengthRule<W> rule(g.length, layer.link.segment_hardness);
    const W keep = W(1.0f - layer.link.stiffness);
    Vec3<W> pull[kFree];
    for (uint32_t i = 0; i < kFree; ++i)
      pull[i] = g.rest[i] * W(terms.Hardness(layer.link.stiffness, i));
    const auto kept = [&](uint32_t i) __attribute__((always_inline)) {
      if constexpr (Terms::kOfLanes)
        return traits::LeftOf(terms.Hardness(layer.link.stiffness, i));
      else
        return keep;
    };
    const bool surface = chain::HasSurface(layer);

    for (uint32_t iteration = 0; iteration < layer.link.iterations; ++iteration) {
      for (uint32_t i = 0; i < kFree; ++i) g.point[i] = g.point[i] * kept(i) + pull[i];
      if (clump)
        for (uint32_t i = 0; i < kFree; ++i)
          g.point[i] = g.point[i] * W(traits::LeftOf(chain::ClumpShare(terms.Clump(), i, kFree))) +
                       clump_pull[i];
      chain::SetLengths(rule, g.point);
      terms.Limit(g.rest, g.point);
      if (surface) chain::PushAboveSurface(g, layer.surface_hardness);
      colliders.PushOut(g.point);
    }
  }
};

}  // namespace pelt
