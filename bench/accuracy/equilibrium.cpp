// The chain's own equilibrium: Newton's method on the product of the links' spheres.
//
// Each direction is moved in its tangent plane; the Jacobian of the tangential forces is found by
// central differences (its error only slows the last steps), damped so that the energy falls, and
// not damped once the forces are small. A start on an unstable equilibrium is nudged off it.
#include <algorithm>
#include <cmath>

#include "bench/accuracy/reference_integrator.hpp"
#include "bench/accuracy/small_matrix.hpp"

namespace pelt::accuracy {
namespace {

using Directions = std::array<Double3, kMaxLinks>;
constexpr int kMaxUnknowns = 2 * kMaxLinks;
using Unknowns = std::array<double, kMaxUnknowns>;
using System = std::array<std::array<double, kMaxUnknowns>, kMaxUnknowns>;

class Balance {
 public:
  Balance(const ChainMaterial& material, const Strand& strand)
      : dynamics_(material, strand), pose_(StillPose()), links_(material.links) {
    for (int i = 0; i < links_; ++i) {
      scale_ += material.stiffness[i] + dynamics_.matrices().pull[i] * Length(material.gravity);
      frames_[i] = {};
    }
  }

  void SetFrames(const Directions& d) {
    for (int i = 0; i < links_; ++i) {
      const Double3 helper =
          std::abs(d[i].x) < 0.6 ? Double3{1.0, 0.0, 0.0} : Double3{0.0, 1.0, 0.0};
      frames_[i][0] = Unit(Cross(d[i], helper));
      frames_[i][1] = Cross(d[i], frames_[i][0]);
    }
  }
  Directions Move(const Directions& d, const Unknowns& u, double sign = 1.0) const {
    Directions moved = d;
    for (int i = 0; i < links_; ++i)
      moved[i] =
          Unit(d[i] + frames_[i][0] * (sign * u[2 * i]) + frames_[i][1] * (sign * u[2 * i + 1]));
    return moved;
  }
  // Tangential forces in the frames, over their scale.
  Unknowns Force(const Directions& d) const {
    Directions bend, rest = dynamics_.strand().rest;
    dynamics_.Bend(d, rest, bend);
    Unknowns f{};
    for (int i = 0; i < links_; ++i) {
      Double3 total = bend[i] + dynamics_.material().gravity * dynamics_.matrices().pull[i];
      total = (total - d[i] * Dot(d[i], total)) * (1.0 / scale_);
      f[2 * i] = Dot(total, frames_[i][0]);
      f[2 * i + 1] = Dot(total, frames_[i][1]);
    }
    return f;
  }
  System Stiffness(const Directions& d) const {
    System k{};
    constexpr double kStep = 1e-6;
    for (int column = 0; column < 2 * links_; ++column) {
      Unknowns u{};
      u[column] = kStep;
      const Unknowns ahead = Force(Move(d, u)), behind = Force(Move(d, u, -1.0));
      for (int row = 0; row < 2 * links_; ++row)
        k[row][column] = (behind[row] - ahead[row]) / (2.0 * kStep);
    }
    return k;
  }
  double Energy(const Directions& d) const {
    return dynamics_.Energy(pose_, {d, Directions{}}) / scale_;
  }
  double Size(const Unknowns& f) const {
    double size = 0.0;
    for (int i = 0; i < 2 * links_; ++i) size = std::max(size, std::abs(f[i]));
    return size;
  }
  int unknowns() const { return 2 * links_; }

 private:
  ChainDynamics dynamics_;
  BodyPose pose_;
  int links_;
  double scale_ = 0.0;
  std::array<std::array<Double3, 2>, kMaxLinks> frames_;
};

}  // namespace

std::array<Double3, kMaxLinks> FindEquilibrium(const ChainMaterial& material,
                                               const Strand& strand) {
  Balance balance(material, strand);
  Directions d = strand.rest;
  for (int i = 0; i < material.links; ++i) d[i] = Unit(d[i] + Double3{0.01, 0.003, 0.007});
  double damping = 1.0;
  for (int iteration = 0; iteration < 400; ++iteration) {
    balance.SetFrames(d);
    const Unknowns force = balance.Force(d);
    const double size = balance.Size(force);
    if (size < 1e-15) break;
    System k = balance.Stiffness(d);
    const bool close = size < 1e-6 && damping < 1e-6;
    if (!close)
      for (int i = 0; i < balance.unknowns(); ++i) k[i][i] += damping;
    std::array<std::array<double, 1>, kMaxUnknowns> step{};
    for (int i = 0; i < balance.unknowns(); ++i) step[i][0] = force[i];
    if (!SolveDense(balance.unknowns(), k, step, 1)) break;
    Unknowns u{};
    for (int i = 0; i < balance.unknowns(); ++i) u[i] = step[i][0];
    const Directions next = balance.Move(d, u);
    if (close) {
      if (balance.Size(balance.Force(next)) >= size && size < 1e-13) break;
      d = next;
    } else if (balance.Energy(next) < balance.Energy(d)) {
      d = next;
      damping = std::max(damping * 0.1, 1e-12);
    } else if (size < 1e-6) {
      damping *= 0.1;  // the energy has no digits left
    } else {
      damping *= 10.0;
    }
  }
  return d;
}

}  // namespace pelt::accuracy
