// A strand as n unit vectors. They stand for the links of a chain, or for tangents at the nodes of a
// curve. Models of a hair are compared in this form.
//
//     M d'' + c M d' + beta K (d' - r') + K (d - r) = b (g + c u - x0'' - c x0') - m (r0'' + c r0')
//                                                     + Lambda d,   |d_i| = 1
//     x(s) = p(s) + L sum over i of X_i(s) (d_i - r_i)
//
// r0 is the clamp's own tangent, m its share of the inertia (0 of links), p the rest curve.
//
// Units: length 1, mass 1, first bending frequency of the rod 1 rad/s.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/small_matrix.hpp"
#include "core/modal/node_model.hpp"

namespace pelt::accuracy {

inline constexpr size_t kMostUnknowns = 16;
using UnknownMatrix = SquareMatrix<kMostUnknowns>;
using UnknownRow = std::array<double, kMostUnknowns>;

// Where models are compared: at 1/3, 2/3 and the tip.
inline constexpr size_t kComparedPoints = 3;

// A place at which a curve's bend is looked at, and its share of the whole.
struct BendPlace {
  double s, weight;
  UnknownRow tangent{}, bend{};  // N_i(s), N_i'(s)
};

struct CurveStrand {
  std::string name;
  int count;  // n
  UnknownMatrix mass{}, stiffness{};
  UnknownRow pull{}, clamp{};                       // b, m
  std::array<UnknownRow, kComparedPoints> place{};  // X_i at the compared points
  UnknownRow at{};                                  // where the rest curve has rest direction i
  std::vector<BendPlace> bends{};                   // none of links
};

// n links with the coefficients of layers (3, 4 and 8), or of the midpoint rule.
CurveStrand LinksOfStrand(int links);
// Nodes of core/modal/node_model.hpp.
template <size_t N>
CurveStrand NodesOfStrand(std::string name, const NodePlaces<N>& places);
// The rod itself: polynomials of degree 10 on Radau's nodes.
CurveStrand RodOfStrand();
// X_i of the rod at s.
UnknownRow RodPlaceAt(double s);
// Of degree 8: how far the rod has converged.
CurveStrand CoarseRodOfStrand();

}  // namespace pelt::accuracy
