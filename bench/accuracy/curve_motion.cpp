#include "bench/accuracy/curve_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace pelt::accuracy {
namespace {

// A cubic spline through points at equal steps of s, whose first two and last two parts are one cubic each.
struct Spline {
  explicit Spline(std::vector<Double3> points) : point(std::move(points)), second(point.size()) {
    const size_t n = point.size() - 1;
    // Each row's diagonal is four times what is beside it: a sweep leaves at most half of what is wrong.
    constexpr int kSweeps = 60;
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (size_t k = 1; k < n; ++k) {
        const Double3 bend =
            (point[k + 1] - point[k] * 2.0 + point[k - 1]) * (6.0 * double(n) * double(n));
        const bool end = k == 1 || k + 1 == n;
        second[k] = end ? bend * (1.0 / 6.0) : (bend - second[k - 1] - second[k + 1]) * (1.0 / 4.0);
      }
    second[0] = second[1] * 2.0 - second[2];
    second[n] = second[n - 1] * 2.0 - second[n - 2];
  }

  // The first and second derivative.
  void At(double s, Double3& rate, Double3& bend) const {
    const double n = double(point.size() - 1);
    const size_t k = std::min(size_t(s * n), point.size() - 2);
    const double u = s * n - double(k), v = 1.0 - u;
    rate =
        (point[k + 1] - point[k]) * n +
        (second[k + 1] * (3.0 * u * u - 1.0) - second[k] * (3.0 * v * v - 1.0)) * (1.0 / (6.0 * n));
    bend = second[k] * v + second[k + 1] * u;
  }

  std::vector<Double3> point, second;
};

}  // namespace

RestShape ThroughPoints(const std::vector<Double3>& points) {
  const Spline spline(points);
  return {kZero3,
          [spline](double s) {
            Double3 rate, bend;
            spline.At(s, rate, bend);
            return Unit(rate);
          },
          [spline](double s) {
            Double3 rate, bend;
            spline.At(s, rate, bend);
            const Double3 tangent = Unit(rate);
            return (bend - tangent * Dot(tangent, bend)) * (1.0 / Length(rate));
          }};
}

namespace {

// a x = b, a symmetric and positive definite; b becomes x.
void SolvePositive(size_t n, UnknownMatrix& a, UnknownRow& b) {
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j <= i; ++j) {
      double sum = a[i][j];
      for (size_t k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
    }
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
}

UnknownRow Times(size_t n, const UnknownMatrix& a, const UnknownRow& x) {
  UnknownRow y{};
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j) y[i] += a[i][j] * x[j];
  return y;
}

}  // namespace

CurveDynamics::CurveDynamics(const CurveStrand& strand, const Preset& preset, const RestShape& rest,
                             CurlModel curl, const StrandWeight& weight)
    : n_(size_t(strand.count)),
      curl_(curl),
      length_(preset.length),
      drag_(preset.drag),
      damping_(2.0 * preset.damping_ratio / (2.0 * std::numbers::pi * preset.frequency)),
      mass_(strand.mass),
      inverse_(Inverse(strand.count, strand.mass)),
      stiffness_(strand.stiffness),
      pull_(strand.pull),
      root_(rest.root * (1.0 / preset.length)),
      clamp_(rest.tangent_at(0.0)),
      gravity_(weight.gravity) {
  const double omega = 2.0 * std::numbers::pi * preset.frequency;
  for (auto& row : stiffness_)
    for (double& k : row) k *= omega * omega;
  rod_ = omega * omega / (kRodFrequency1 * kRodFrequency1);
  bends_ = strand.bends;
  for (const BendPlace& place : bends_) {
    rest_tangent_.push_back(rest.tangent_at(place.s));
    rest_bend_.push_back(rest.bend_at(place.s));
  }
  SolveModes(strand.count, mass_, stiffness_, modes_, squares_);
  root_share_ = Times(n_, inverse_, strand.pull);
  clamp_share_ = Times(n_, inverse_, strand.clamp);
  for (size_t i = 0; i < n_; ++i) rest_[i] = rest.tangent_at(strand.at[i]);
  unbent_ = rest_;
  const UnknownMatrix give = Inverse(strand.count, stiffness_);
  for (size_t j = 0; j < n_; ++j) {
    const double stretch = std::max(Dot(weight.held, rest_[j]), 0.0);
    const Double3 hold = (rest_[j] * stretch - weight.held) * (pull_[j] / length_);
    for (size_t i = 0; i < n_; ++i) unbent_[i] = unbent_[i] + hold * give[i][j];
  }
}

