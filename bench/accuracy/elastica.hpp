// The clamped rod under its own weight, exactly (planar heavy elastica), by shooting; and how far a
// chain's own equilibrium is from it.
//
//     theta'' = -Gamma (1 - s) cos(theta),   theta(0) = clamp angle,   theta'(1) = 0
//
// s: distance along the rod over its length; theta: angle below the horizontal; Gamma = w L^3 / B
// (w: weight per length). This is the cantilever test of Romero et al., "Physical validation of
// simulators in Computer Graphics", SIGGRAPH 2021.
#pragma once

#include "bench/accuracy/chain_problem.hpp"

namespace pelt::accuracy {

struct Sag {
  double drop;   // H: the tip's height below the clamp over the length
  double reach;  // W: its horizontal distance over the length
};

// `clamp_angle`: of the clamped end below the horizontal, rad, in (-pi/2, pi/2). Relative error
// below 1e-11. The hanging branch: of several equilibria, the one reached from Gamma = 0.
Sag SolveElastica(double gamma, double clamp_angle = 0.0);

// The same of a chain of the material (calibrated or not) with Gamma set by gravity.
Sag SolveChainSag(ChainMaterial material, double gamma, double bending_stiffness, double density,
                  double clamp_angle = 0.0);

// f1 and f2 of a clamped rod, over sqrt(B / (rho L^4)), rad.
inline constexpr double kRodFrequency[3] = {3.5160153, 22.034492, 61.697214};

}  // namespace pelt::accuracy
