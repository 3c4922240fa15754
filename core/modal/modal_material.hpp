// What a modal strand is made of: rigid links joined by springs, in numbers that mean the same at
// every frame rate.
//
//     root o-----o-----o-----o tip        links of equal length; a mass at the end of each
//          k1    k2    k3                 k1 turns the first link towards its rest direction, k2 ..
//             m1    m2    m3              the difference of two neighbours towards its own
//
// The idea: lengths scale out. Everything is stated for links of length 1 (a strand of n links is n
// long) and total mass 1, so one material serves all strands of a layer whatever their length; a
// stiffness then has the unit 1/s^2. All strands of a layer share their frequencies, as the hair of
// one coat visibly does; RodFrequency says which one a real fibre of some length has.
//
// Source: the naive discretisation (k = B / l, equal masses) has its first frequency 42 % low and
// sags 250 % too far; CalibratedMaterial's coefficients were fitted to the continuous rod: sag of a
// clamped strand within 1.6 % (3 links), 0.7 % (4), 0.1 % (8) for w L^3 / B up to 30, the first
// frequency within 0.02 %, the second within 1 %.
#pragma once

#include <cstdint>

namespace pelt {

inline constexpr uint32_t kMaxLinks = 8;

struct ModalMaterial {
  uint32_t links;               // 3, 4 or 8
  double stiffness[kMaxLinks];  // of the joint above each link, 1/s^2
  double mass[kMaxLinks];       // of the point below each link; sums to 1
  double drag_per_s;            // towards the wind: dv/dt = -drag (v - u)
  double bend_damping_s;        // force of a joint: stiffness * (angle + bend_damping * d angle/dt)
  bool parent_curl = false;     // a joint's curl turns with the link above it, not with the root
};

// An elastic rod as n links of L / n: bending stiffness B, mass rho per length.
struct RodCoefficients {
  double stiffness[kMaxLinks];  // times n B / L
  double mass[kMaxLinks];       // times rho L / n; sums to n - 1/2, half a link hangs on the root
};
const RodCoefficients& CalibratedCoefficients(uint32_t links);

// The rod's mass and stiffness over 3, 4 or 8 links so that sag and frequencies come out right.
// frequency_hz: of the first bending mode, without gravity; 0: no stiffness. damping_ratio: share
// of critical damping that bending alone gives that mode; drag comes on top.
ModalMaterial CalibratedMaterial(uint32_t links, double frequency_hz, double damping_ratio,
                                 double drag_per_s);

// Equal masses and equal springs: the chain as such, for measuring a solver without a rod in mind.
ModalMaterial UniformMaterial(uint32_t links, double frequency_hz, double damping_ratio,
                              double drag_per_s);

// The first bending frequency, Hz, of the strand that the artists of the originals asked for: those
// set the share of a joint's bend that each solver iteration takes away at 60 frames per second. A
// frame of `iterations` leaves (1 - hardness)^iterations of it; an implicit step of a spring leaves
// 1 / (1 + (omega h)^2). `inner` and `last`: hardness of the joints, 0..1; their mean counts.
double FrequencyOfHardness(uint32_t links, double inner, double last, uint32_t iterations);

// First bending frequency, Hz, of a clamped rod: bending stiffness B (N m^2), mass per length
// (kg/m), length (m).
double RodFrequency(double bending_stiffness, double mass_per_length, double length);

}  // namespace pelt