UnknownVectors CurveDynamics::CurlLoad(const BodyPose& pose, const UnknownVectors& d) const {
  UnknownVectors load{};
  UnknownVectors off;
  for (size_t i = 0; i < n_; ++i) off[i] = d[i] - pose.Turn(rest_[i]);
  for (size_t q = 0; q < bends_.size(); ++q) {
    const BendPlace& place = bends_[q];
    const Double3 r = pose.Turn(rest_tangent_[q]), v = pose.Turn(rest_bend_[q]);
    Double3 tangent = r, bend = v;
    for (size_t i = 0; i < n_; ++i) {
      tangent = tangent + off[i] * place.tangent[i];
      bend = bend + off[i] * place.bend[i];
    }
    const double length = Length(tangent);
    const Double3 u = tangent * (1.0 / length), sum = r + u;
    const double inverse = 1.0 / std::max(1.0 + Dot(r, u), 0.05);
    const double x = inverse * Dot(u, v);
    const Double3 carried = v - sum * x, other = bend - carried;
    const double y = inverse * Dot(sum, other);
    const Double3 turn = r * (x * y) - other * x - v * y;
    const Double3 side = (turn - u * Dot(turn, u)) * (1.0 / length);
    const double weight = rod_ * place.weight;
    for (size_t i = 0; i < n_; ++i)
      load[i] = load[i] + ((carried - v) * place.bend[i] + side * place.tangent[i]) * weight;
  }
  return load;
}

UnknownVectors CurveDynamics::Equilibrium(const BodyPose& pose) const {
  // Each vector in turn to where its energy is least.
  UnknownVectors d, force;
  for (size_t i = 0; i < n_; ++i) {
    d[i] = pose.Turn(rest_[i]);
    force[i] = gravity_ * (pull_[i] / length_);
    for (size_t j = 0; j < n_; ++j) force[i] = force[i] + pose.Turn(unbent_[j]) * stiffness_[i][j];
  }
  constexpr int kMostSweeps = 60000;
  constexpr double kCurlStep = 0.3;
  UnknownVectors curl{};
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double change = 0.0;
    for (size_t i = 0; i < n_; ++i) {
      Double3 push = force[i];
      for (size_t j = 0; j < n_; ++j)
        if (j != i) push = push - d[j] * stiffness_[i][j];
      const Double3 to = Unit(push);
      change = std::max(change, Length(to - d[i]));
      d[i] = to;
    }
    if (change < 1e-13) break;
    // The curl's load goes with the shape, a little at a time.
    if (curls()) {
      const UnknownVectors load = CurlLoad(pose, d);
      for (size_t i = 0; i < n_; ++i) {
        const Double3 step = (load[i] - curl[i]) * kCurlStep;
        curl[i] = curl[i] + step;
        force[i] = force[i] + step;
      }
    }
  }
  return d;
}

