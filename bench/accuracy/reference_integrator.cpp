#include "bench/accuracy/reference_integrator.hpp"

#include <algorithm>
#include <cmath>

#include "bench/accuracy/dop853.hpp"

namespace pelt::accuracy {
namespace {

using Directions = std::array<Double3, kMaxLinks>;

// a x b with a tridiagonal.
template <int n>
void Tridiagonal(const ChainMatrix& a, const Directions& x, Directions& out) {
  for (int i = 0; i < n; ++i) {
    out[i] = x[i] * a[i][i];
    if (i > 0) out[i] = out[i] + x[i - 1] * a[i][i - 1];
    if (i + 1 < n) out[i] = out[i] + x[i + 1] * a[i][i + 1];
  }
}

// The image of v under the smallest rotation that takes the unit vector a to the unit vector d:
// v - (a + d) ((a + d) . v) / (1 + a . d) + 2 d (a . v).
Double3 Carry(Double3 a, Double3 d, Double3 v) {
  const Double3 sum = a + d;
  return v - sum * (Dot(sum, v) / (1.0 + Dot(a, d))) + d * (2.0 * Dot(a, v));
}

// The derivative of w . Carry(a, d, v) by d.
Double3 CarryGradient(Double3 a, Double3 d, Double3 v, Double3 w) {
  const Double3 sum = a + d;
  const double one = 1.0 + Dot(a, d), sv = Dot(sum, v), sw = Dot(sum, w);
  return w * (2.0 * Dot(a, v) - sv / one) - v * (sw / one) + a * (sw * sv / (one * one));
}

// -grad E_F, up to a part along each direction (which the multipliers take).
template <int n>
void BendWithParent(const ChainMaterial& m, const Directions& d, const Directions& r,
                    Directions& force) {
  force[0] = (r[0] - d[0]) * m.stiffness[0];
  for (int j = 1; j < n; ++j) {
    const Double3 target = Carry(r[j - 1], d[j - 1], r[j]);
    force[j] = (target - d[j]) * m.stiffness[j];
    force[j - 1] =
        force[j - 1] + CarryGradient(r[j - 1], d[j - 1], r[j], d[j] - target) * m.stiffness[j];
  }
}

// Multipliers that keep the links' lengths: (M^-1 o Gram) lambda = -|v|^2 - d . a, then
// a += M^-1 (lambda d).
template <int n>
void KeepLengths(const ChainMatrix& inverse, const ChainState& s, Directions& a) {
  double diagonal[n], off[n] = {}, lambda[n];
  for (int i = 0; i < n; ++i) {
    diagonal[i] = inverse[i][i] * Dot(s.direction[i], s.direction[i]);
    if (i + 1 < n) off[i] = inverse[i][i + 1] * Dot(s.direction[i], s.direction[i + 1]);
    lambda[i] = -Dot(s.rate[i], s.rate[i]) - Dot(s.direction[i], a[i]);
  }
  for (int i = 1; i < n; ++i) {
    const double f = off[i - 1] / diagonal[i - 1];
    diagonal[i] -= f * off[i - 1];
    lambda[i] -= f * lambda[i - 1];
  }
  lambda[n - 1] /= diagonal[n - 1];
  for (int i = n - 2; i >= 0; --i) lambda[i] = (lambda[i] - off[i] * lambda[i + 1]) / diagonal[i];
  Directions push, response;
  for (int i = 0; i < n; ++i) push[i] = s.direction[i] * lambda[i];
  Tridiagonal<n>(inverse, push, response);
  for (int i = 0; i < n; ++i) a[i] = a[i] + response[i];
}

template <int n>
void AccelerateLinks(const ChainDynamics& chain, const BodyPose& pose, const ChainState& s,
                     Directions& a) {
  const ChainMaterial& m = chain.material();
  const ChainMatrices& x = chain.matrices();
  const Strand& strand = chain.strand();
  const double c = m.drag, beta = m.bending_damping;
  Directions strain, force, response;
  for (int i = 0; i < n; ++i) strain[i] = (s.rate[i] - pose.TurnRate(strand.rest[i])) * beta;
  if (m.curl == CurlModel::kRoot) {
    for (int i = 0; i < n; ++i)
      strain[i] = strain[i] + (s.direction[i] - pose.Turn(strand.rest[i]));
    Tridiagonal<n>(x.bending, strain, force);
  } else {
    Directions rest, bend;
    for (int i = 0; i < n; ++i) rest[i] = pose.Turn(strand.rest[i]);
    BendWithParent<n>(m, s.direction, rest, bend);
    Tridiagonal<n>(x.bending, strain, force);
    for (int i = 0; i < n; ++i) force[i] = force[i] - bend[i];
  }
  Tridiagonal<n>(x.mass_inverse, force, response);
  for (int i = 0; i < n; ++i) a[i] = -response[i] - s.rate[i] * c;
  // M^-1 b is 1 / l_1 in the first direction: gravity, wind and the root act there alone.
  const Double3 base =
      m.gravity + pose.wind * c - pose.PlaceBend(strand.root) - pose.PlaceRate(strand.root) * c;
  a[0] = a[0] + base * (1.0 / m.length[0]);
  KeepLengths<n>(x.mass_inverse, s, a);
}

template <int n>
void RungeKuttaStep(const ChainDynamics& chain, const BodyPose (&pose)[dop853::kStages], double h,
                    ChainState& s) {
  using namespace dop853;
  Directions speed[kStages], bend[kStages];
  for (int stage = 0; stage < kStages; ++stage) {
    ChainState at = s;
    for (int k = 0; k < stage; ++k) {
      const double w = h * kA[stage][k];
      if (w == 0.0) continue;
      for (int i = 0; i < n; ++i) {
        at.direction[i] = at.direction[i] + speed[k][i] * w;
        at.rate[i] = at.rate[i] + bend[k][i] * w;
      }
    }
    speed[stage] = at.rate;
    AccelerateLinks<n>(chain, pose[stage], at, bend[stage]);
  }
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < kStages; ++k) {
      s.direction[i] = s.direction[i] + speed[k][i] * (h * kB[k]);
      s.rate[i] = s.rate[i] + bend[k][i] * (h * kB[k]);
    }
    s.direction[i] = Unit(s.direction[i]);
    s.rate[i] = s.rate[i] - s.direction[i] * Dot(s.direction[i], s.rate[i]);
  }
}

