// Models of a hair in the form in which they are compared, and their exact motion on a moving body, in double.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/body_motion.hpp"
#include "bench/accuracy/chain_problem.hpp"
#include "bench/accuracy/small_matrix.hpp"
#include "core/modal/modal_response.hpp"
#include "core/modal/node_model.hpp"

namespace pelt::accuracy {

// ---- The model -------------------------------------------------------------------------------

// A strand as n unit vectors. They stand for the links of a chain, or for tangents at the nodes of a curve.
//
//     M d'' + c M d' + beta K (d' - r') + K (d - r) = b (g + c u - x0'' - c x0') - m (r0'' + c r0')
//                                                     + Lambda d,   |d_i| = 1
//     x(s) = p(s) + L sum over i of X_i(s) (d_i - r_i)
//
// r0 is the clamp's own tangent, m its share of the inertia (0 of links), p the rest curve.
//
// Units: length 1, mass 1, first bending frequency of the rod 1 rad/s.

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

// ---- How it lies on its body -----------------------------------------------------------------

// How a strand grows from its body; s from 0, its root, to 1, its tip.
struct RestShape {
  Double3 root;                                          // m
  std::function<Double3(double s)> tangent_at, bend_at;  // unit; its change per length
};

// A helix, whose tangent turns about an axis that it leans towards.
struct RestCurve {
  Double3 root, tangent, axis;  // m; unit
  double turn;                  // from root to tip, rad

  Double3 TangentAt(double s) const { return Unit(TurnAbout(tangent, axis, turn * s)); }
  Double3 BendAt(double s) const { return Cross(axis, TangentAt(s)) * turn; }  // per length
  operator RestShape() const {
    return {root, [rest = *this](double s) { return rest.TangentAt(s); },
            [rest = *this](double s) { return rest.BendAt(s); }};
  }
};

// A cubic spline through points at equal steps along the strand, the root first; its root is 0.
RestShape ThroughPoints(const std::vector<Double3>& points);

// What a strand weighs, m/s^2.
struct StrandWeight {
  Double3 gravity = {0.0, -9.81, 0.0};  // world
  // On the body: the weight under which it rests as it was groomed, held by forces that turn with the body
  // (core/modal/README.md, "Grooms that hold"); 0: gravity bends it.
  Double3 held = kZero3;
};

// ---- Its motion ------------------------------------------------------------------------------

// The exact motion of a CurveStrand.
//
// The idea: explicit methods would need a million steps a second for the fastest modes of a rod. So the
// linear part is moved exactly, mode by mode, under the cubic that has the body's poses and velocities at
// both ends of a step; the lengths are brought back by Newton's method to the end, along the middle of each
// vector's turn; velocities are made tangent after every step. It is the modal step (core/kernels/
// modal_step.hpp) without its short cuts.
//
// Invariant: of second order in the step. Halving steps of 1/1920 s must not change an error by more than
// 0.1 % of itself, and a Runge-Kutta method that shares nothing with it must agree (tests/accuracy).

using UnknownVectors = std::array<Double3, kMostUnknowns>;

// The strand's equation, in lengths of the strand and seconds.
class CurveDynamics {
 public:
  CurveDynamics(const CurveStrand& strand, const Preset& preset, const RestShape& rest,
                CurlModel curl = CurlModel::kRoot, const StrandWeight& weight = {});

  size_t count() const { return n_; }
  double length() const { return length_; }
  const UnknownVectors& rest() const { return rest_; }
  // What a curl that turns with the strand pulls beyond one that turns with the root: the slope of the energy
  // B/2 int |t' - R r'|^2, R the smallest rotation from the rest tangent to the tangent, less that of
  // B/2 int |t' - r'|^2.
  UnknownVectors CurlLoad(const BodyPose& pose, const UnknownVectors& d) const;
  bool curls() const { return curl_ == CurlModel::kParent; }
  // Directions in which it hangs still on the body in that pose.
  UnknownVectors Equilibrium(const BodyPose& pose) const;
  // d'' with the multipliers that keep |d_i| = 1.
  void Accelerate(const BodyPose& pose, const UnknownVectors& d, const UnknownVectors& rate,
                  UnknownVectors& acceleration) const;

 private:
  friend class CurveMotion;
  // What the body's place adds to direction i, of the body's pose or its derivatives: e_i x0 + (M^-1 m)_i r0.
  Double3 OnBody(size_t i) const { return root_ * root_share_[i] + clamp_ * clamp_share_[i]; }

  size_t n_;
  CurlModel curl_;
  double length_, drag_, damping_, rod_;  // rod_: its stiffness, 1/s^2
  std::vector<BendPlace> bends_;
  std::vector<Double3> rest_tangent_, rest_bend_;  // at those, in the body's frame
  UnknownMatrix mass_, inverse_, stiffness_, modes_{};
  UnknownRow pull_, squares_{}, root_share_{}, clamp_share_{};
  UnknownVectors rest_{};
  UnknownVectors unbent_{};  // where springs rest: `rest_`, and what holds the weight up there
  Double3 root_, clamp_;     // in the body's frame; lengths
  Double3 gravity_;
};

class CurveMotion {
 public:
  // Begins hanging still in `pose`.
  CurveMotion(const CurveDynamics& dynamics, const BodyPose& pose, double step_s);
  // Begins with directions `start`, carried along by the body.
  CurveMotion(const CurveDynamics& dynamics, const BodyPose& pose, double step_s,
              const UnknownVectors& start);
  // The body goes from the last pose to this one in a step.
  void Step(const BodyPose& to);
  const UnknownVectors& directions() const { return d_; }

 private:
  struct Path;  // of the body through a step, as powers of time
  UnknownVectors RunFree(const Path& path);
  // y, its lengths brought back from `free`; and the middle of each vector's turn, twice.
  void KeepLengths(const UnknownVectors& free, UnknownVectors& y, UnknownVectors& middle);
  UnknownVectors AddLoad(const UnknownVectors& free, const UnknownVectors& first,
                         const UnknownVectors& last) const;
  void Take(const UnknownVectors& y, const UnknownVectors& middle);
  void MakeTangent(const Path& path);

  const CurveDynamics& dynamics_;
  double step_;
  std::vector<OscillatorStep> oscillator_;
  // Of y to half a force that is constant over the step, and to a force's change over it.
  UnknownMatrix response_{}, slope_{};
  BodyPose pose_;
  UnknownVectors d_, z_{};  // directions; rates by mode
  UnknownRow lambda_{};
  UnknownVectors load_{};  // of the last step's start
  bool loaded_ = false;
};

}  // namespace pelt::accuracy