void CurveDynamics::Accelerate(const BodyPose& pose, const UnknownVectors& d,
                               const UnknownVectors& rate, UnknownVectors& acceleration) const {
  const Double3 push =
      (gravity_ + pose.wind * drag_ - pose.acceleration - pose.velocity * drag_) * (1.0 / length_);
  UnknownVectors strain, force;
  for (size_t i = 0; i < n_; ++i)
    strain[i] = d[i] - pose.Turn(unbent_[i]) + (rate[i] - pose.TurnRate(unbent_[i])) * damping_;
  for (size_t i = 0; i < n_; ++i) {
    force[i] = push * pull_[i];
    for (size_t j = 0; j < n_; ++j) force[i] = force[i] - strain[j] * stiffness_[i][j];
  }
  UnknownMatrix gram;
  UnknownRow lambda;
  for (size_t i = 0; i < n_; ++i) {
    const Double3 body = OnBody(i);
    acceleration[i] = (rate[i] + pose.TurnRate(body)) * -drag_ - pose.TurnBend(body);
    for (size_t j = 0; j < n_; ++j) acceleration[i] = acceleration[i] + force[j] * inverse_[i][j];
    lambda[i] = -Dot(rate[i], rate[i]) - Dot(d[i], acceleration[i]);
    for (size_t j = 0; j <= i; ++j) gram[i][j] = inverse_[i][j] * Dot(d[i], d[j]);
  }
  SolvePositive(n_, gram, lambda);
  for (size_t i = 0; i < n_; ++i)
    for (size_t j = 0; j < n_; ++j)
      acceleration[i] = acceleration[i] + d[j] * (inverse_[i][j] * lambda[j]);
}

// Hermite's cubic of the body's place, from where it was, in lengths, and of its axes.
struct CurveMotion::Path {
  Double3 place[4], axis[3][4], wind[2];  // wind: m/s, and its change a second

  Path(const BodyPose& from, const BodyPose& to, double h, double length) {
    const double per = 1.0 / length;
    Fit(kZero3, from.velocity * per, (to.position - from.position) * per, to.velocity * per, h,
        place);
    for (int k = 0; k < 3; ++k)
      Fit(from.axis[k], from.axis_rate[k], to.axis[k], to.axis_rate[k], h, axis[k]);
    wind[0] = from.wind;
    wind[1] = (to.wind - from.wind) * (1.0 / h);
  }
  static void Fit(Double3 a, Double3 a_rate, Double3 b, Double3 b_rate, double h,
                  Double3 (&power)[4]) {
    const Double3 way = b - a;
    power[0] = a;
    power[1] = a_rate;
    power[2] = (way * 3.0 - a_rate * (2.0 * h) - b_rate * h) * (1.0 / (h * h));
    power[3] = (way * -2.0 + (a_rate + b_rate) * h) * (1.0 / (h * h * h));
  }
  // Of a point of the body, without the body's place.
  Double3 Turned(int power, Double3 q) const {
    return axis[0][power] * q.x + axis[1][power] * q.y + axis[2][power] * q.z;
  }
};

CurveMotion::CurveMotion(const CurveDynamics& dynamics, const BodyPose& pose, double step_s)
    : CurveMotion(dynamics, pose, step_s, dynamics.Equilibrium(pose)) {}

CurveMotion::CurveMotion(const CurveDynamics& dynamics, const BodyPose& pose, double step_s,
                         const UnknownVectors& start)
    : dynamics_(dynamics), step_(step_s), pose_(pose), d_(start) {
  const CurveDynamics& s = dynamics_;
  for (size_t m = 0; m < s.n_; ++m) {
    const double damping = s.drag_ + s.damping_ * s.squares_[m];
    oscillator_.push_back(StepOscillator(damping, s.squares_[m], step_));
    for (size_t i = 0; i < s.n_; ++i)
      for (size_t j = 0; j < s.n_; ++j) {
        const double pair = s.modes_[i][m] * s.modes_[j][m];
        const OscillatorStep& step = oscillator_[m];
        response_[i][j] += 0.5 * pair * step.y_of_force[0];
        slope_[i][j] += pair * (step.y_of_force[1] / step_ - 0.5 * step.y_of_force[0]);
      }
  }
  // It moves with the body.
  for (size_t m = 0; m < s.n_; ++m)
    for (size_t i = 0; i < s.n_; ++i)
      for (size_t j = 0; j < s.n_; ++j) {
        const Double3 speed =
            pose.TurnRate(s.OnBody(j)) + pose.velocity * (s.root_share_[j] / s.length_);
        z_[m] = z_[m] + speed * (s.modes_[i][m] * s.mass_[i][j]);
      }
}