// Calls f.operator()<links>().
template <class F>
void ForLinks(int links, F f) {
  if (links == 1) f.template operator()<1>();
  if (links == 2) f.template operator()<2>();
  if (links == 3) f.template operator()<3>();
  if (links == 4) f.template operator()<4>();
  if (links == 8) f.template operator()<8>();
}

}  // namespace

ChainDynamics::ChainDynamics(const ChainMaterial& material, const Strand& strand)
    : material_(material), matrices_(MatricesOf(material)), strand_(strand) {}

void ChainDynamics::Accelerate(const BodyPose& pose, const ChainState& state,
                               Directions& acceleration) const {
  ForLinks(material_.links, [&]<int n>() { AccelerateLinks<n>(*this, pose, state, acceleration); });
}

void ChainDynamics::Bend(const Directions& direction, const Directions& rest,
                         Directions& force) const {
  ForLinks(material_.links, [&]<int n>() {
    if (material_.curl == CurlModel::kParent)
      return BendWithParent<n>(material_, direction, rest, force);
    Directions strain;
    for (int i = 0; i < n; ++i) strain[i] = rest[i] - direction[i];
    Tridiagonal<n>(matrices_.bending, strain, force);
  });
}

double ChainDynamics::Energy(const BodyPose& pose, const ChainState& s) const {
  double energy = 0.0;
  for (int i = 0; i < material_.links; ++i) {
    energy -= matrices_.pull[i] * Dot(material_.gravity, s.direction[i]);
    for (int j = 0; j < material_.links; ++j)
      energy += 0.5 * matrices_.mass[i][j] * Dot(s.rate[i], s.rate[j]);
    const Double3 rest = pose.Turn(strand_.rest[i]);
    Double3 bent = s.direction[i] - rest;
    if (i > 0 && material_.curl == CurlModel::kRoot)
      bent = bent - (s.direction[i - 1] - pose.Turn(strand_.rest[i - 1]));
    if (i > 0 && material_.curl == CurlModel::kParent)
      bent = s.direction[i] - Carry(pose.Turn(strand_.rest[i - 1]), s.direction[i - 1], rest);
    energy += 0.5 * material_.stiffness[i] * Dot(bent, bent);
  }
  return energy;
}

