// Fit cubic: one polynomial P(t) = c0 + t (c1 + t (c2 + t c3)) per strand, from its chain.
//
// The curve leaves the root exactly (c0 is the root) and meets point i of n free points at t = i /
// n in the least-squares sense: three are interpolated, four missed by little, eight by the bends
// that no cubic has. Each is one constant matrix, the pseudo-inverse of A with A_ij = t_i^j, worked
// out at compile time; it acts on offsets from the root, so precision does not depend on where in
// the world the strand is.
//
// Invariant: a strand's record is 64 bytes at its own lane; the second half of the frame gathers
// records and needs nothing else of the strand.
#pragma once

#include <string_view>

#include "core/kernel.hpp"
#include "core/kernels/chain.hpp"
#include "core/kernels/prefetch.hpp"
#include "core/kernels/strand_look.hpp"
#include "core/streams.hpp"

namespace pelt {

namespace fit_cubic_detail {

template <uint32_t kFree>
struct Matrix {
  float m[3][kFree];  // c_(j + 1) = sum over i of m[j][i] * (point i - root)
};

// (A^T A)^-1 A^T by the adjugate of the symmetric 3 x 3 matrix.
template <uint32_t kFree>
constexpr Matrix<kFree> MakeMatrix() {
  double a[kFree][3] = {}, n[3][3] = {};
  for (uint32_t i = 0; i < kFree; ++i) {
    const double t = double(i + 1) / double(kFree);
    a[i][0] = t;
    a[i][1] = t * t;
    a[i][2] = t * t * t;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) n[r][c] += a[i][r] * a[i][c];
  }
  double adjugate[3][3] = {};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      adjugate[c][r] = n[r1][c1] * n[r2][c2] - n[r1][c2] * n[r2][c1];
    }
  const double det = n[0][0] * adjugate[0][0] + n[0][1] * adjugate[1][0] + n[0][2] * adjugate[2][0];
  Matrix<kFree> out{};
  for (int j = 0; j < 3; ++j)
    for (uint32_t i = 0; i < kFree; ++i) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) sum += adjugate[j][k] * a[i][k];
      out.m[j][i] = float(sum / det);
    }
  return out;
}
static_assert(MakeMatrix<3>().m[0][0] == 9.0f && MakeMatrix<3>().m[1][1] == 18.0f &&
              MakeMatrix<3>().m[2][2] == 4.5f);

}  // namespace fit_cubic_detail

template <class V, uint32_t kPoints>
struct FitCubic {
  static constexpr std::string_view kName =
      ByPoints<kPoints>("fit_cubic_4", "fit_cubic_5", "fit_cubic_9");
  static constexpr uint32_t kFree = kPoints - 1;
  using Ports = look::FitPorts<kPoints, &Streams::curves>;

  static void Run(const Ports& ports) {
    const uint32_t end = RoundUpToLaneGroups(ports.state->live_strands);
    ForEachPrefetched<V::kLanes>(
        0, end, [&](uint32_t lane) __attribute__((always_inline)) { FitGroup(ports, lane); },
        look::RowsOfLook(*ports.strands),
        RecordsFrom<sizeof(CurveRecord)>(*ports.written, ports.written->record));
  }

 private:
  PELT_INLINE static void FitGroup(const Ports& ports, uint32_t lane) {
    constexpr auto kMatrix = fit_cubic_detail::MakeMatrix<kFree>();
    const Vec3<V> root = Load3<V>(ports.roots->position, lane);
    Vec3<V> c[3];
    for (uint32_t i = 0; i < kFree; ++i) {
      const Vec3<V> offset = Load3<V>(ports.points->position[i], lane) - root;
      for (int j = 0; j < 3; ++j) {
        const Vec3<V> term = offset * V(kMatrix.m[j][i]);
        c[j] = i == 0 ? term : c[j] + term;
      }
    }
    const auto look = look::Look<V>(*ports.layer, *ports.state, *ports.strands, lane);
    CurveRecord* record = ports.written->record + lane;
    const auto quarter = [record](int q) {
      return [record, q](int l) { return reinterpret_cast<float*>(record + l) + 4 * q; };
    };
    ScatterRecords<V>(quarter(0), root.x, root.y, root.z, c[0].x);
    ScatterRecords<V>(quarter(1), c[0].y, c[0].z, c[1].x, c[1].y);
    ScatterRecords<V>(quarter(2), c[1].z, c[2].x, c[2].y, c[2].z);
    ScatterRecords<V>(quarter(3), FromBits(look.base_colour), FromBits(look.tip_colour), look.width,
                      FromBits(look.tag));
  }
};

}  // namespace pelt
