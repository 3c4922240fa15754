// The numbers of the comparison solvers, once for a material and a frame time: plain floats, made
// in double outside of any vector code.
//
// All methods use the same physics (mass, gravity, drag towards the wind, bending energy and
// damping of chain_problem.hpp, curl model L); they differ in how they step it. Two of them cannot
// take the stiffness as it is: PBD and follow-the-leader move towards the rest shape by a share,
// and `stiffness_scale` tunes that share as their users do, by trying.
#pragma once

#include <cstdint>

namespace pelt::accuracy {

struct ChainMaterial;

inline constexpr int kMaxTableLinks = 4, kMaxSubsteps = 64;

enum class Method : uint8_t {
  kFollowTheLeader,  // Mueller, Kim, Chentanez, "Fast Simulation of Inextensible Hair and Fur",
                     // 2012
  kPbd,              // Mueller, Heidelberger, Hennix, Ratcliff, "Position Based Dynamics", 2007
  kXpbd,             // Macklin, Mueller, Chentanez 2016, with the substeps of Macklin et al. 2019
  kXpbdCubic,        // the same, the root on a cubic through its last four samples
  kImplicitEuler,    // what XPBD converges to with a direct solver
  kTrapezoid,        // second order, direct, velocities projected
};

struct MethodSettings {
  Method method = Method::kPbd;
  int substeps = 1;
  int iterations = 1;            // Gauss-Seidel sweeps or Newton steps
  double stiffness_scale = 1.0;  // follow-the-leader, PBD
  double correction = 0.9;       // follow-the-leader: share of the correction given to velocities
  bool one_sided = false;        // PBD: bending moves the lower point only
};

// A stretch of a step, in floats.
struct StepTable {
  int links, substeps, iterations;
  float step, step_inverse;  // of a substep, s
  float keep, take;          // velocity kept by drag over a substep, and 1 - that
  float gravity[3];
  float length[kMaxTableLinks], length_inverse[kMaxTableLinks];
};

struct PointTable {  // follow-the-leader and PBD
  StepTable step;
  float share[kMaxTableLinks];  // of the way to the rest shape, a sweep
  float correction;
  bool one_sided;
};

// Weights of the last four samples (newest first) at the end of a substep, and less those at its
// begin.
struct CubicRootTable {
  float end[kMaxSubsteps][4], change[kMaxSubsteps][4];
};

struct XpbdTable {
  StepTable step;
  bool bends, damped;
  float inverse_mass[kMaxTableLinks + 1];  // the root's is 0
  float compliance[kMaxTableLinks];        // 1 / (k h^2)
  float damping;                           // beta / h
  float denominator[kMaxTableLinks];       // one over the constraint's response
  float below[kMaxTableLinks], at[kMaxTableLinks], above[kMaxTableLinks];  // its gradients
  float lower_share[kMaxTableLinks];                                       // of a length correction
  CubicRootTable root;                                                     // kXpbdCubic
};

// d+ = to_direction d + to_rate d' + to_rest z + pull (g + c u - ...) + response Lambda d
struct DirectTable {
  StepTable step;
  float drag, damping, damping_rate;  // c, beta, beta / h
  float response[kMaxTableLinks][kMaxTableLinks];
  float to_direction[kMaxTableLinks][kMaxTableLinks];
  float to_rate[kMaxTableLinks][kMaxTableLinks];
  float to_rest[kMaxTableLinks][kMaxTableLinks];
  float pull[kMaxTableLinks];
  float mass_inverse[kMaxTableLinks][kMaxTableLinks];
  float system[kMaxTableLinks][kMaxTableLinks];  // the inverse of response: implicit Euler only
  // Weights of the last four samples (newest first) in the cubic through them.
  float middle[kMaxSubsteps][4];     // value at the middle of a substep
  float change[kMaxSubsteps][4];     // value at its end less value at its begin
  float bend[kMaxSubsteps][4];       // second derivative at the middle, 1/s^2
  float start_rate[4], end_rate[4];  // first derivative at the frame's ends, 1/s
};

struct ComparisonTables {
  MethodSettings settings;
  PointTable point;
  XpbdTable xpbd;
  DirectTable direct;
};

// Fills what settings.method uses.
void MakeTables(const ChainMaterial& material, const MethodSettings& settings, double frame_seconds,
                ComparisonTables& tables);

// Weights of samples at 1, 0, -1, -2 in the cubic through them, at s: value, first and second
// derivative by s.
void CubicWeights(double s, double (&value)[4], double (&rate)[4], double (&bend)[4]);

}  // namespace pelt::accuracy
