// What a modal strand is made of, in numbers that mean the same at every frame rate: the matrices of its
// equation of motion,
//
//     M d'' + c M d' + beta K (d' - r') + K (d - r) = b (g + c u - x0'' - c x0') + Lambda d,   |d_i| = 1
//
// for a few unit vectors d_i that rest as r_i, and how the strand lies where those are.
//
// StrandMaterial's are tangents at nodes of a smooth curve (node_model.hpp). Any other that have such
// an equation are as good, links of a chain for one.
//
// The idea: lengths scale out. A strand is as many parts long as it has free points, and its mass is arbitrary,
// so one material serves all strands of a layer, independent of their length; a stiffness then has the unit 1/s^2. All
// strands of a layer share their frequencies, as the hair of one coat visibly does; RodFrequency says which one
// a real fibre of some length has.
#pragma once

#include <cstdint>

namespace pelt {

inline constexpr uint32_t kMaxNodes = 4;   // unknown vectors
inline constexpr uint32_t kMaxPlaces = 8;  // points at which something may push a strand

// Of strands of 4, 5 or 9 points.
inline constexpr uint32_t NodesOf(uint32_t points) { return points == 4 ? 3 : 4; }
// Evenly along the strand; every free point is one. Few points lie too far apart to push at them alone.
inline constexpr uint32_t PlacesOf(uint32_t points) { return points == 4 ? 6 : 8; }

struct ModalMaterial {
  using Matrix = double[kMaxNodes][kMaxNodes];

  uint32_t nodes, points;
  Matrix mass, stiffness;               // M; K, 1/s^2
  double pull[kMaxNodes];               // b: of an acceleration, in parts
  double place[kMaxPlaces][kMaxNodes];  // where a place goes with each vector, parts
  double
      rest[kMaxNodes]
          [kMaxPlaces];  // rest vectors from the parts of the groomed shape, before they are unit
  // Of curves whose rest bend turns with them (kernels/modal_curl.hpp); not set of links.
  Matrix bend;               // the curve's bend at a node from the tangents
  double turn[kMaxNodes];    // of the first parts of it: the clamp's tangent from the nodes'
  double weight[kMaxNodes];  // of a node in a mean over the strand, times the rod's stiffness
  double drag_per_s;         // towards the wind: dv/dt = -drag (v - u)
  double bend_damping_s;     // force of bending: K (d - r + bend_damping d/dt (d - r))
  bool parent_curl = false;  // the curl turns with the strand, not with the root
};

// How heavy a rod is for its stiffness: G = w L^3 / B of a strand whose first bending mode has that frequency.
double GammaOf(double frequency_hz, double length_m, double acceleration);
// Below it the stiff nodes are nearer to the rod (README.md).
inline constexpr double kStiffGamma = 8.0;

// A rod. points: 4, 5 or 9. frequency_hz: of the first bending mode, without gravity; 0: no stiffness.
// damping_ratio: share of critical damping that bending alone gives that mode; drag comes on top. `stiff`: its G
// is below kStiffGamma.
ModalMaterial StrandMaterial(uint32_t points, double frequency_hz, double damping_ratio,
                             double drag_per_s, bool stiff = false);

// The first bending frequency, Hz, of the strand that the artists of the originals asked for: those
// set the share of a joint's bend that each solver iteration takes away at 60 frames per second. A
// frame of `iterations` leaves (1 - hardness)^iterations of it; an implicit step of a spring leaves
// 1 / (1 + (omega h)^2). `inner` and `last`: hardness of the joints, 0..1; their mean counts.
double FrequencyOfHardness(uint32_t links, double inner, double last, uint32_t iterations);

// First bending frequency, Hz, of a clamped rod: bending stiffness B (N m^2), mass per length
// (kg/m), length (m).
double RodFrequency(double bending_stiffness, double mass_per_length, double length);

}  // namespace pelt