void CurveMotion::Step(const BodyPose& to) {
  const CurveDynamics& s = dynamics_;
  const Path path(pose_, to, step_, s.length_);
  const UnknownVectors free = RunFree(path);
  UnknownVectors y, middle;
  if (!s.curls()) {
    KeepLengths(free, y, middle);
  } else {
    // From where it begins to where the step will lead, found in two rounds.
    const UnknownVectors first = s.CurlLoad(pose_, d_);
    UnknownVectors last = first;
    for (size_t i = 0; i < s.n_ && loaded_; ++i) last[i] = first[i] * 2.0 - load_[i];
    for (int round = 0; round < 2; ++round) {
      KeepLengths(AddLoad(free, first, last), y, middle);
      if (round > 0) break;
      UnknownVectors end = y;
      for (size_t i = 0; i < s.n_; ++i) end[i] = Unit(y[i]);
      last = s.CurlLoad(to, end);
    }
    for (size_t m = 0; m < s.n_; ++m)
      for (size_t i = 0; i < s.n_; ++i) {
        const OscillatorStep& step = oscillator_[m];
        const Double3 mean = (first[i] + last[i]) * 0.5, turn = last[i] - first[i];
        const double change = step.v_of_force[1] / step_ - 0.5 * step.v_of_force[0];
        z_[m] = z_[m] + (mean * step.v_of_force[0] + turn * change) * s.modes_[i][m];
      }
    load_ = first;
    loaded_ = true;
  }
  Take(y, middle);
  MakeTangent(path);
  pose_ = to;
}

UnknownVectors CurveMotion::AddLoad(const UnknownVectors& free, const UnknownVectors& first,
                                    const UnknownVectors& last) const {
  UnknownVectors to = free;
  for (size_t i = 0; i < dynamics_.n_; ++i)
    for (size_t j = 0; j < dynamics_.n_; ++j)
      to[i] = to[i] + (first[j] + last[j]) * response_[i][j] + (last[j] - first[j]) * slope_[i][j];
  return to;
}

// Directions at the step's end without multipliers; z_ becomes its rates.
UnknownVectors CurveMotion::RunFree(const Path& path) {
  const CurveDynamics& s = dynamics_;
  UnknownVectors free{};
  UnknownVectors start, rest[4];  // with the body's place
  for (size_t i = 0; i < s.n_; ++i) {
    const Double3 body = s.OnBody(i);
    start[i] = d_[i] + path.Turned(0, body);
    for (int p = 0; p < 4; ++p)
      rest[p][i] = path.Turned(p, s.unbent_[i] + body) + path.place[p] * s.root_share_[i];
  }
  for (size_t m = 0; m < s.n_; ++m) {
    UnknownRow image{};  // Phi^T M
    double pull = 0.0;
    for (size_t i = 0; i < s.n_; ++i) {
      pull += s.modes_[i][m] * s.pull_[i];
      for (size_t j = 0; j < s.n_; ++j) image[j] += s.modes_[i][m] * s.mass_[i][j];
    }
    Double3 from = kZero3, power[5] = {};
    for (size_t i = 0; i < s.n_; ++i) {
      from = from + start[i] * image[i];
      for (int p = 0; p < 4; ++p) power[p] = power[p] + rest[p][i] * image[i];
    }
    const OscillatorStep& step = oscillator_[m];
    Double3 q = from * step.y_of_y + z_[m] * step.y_of_v;
    Double3 z = from * step.v_of_y + z_[m] * step.v_of_v;
    for (int p = 0; p < 4; ++p) {
      Double3 force = (power[p] + power[p + 1] * (s.damping_ * (p + 1))) * s.squares_[m];
      if (p == 0) force = force + (s.gravity_ + path.wind[0] * s.drag_) * (pull / s.length_);
      if (p == 1) force = force + path.wind[1] * (s.drag_ * pull / s.length_);
      q = q + force * step.y_of_force[p];
      z = z + force * step.v_of_force[p];
    }
    z_[m] = z;
    for (size_t i = 0; i < s.n_; ++i) free[i] = free[i] + q * s.modes_[i][m];
  }
  const double h = step_;
  for (size_t i = 0; i < s.n_; ++i) {
    const Double3 body = s.OnBody(i);
    double time = 1.0;
    for (int p = 0; p < 4; ++p, time *= h)
      free[i] = free[i] - (path.Turned(p, body) + path.place[p] * s.root_share_[i]) * time;
  }
  return free;
}

