// Where a round shape meets a link, not only its end: the link's nearest point, and whether the
// shape crossed a point between two moments.
//
// Invariant: a shape of radius 0 (one that does not count for a lane) meets nothing.
#pragma once

#include "core/kernels/collider.hpp"

namespace pelt {

// Nearer to its upper end a link is not met: the link above has its end there, and hardly anything
// could turn this one out.
inline constexpr float kLeastShare = 0.25f;

// Where on the link `from` + share * `link` is nearest to the shape. `per_square`: 1 / |link|^2,
// near enough. Exact for spheres; for capsules it goes back and forth between link and axis.
template <class Shape, class W>
PELT_INLINE W NearestShare(const Shape& shape, Vec3<W> from, Vec3<W> link, W per_square) {
  W share = W(1.0f);
  for (int look = 0; look < Shape::kLooks; ++look) {
    const Vec3<W> point = from + link * share, way = shape.Core(point) - from;
    share = Clamp(Dot(way, link) * per_square, W(kLeastShare), W(1.0f));
  }
  return share;
}

// Whether anything of the link is inside.
template <class Shape, class W>
PELT_INLINE typename W::Mask IsLinkInside(const Shape& shape, Vec3<W> from, Vec3<W> to,
                                          W per_square) {
  if constexpr (Shape::kIsRound) {
    const Vec3<W> link = to - from;
    return shape.IsInside(from + link * NearestShare(shape, from, link, per_square));
  } else {
    return shape.IsInside(to);
  }
}

// A ball's crossing of a point: it goes from `first` to `last`, both as seen from the centre.
template <class W>
struct Crossing {
  typename W::Mask any;  // came from outside and got in
  W when;                // the share of its way at which it did
  Vec3<W> normal;        // and where

  PELT_INLINE Crossing(Vec3<W> first, Vec3<W> last, W radius) {
    const Vec3<W> way = last - first;
    const W a = Dot(way, way), b = Dot(first, way), c = Dot(first, first) - radius * radius;
    const W inner = b * b - a * c, none = W(0.0f);
    // What it touched already when it began to move may be a little inside.
    const W outside = radius * radius * W(-0.36f);
    const W enters = none - b - Sqrt(Max(inner, none));
    any = (radius > none) & (c > outside) & (b < none) & (inner > none) & (enters < a);
    when = enters / Max(a, W(1.0e-12f));
    const Vec3<W> hit = first + way * when;
    normal = hit * (W(1.0f) / Max(radius, W(1.0e-6f)));
  }
};

}  // namespace pelt
