// Fit ribbon: five points on a strand's B-spline, at equal parameters, root and tip included.
//
// The chain's points, root first, are the control points of a cubic B-spline with uniform knots,
// clamped at both ends (end knots fourfold), so the ribbon starts at the root and ends at the tip
// exactly and is curvature-continuous between. With four points that is one Bezier cubic; five
// have one inner knot at 1/2, nine five. The basis at the five parameters is a constant matrix, from
// de Boor's recursion at compile time; it acts on offsets from the root.
//
// Source: de Boor, A Practical Guide to Splines, chapter IX.
#pragma once

#include <string_view>

#include "core/kernel.hpp"
#include "core/kernels/chain.hpp"
#include "core/kernels/fetch_ahead.hpp"
#include "core/kernels/strand_look.hpp"
#include "core/streams.hpp"

namespace pelt {

namespace fit_ribbon_detail {

template <uint32_t kPoints>
struct Basis {
  float b[kRibbonPoints][kPoints];  // ribbon point r = sum over p of b[r][p] * chain point p
};

template <uint32_t kPoints>
constexpr Basis<kPoints> MakeBasis() {
  constexpr uint32_t kKnots = kPoints + 4, kSpans = kPoints - 3;
  double knot[kKnots] = {};
  for (uint32_t k = 0; k < kKnots; ++k) {
    const uint32_t inner = k < 3 ? 0 : k - 3;
    knot[k] = double(inner < kSpans ? inner : kSpans) / double(kSpans);
  }
  Basis<kPoints> out{};
  for (uint32_t r = 0; r < kRibbonPoints; ++r) {
    const double t = double(r) / double(kRibbonPoints - 1);
    double n[kKnots - 1] = {};
    // Of degree 0: the span that holds t (the last non-empty one for t = 1).
    uint32_t span = 3;
    while (span + 1 < kPoints && t >= knot[span + 1]) ++span;
    n[span] = 1.0;
    for (uint32_t degree = 1; degree <= 3; ++degree)
      for (uint32_t k = 0; k + degree + 1 < kKnots; ++k) {
        const double left = knot[k + degree] - knot[k];
        const double right = knot[k + degree + 1] - knot[k + 1];
        n[k] = (left > 0.0 ? (t - knot[k]) / left * n[k] : 0.0) +
               (right > 0.0 ? (knot[k + degree + 1] - t) / right * n[k + 1] : 0.0);
      }
    for (uint32_t p = 0; p < kPoints; ++p) out.b[r][p] = float(n[p]);
  }
  return out;
}
static_assert(MakeBasis<4>().b[2][1] == 0.375f && MakeBasis<4>().b[4][3] == 1.0f);
static_assert(MakeBasis<5>().b[2][2] == 0.5f && MakeBasis<5>().b[4][4] == 1.0f &&
              MakeBasis<5>().b[4][3] == 0.0f);

}  // namespace fit_ribbon_detail

template <class V, uint32_t kPoints>
struct FitRibbon {
  static constexpr std::string_view kName =
      ByPoints<kPoints>("fit_ribbon_4", "fit_ribbon_5", "fit_ribbon_9");
  static constexpr uint32_t kFree = kPoints - 1;
  struct Ports {
    Shared<&Streams::layers> layer;
    In<&Streams::chunk_state> state;
    In<&Streams::strands> strands;
    In<&Streams::roots> roots;
    In<ChainStreams<kPoints, false>::kPosition> points;
    Out<&Streams::ribbons> ribbons;
  };

  static void Run(const Ports& ports) {
    const uint32_t end = RoundUpToLaneGroups(ports.state->live_strands);
    for (uint32_t lane = 0; lane < end; lane += V::kLanes) {
      look::FetchAhead<V::kLanes>(*ports.strands, lane, end);
      FetchRecordsAhead<RibbonBlock, V::kLanes, sizeof(RibbonRecord)>(ports.ribbons->record, lane,
                                                                      end);
      FitGroup(ports, lane);
    }
  }

 private:
  PELT_INLINE static void FitGroup(const Ports& ports, uint32_t lane) {
    constexpr auto kBasis = fit_ribbon_detail::MakeBasis<kPoints>();
    const Vec3<V> root = Load3<V>(ports.roots->position, lane);
    Vec3<V> offset[kFree], p[kRibbonPoints];
    for (uint32_t i = 0; i < kFree; ++i)
      offset[i] = Load3<V>(ports.points->position[i], lane) - root;
    p[0] = root;
    for (uint32_t r = 1; r + 1 < kRibbonPoints; ++r) {
      Vec3<V> sum = offset[0] * V(kBasis.b[r][1]);
      for (uint32_t i = 1; i < kFree; ++i) sum = sum + offset[i] * V(kBasis.b[r][i + 1]);
      p[r] = root + sum;
    }
    p[kRibbonPoints - 1] = Load3<V>(ports.points->position[kFree - 1], lane);

    const auto look = look::Look<V>(*ports.layer, *ports.state, *ports.strands, lane);
    RibbonRecord* record = ports.ribbons->record + lane;
    const auto part = [record](int q) {
      return [record, q](int l) { return reinterpret_cast<float*>(record + l) + 4 * q; };
    };
    static_assert(kRibbonPoints == 5 && sizeof(RibbonRecord) == 80);
    ScatterRecords<V>(part(0), p[0].x, p[0].y, p[0].z, p[1].x);
    ScatterRecords<V>(part(1), p[1].y, p[1].z, p[2].x, p[2].y);
    ScatterRecords<V>(part(2), p[2].z, p[3].x, p[3].y, p[3].z);
    ScatterRecords<V>(part(3), p[4].x, p[4].y, p[4].z, FromBits(look.base_colour));
    ScatterRecords<V>(part(4), FromBits(look.tip_colour), look.width, FromBits(look.tag), V(0.0f));
  }
};

}  // namespace pelt
