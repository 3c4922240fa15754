// Fit ribbon: five points of a strand at equal parameters, root and tip included. Strands of five and nine points have
// them; of four points they are the cubic's through them. So what a solver keeps on the groom, or out of
// a body, is drawn there: a spline with the points for controls cuts their bends, by 1 to 4 % of the length.
#pragma once

#include <string_view>

#include "core/kernel.hpp"
#include "core/kernels/chain.hpp"
#include "core/kernels/prefetch.hpp"
#include "core/kernels/strand_look.hpp"
#include "core/streams.hpp"

namespace pelt {

template <class V, uint32_t kPoints>
struct FitRibbon {
  static constexpr std::string_view kName =
      ByPoints<kPoints>("fit_ribbon_4", "fit_ribbon_5", "fit_ribbon_9");
  static constexpr uint32_t kFree = kPoints - 1;
  using Ports = look::FitPorts<kPoints, &Streams::ribbons>;

  static void Run(const Ports& ports) {
    const uint32_t end = RoundUpToLaneGroups(ports.state->live_strands);
    ForEachPrefetched<V::kLanes>(
        0, end, [&](uint32_t lane) __attribute__((always_inline)) { FitGroup(ports, lane); },
        look::RowsOfLook(*ports.strands),
        RecordsFrom<sizeof(RibbonRecord)>(*ports.written, ports.written->record));
  }

 private:
  // Of points at 1/3, 2/3 and 1, the root at 0: the cubic through them at 1/4, 1/2 and 3/4.
  static constexpr float kQuarters[3][3] = {{1.0546875f, -0.2109375f, 0.0390625f},
                                            {0.5625f, 0.5625f, -0.0625f},
                                            {-0.2109375f, 1.0546875f, 0.1171875f}};

  // Between the root and the tip; r: 1 to 3.
  PELT_INLINE static Vec3<V> InnerPoint(const Ports& ports, Vec3<V> root, uint32_t lane,
                                        uint32_t r) {
    const auto point = [&](uint32_t i) { return Load3<V>(ports.points->position[i], lane); };
    if constexpr (kFree != 3) {
      return point(r * (kFree / 4) - 1);
    } else {
      const float(&weight)[3] = kQuarters[r - 1];
      Vec3<V> sum = (point(0) - root) * V(weight[0]);
      for (uint32_t i = 1; i < 3; ++i) sum = sum + (point(i) - root) * V(weight[i]);
      return root + sum;
    }
  }

  PELT_INLINE static void FitGroup(const Ports& ports, uint32_t lane) {
    const Vec3<V> root = Load3<V>(ports.roots->position, lane);
    Vec3<V> p[kRibbonPoints];
    p[0] = root;
    for (uint32_t r = 1; r + 1 < kRibbonPoints; ++r) p[r] = InnerPoint(ports, root, lane, r);
    p[kRibbonPoints - 1] = Load3<V>(ports.points->position[kFree - 1], lane);

    const auto look = look::Look<V>(*ports.layer, *ports.state, *ports.strands, lane);
    RibbonRecord* record = ports.written->record + lane;
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