void CurveMotion::KeepLengths(const UnknownVectors& free, UnknownVectors& y,
                              UnknownVectors& middle) {
  const size_t n = dynamics_.n_;
  for (size_t i = 0; i < n; ++i) middle[i] = d_[i] + free[i];
  const auto respond = [&] {
    for (size_t i = 0; i < n; ++i) {
      y[i] = free[i];
      for (size_t j = 0; j < n; ++j) y[i] = y[i] + middle[j] * (lambda_[j] * response_[i][j]);
    }
  };
  respond();
  constexpr int kMostSteps = 60;
  for (int step = 0; step < kMostSteps; ++step) {
    UnknownMatrix gram;
    UnknownRow change;
    for (size_t i = 0; i < n; ++i) {
      change[i] = 1.0 - Dot(y[i], y[i]);
      for (size_t j = 0; j <= i; ++j) gram[i][j] = Dot(middle[i], middle[j]) * response_[i][j];
    }
    SolvePositive(n, gram, change);
    double largest = 0.0;
    for (size_t i = 0; i < n; ++i) {
      lambda_[i] += change[i];
      largest = std::max(largest, std::abs(change[i]) * response_[i][i]);
    }
    respond();
    for (size_t i = 0; i < n; ++i) {
      const Double3 to = d_[i] + y[i];
      largest = std::max(largest, Length(to - middle[i]));
      middle[i] = to;
    }
    respond();
    if (!(largest < 1e6)) throw Error("a strand's exact motion has no end of its step");
    if (largest < 1e-12) break;
  }
}

void CurveMotion::Take(const UnknownVectors& y, const UnknownVectors& middle) {
  const CurveDynamics& s = dynamics_;
  for (size_t m = 0; m < s.n_; ++m)
    for (size_t i = 0; i < s.n_; ++i)
      z_[m] =
          z_[m] + middle[i] * (lambda_[i] * s.modes_[i][m] * 0.5 * oscillator_[m].v_of_force[0]);
  for (size_t i = 0; i < s.n_; ++i) d_[i] = Unit(y[i]);
}

void CurveMotion::MakeTangent(const Path& path) {
  const CurveDynamics& s = dynamics_;
  UnknownMatrix gram;
  UnknownRow mu;
  for (size_t i = 0; i < s.n_; ++i) {
    const Double3 body = s.OnBody(i);
    Double3 rate = kZero3;
    for (size_t m = 0; m < s.n_; ++m) rate = rate + z_[m] * s.modes_[i][m];
    double time = 1.0;
    for (int p = 1; p < 4; ++p, time *= step_)
      rate = rate - (path.Turned(p, body) + path.place[p] * s.root_share_[i]) * (p * time);
    mu[i] = -Dot(d_[i], rate);
    for (size_t j = 0; j <= i; ++j) gram[i][j] = s.inverse_[i][j] * Dot(d_[i], d_[j]);
  }
  SolvePositive(s.n_, gram, mu);
  for (size_t m = 0; m < s.n_; ++m)
    for (size_t i = 0; i < s.n_; ++i) z_[m] = z_[m] + d_[i] * (mu[i] * s.modes_[i][m]);
}

}  // namespace pelt::accuracy
