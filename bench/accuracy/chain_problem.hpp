// The strand problem that every solver is scored on: a chain of rigid links with bending springs,
// fixed at a moving root.
//
//      root x_0(t)                 x_i = x_0(t) + l_1 d_1 + ... + l_i d_i,   |d_i| = 1
//        o---d_1---o---d_2---o---d_3---o
//
//     M d'' + c M d' + beta K (d' - r') + K (d - r) = b (g + c u - x_0'' - c x_0') + Lambda d
//
// r_j(t) = R(t) r_j: the rest directions, carried by the root. M_ij = l_i l_j (mass from
// max(i, j) on), b_i = l_i (mass from i on), K tridiagonal from the bending energy
// k_1/2 |d_1 - r_1|^2 + sum k_j/2 |(d_j - d_{j-1}) - (r_j - r_{j-1})|^2; M^-1 is tridiagonal.
//
// Two models of the curl. Root ("L"): the energy above. Parent ("F"): the joint's rest curl is
// carried by the parent link, k_j/2 |d_j - T_j d_{j-1}|^2 with T_j d the image of r_j under the
// smallest rotation that takes r_{j-1} to d; damping stays beta K (d' - r').
//
// Invariant: everything is SI and double; nothing here knows about frames or steps.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "bench/accuracy/body_motion.hpp"

namespace pelt::accuracy {

inline constexpr int kMaxLinks = 8;

enum class CurlModel { kRoot, kParent };

struct ChainMaterial {
  int links = 3;
  std::array<double, kMaxLinks> length{};     // m
  std::array<double, kMaxLinks> mass{};       // kg, at the lower end of each link
  std::array<double, kMaxLinks> stiffness{};  // k_j, N m: of the joint at the upper end
  double bending_damping = 0.0;               // beta, s
  double drag = 0.0;                          // c, 1/s
  Double3 gravity = {0.0, -9.81, 0.0};        // m/s^2
  CurlModel curl = CurlModel::kRoot;

  double TotalLength() const;
};

using ChainMatrix = std::array<std::array<double, kMaxLinks>, kMaxLinks>;

// The constant matrices, and the free modes: Phi^T M Phi = 1, Phi^T K Phi = omega^2.
struct ChainMatrices {
  ChainMatrix mass, mass_inverse, bending;  // M, M^-1, K
  std::array<double, kMaxLinks> pull;       // b
  ChainMatrix mode;                         // Phi: column m is mode m
  std::array<double, kMaxLinks> omega;      // rad/s, ascending
};
ChainMatrices MatricesOf(const ChainMaterial& material);

// A strand on a body: where its root is and which way its links rest, in the body's frame.
struct Strand {
  Double3 root = {0.1, 0.0, 0.0};
  std::array<Double3, kMaxLinks> rest{};
};

struct ChainProblem {
  ChainMaterial material;
  Strand strand;
  BodyMotion motion = MotionOf(Motion::kStill);
  std::array<Double3, kMaxLinks> start{};       // d at t = 0, world
  std::array<Double3, kMaxLinks> start_rate{};  // d' at t = 0
};

// ---- The suite's materials and strands -------------------------------------------------------

struct Preset {
  std::string_view name;
  double length;         // m
  double frequency;      // of the first bending mode, Hz
  double drag;           // 1/s
  double damping_ratio;  // of the first mode, from bending alone
};
inline constexpr Preset kPresets[] = {{"dangly", 0.08, 0.8, 6.0, 0.02},
                                      {"soft", 0.06, 2.0, 3.0, 0.02},
                                      {"medium", 0.04, 5.0, 6.0, 0.05},
                                      {"stiff", 0.03, 12.0, 10.0, 0.05}};

// Mass 1, equal links, masses and k, scaled to the first bending mode's frequency; or the
// calibrated coefficients that layers of a groom have.
enum class Coefficients : uint8_t { kUniform, kCalibrated };
ChainMaterial MakeMaterial(const Preset& preset, int links,
                           Coefficients coefficients = Coefficients::kUniform);
// Sets the scale of material.stiffness so that the first mode has `frequency`, Hz.
void ScaleToFrequency(double frequency, ChainMaterial& material);

// An elastic rod as 3, 4 or 8 links of L / n: bending stiffness B, mass rho per length. Fitted to the
// continuous rod: sag of a clamped strand within 1.6 % (3 links), 0.7 % (4), 0.1 % (8) for w L^3 / B up to 30, the
// first frequency within 0.02 %, the second within 1 %.
struct RodCoefficients {
  double stiffness[kMaxLinks];  // times n B / L
  double mass[kMaxLinks];       // times rho L / n; sums to n - 1/2, half a link hangs on the root
};
const RodCoefficients& CalibratedCoefficients(int links);

// An elastic rod as 3, 4 or 8 equal links with calibrated coefficients: bending stiffness B = EI, N
// m^2, and mass per length rho, kg/m.
ChainMaterial CalibratedRod(int links, double length, double bending_stiffness, double density);
// The same with k_j = B / l and equal masses: what the calibration is measured against.
ChainMaterial NaiveRod(int links, double length, double bending_stiffness, double density);

// Seeded strands: roots 10 cm from the centre, spread over the sphere, standing up from it with a
// random curl (degrees per joint) that also turns out of its plane.
struct CurlRange {
  double least = 7.0, most = 22.0;
};
std::vector<Strand> SeededStrands(int links, int count, uint64_t seed, CurlRange curl = {});

// Directions in which the chain hangs still (forces balance to 1e-13) with the body in the
// identity pose, from the rest shape downhill.
std::array<Double3, kMaxLinks> FindEquilibrium(const ChainMaterial& material, const Strand& strand);

}  // namespace pelt::accuracy
