// What a free step notes of what strands touch, in the place of what pushes them out
// (modal_touch.hpp).
#pragma once

#include "core/kernels/modal_obstacle.hpp"

namespace pelt::modal {

// Which lanes end a substep inside something. What such a lane does from there on is of no use.
template <class W, uint32_t N, uint32_t Q>
struct TouchNotes {
  typename W::Mask inside = W(1.0f) < W(0.0f);
  bool use = false;  // false: nothing below is set
  Surroundings<W, N, Q> around;

  template <uint32_t kParts>
  PELT_INLINE void Load(const ModalTableBlock& t, const LayerBlock& layer,
                        const SimulateParams& params, Vec3<W> last_surface,
                        const Vec3<W> (&rest)[N], const chain::Group<W, kParts>& g) {
    use = true;
    around.Load(t, layer, params, last_surface, rest, g);
  }
  template <bool kBest>
  PELT_INLINE bool Resolve(const ModalTableBlock& t, uint32_t substep, const Motion<W, N>& motion) {
    if (!use) return false;
    around.Advance(t, substep, motion);
    Vec3<W> at[Q];
    PlaceRows<W, N, Q>(t, motion, &Axis<W, N>::y, around.base, at);
    inside = inside | around.IsInside(at);
    return false;
  }
  PELT_INLINE void Settle(const ModalTableBlock&, uint32_t, const Motion<W, N>&) const {}
};

}  // namespace pelt::modal
