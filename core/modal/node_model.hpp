// A strand as one smooth curve whose unknowns are unit tangents at chosen nodes, in place of links.
//
//     tangent  t(s) = r(s) + sum over i of N_i(s) (d_i - r_i)
//     place    x(s) = p(s) + L sum over i of X_i(s) (d_i - r_i),   X_i(s) = integral of N_i from 0 to s
//
// s goes from 0 (the root) to 1 (the tip); r and p are the rest curve's tangent and place, d_i the
// unknowns at s_i. N_i are polynomials in u = 1 - exp(-a s), a > 0, or u = s for a = 0, that are 0 at the
// root, 1 at node i and 0 at the others: the clamp holds, and most of what they can bend is where a hair
// that is heavy for its stiffness does bend, near the root.
//
// The idea: the equation of motion is that of links (bench/accuracy/chain_problem.hpp), its matrices
// are those of the rod itself,
//
//     M_ij = int X_i X_j,   b_i = int X_i,   K_ij = int N_i' N_j' / 3.516^2,
//
// so a few unknowns have a rod's inertia, weight and bending energy exactly, as far as the curve can take
// its shape. Only the nodes' tangents are kept at length one; between them the curve may stretch.
//
// Units: length of the strand 1, mass 1, first bending frequency of the rod 1 rad/s.
//
// Invariant: double precision and exact arithmetic (core/exact_math.hpp): the same bits everywhere.
//
// Error off a rod, and how nodes and a were chosen: README.md.
#pragma once

#include <array>
#include <cstddef>

namespace pelt {

// First root of cos(x) cosh(x) = -1, squared: the first bending frequency of a clamped rod, over
// sqrt(B / (rho L^4)).
inline constexpr double kRodFrequency1 = 3.5160152685001;

template <size_t N>
struct NodePlaces {
  double bow;                  // a: how much of the curve's freedom is near the root
  std::array<double, N> node;  // s_i, ascending, in (0, 1]
};

// Three nodes, of any strand; of strands that are stiff for their weight (G below kStiffGamma); four.
inline constexpr NodePlaces<3> kThreeNodes = {2.1, {0.089, 0.318, 0.750}};
inline constexpr NodePlaces<3> kThreeStiffNodes = {0.92, {0.150, 0.497, 0.965}};
inline constexpr NodePlaces<4> kFourNodes = {1.6, {0.0685, 0.222, 0.548, 0.827}};

template <size_t N>
struct NodeModel {
  using Row = std::array<double, N>;
  using Matrix = std::array<Row, N>;

  NodePlaces<N> places;
  Matrix mass, stiffness;
  Row pull;   // b: of a force on each unit of mass
  Row clamp;  // int X_i X_0: the share of the clamp's own tangent, X_0 = s - sum of X_i

  // N_i(s), its derivative, and X_i(s).
  Row TangentAt(double s) const;
  Row BendAt(double s) const;
  Row PlaceAt(double s) const;
};

// N: 3, 4, or 8 and 10 (rods to measure by: bench/accuracy/model_error.hpp).
template <size_t N>
NodeModel<N> MakeNodeModel(const NodePlaces<N>& places);

}  // namespace pelt