ReferenceIntegrator::ReferenceIntegrator(std::span<const ChainProblem> problems,
                                         int steps_per_second)
    : motion_(problems[0].motion), rate_(steps_per_second) {
  for (const ChainProblem& problem : problems) {
    chains_.emplace_back(problem.material, problem.strand);
    states_.push_back({problem.start, problem.start_rate});
  }
}

void ReferenceIntegrator::Step() {
  const double t = seconds(), h = 1.0 / double(rate_);
  BodyPose pose[dop853::kStages];
  for (int k = 0; k < dop853::kStages; ++k) pose[k] = motion_(t + h * dop853::kC[k]);
  for (size_t c = 0; c < chains_.size(); ++c)
    ForLinks(chains_[c].material().links,
             [&]<int n>() { RungeKuttaStep<n>(chains_[c], pose, h, states_[c]); });
  ++steps_;
}

void ReferenceIntegrator::Kick(size_t problem, Double3 velocity_jump) {
  const ChainDynamics& chain = chains_[problem];
  ChainState& s = states_[problem];
  s.rate[0] = s.rate[0] - velocity_jump * (1.0 / chain.material().length[0]);
  // d . d' = 0 again, with the least change of kinetic energy: the same system as for the
  // accelerations, without the centrifugal part.
  ForLinks(chain.material().links, [&]<int n>() {
    ChainState still = s;
    for (int i = 0; i < n; ++i) still.rate[i] = kZero3;
    KeepLengths<n>(chain.matrices().mass_inverse, still, s.rate);
  });
}

void ReferenceIntegrator::Points(size_t problem, Double3* points) const {
  const ChainDynamics& chain = chains_[problem];
  Double3 at = motion_(seconds()).Place(chain.strand().root);
  for (int i = 0; i < chain.material().links; ++i) {
    at = at + states_[problem].direction[i] * chain.material().length[i];
    points[i] = at;
  }
}

int ReferenceRate(const ChainMaterial& material) {
  // Whips turn a link at up to some 100 rad/s in any material, so the rate is at least 1920 Hz.
  const auto modes = MatricesOf(material).omega;
  const double fastest = modes[material.links - 1];
  int rate = 1920;
  while (fastest > 0.6 * rate) rate *= 2;
  return rate;
}

std::vector<std::vector<Double3>> SolveReference(std::span<const ChainProblem> problems,
                                                 int frames_per_second, int frame_count,
                                                 int steps_per_second) {
  ReferenceIntegrator integrator(problems, steps_per_second);
  std::vector<std::vector<Double3>> points(problems.size());
  for (int frame = 0; frame <= frame_count; ++frame) {
    for (size_t p = 0; p < problems.size(); ++p) {
      points[p].resize(size_t(frame + 1) * problems[p].material.links);
      integrator.Points(p, &points[p][size_t(frame) * problems[p].material.links]);
    }
    if (frame < frame_count)
      for (int s = 0; s < steps_per_second / frames_per_second; ++s) integrator.Step();
  }
  return points;
}

Double3 ReferencePoint(const ChainProblem& problem, int point, double t, int steps_per_second) {
  ReferenceIntegrator integrator(std::span(&problem, 1), steps_per_second);
  const int64_t steps = std::llround(t * steps_per_second);
  for (int64_t s = 0; s < steps; ++s) integrator.Step();
  Double3 points[kMaxLinks];
  integrator.Points(0, points);
  return points[point];
}

}  // namespace pelt::accuracy
