// How a strand lies on its groom: rest tangents at its nodes, and its points from the tangents.
//
//     x_q = p_q + l sum over i of C_qi (d_i - r_i)
//
// p: the groomed points, l: a part's length. At rest every point is its groomed one, bit for bit.
//
// Only the nodes' tangents have length one; between them the curve may stretch. What is seen does not: where a part
// would be longer than it was groomed it is cut back to that, and what lies beyond it follows.
#pragma once

#include "core/kernels/chain.hpp"
#include "core/modal/modal_block.hpp"

namespace pelt::modal {

// By this share of its square a part may be longer: rounding must not move a strand that rests.
inline constexpr float kLongerPart = 1.6e-5f;

template <class W, uint32_t N, uint32_t kParts>
PELT_INLINE void RestTangents(const ModalTableBlock& t, const chain::Group<W, kParts>& g,
                              W per_length, Vec3<W> (&rest)[N]) {
  Vec3<W> part[kParts];
  part[0] = g.rest[0] * per_length;
  PELT_UNROLL
  for (uint32_t i = 1; i < kParts; ++i) part[i] = (g.rest[i] - g.rest[i - 1]) * per_length;
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    Vec3<W> sum = part[0] * W(t.rest[i][0]);
    PELT_UNROLL
    for (uint32_t j = 1; j < kParts; ++j) sum = sum + part[j] * W(t.rest[i][j]);
    rest[i] = NormalizeOr(sum, part[0]);
  }
}

// Cuts parts that are too long.
template <class W, uint32_t kParts>
PELT_INLINE void KeepParts(chain::Group<W, kParts>& g) {
  using Mask = typename W::Mask;
  const W none = W(0.0f), length2 = g.length * g.length;
  const W most2 = length2 * W(1.0f + kLongerPart);
  Mask any = W(1.0f) < none;
  Vec3<W> last = {none, none, none};
  PELT_UNROLL
  for (uint32_t q = 0; q < kParts; ++q) {
    const Vec3<W> part = g.point[q] - last;
    last = g.point[q];
    any = any | (Dot(part, part) > most2);
  }
  if (!Any(any)) return;
  Vec3<W> shift = {none, none, none};
  last = shift;
  for (uint32_t q = 0; q < kParts; ++q) {
    const Vec3<W> part = g.point[q] - last;
    last = g.point[q];
    const W square = Dot(part, part);
    const W less = g.length * Rsqrt(Max(square, length2)) - W(1.0f);
    shift = shift + part * Select(square > most2, less, none);
    g.point[q] = Select<W>(any, g.point[q] + shift, g.point[q]);
  }
}

template <class W, uint32_t N, uint32_t kParts>
PELT_INLINE void DrawCurve(const ModalTableBlock& t, const Vec3<W> (&d)[N],
                           const Vec3<W> (&rest)[N], chain::Group<W, kParts>& g) {
  constexpr uint32_t kPlacesOfPart = PlacesOf(kParts + 1) / kParts;
  Vec3<W> off[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) off[i] = (d[i] - rest[i]) * g.length;
  PELT_UNROLL
  for (uint32_t q = 0; q < kParts; ++q) {
    const auto& place = t.place[(q + 1) * kPlacesOfPart - 1];
    Vec3<W> moved = off[0] * W(place[0]);
    PELT_UNROLL
    for (uint32_t i = 1; i < N; ++i) moved = moved + off[i] * W(place[i]);
    g.point[q] = g.rest[q] + moved;
  }
  KeepParts(g);
}

// Where places stand when all tangents are nothing, parts from the root. Between two points the groom is the line
// through them.
template <class W, uint32_t N, uint32_t kParts, uint32_t Q>
PELT_INLINE void BasePlaces(const ModalTableBlock& t, const chain::Group<W, kParts>& g,
                            W per_length, const Vec3<W> (&rest)[N], Vec3<W> (&base)[Q]) {
  constexpr uint32_t kPlacesOfPart = Q / kParts;
  static_assert(kPlacesOfPart == 1 || kPlacesOfPart == 2);
  for (uint32_t q = 0; q < Q; ++q) {
    const uint32_t part = q / kPlacesOfPart;
    Vec3<W> at = g.rest[part];
    if (kPlacesOfPart == 2 && q % 2 == 0) at = (part == 0 ? at : at + g.rest[part - 1]) * W(0.5f);
    base[q] = at * per_length;
    for (uint32_t i = 0; i < N; ++i) base[q] = base[q] - rest[i] * W(t.place[q][i]);
  }
}

}  // namespace pelt::modal
