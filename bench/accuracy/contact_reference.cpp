// Chains that touch things.
#include <algorithm>
#include <cmath>

#include "bench/accuracy/reference_integrator.hpp"
#include "core/error.hpp"

namespace pelt::accuracy {
namespace {

using Directions = std::array<Double3, kMaxLinks>;

constexpr int kMostTouches = 12;
// Nearer to the root nothing is pushed: hardly anything could turn the link there.
constexpr double kLeastAlong = 1.0e-3;  // of the link
constexpr int kMostSweeps = 2000;
constexpr double kSettled = 1.0e-13;  // m/s
// Share of a depth that a step takes away, what the last one was wrong by; and how fast what overlaps
// from the start leaves, m/s (core/modal/README.md says so).
constexpr double kTakenBack = 0.1, kLeaving = 0.2;

// The rates' answer to a force impulse on each direction: M^-1 f, the lengths kept, dense.
class Response {
 public:
  Response(const ChainDynamics& chain, const Directions& d)
      : n_(chain.material().links), inverse_(chain.matrices().mass_inverse), d_(d) {
    // Cholesky's factor of M^-1 o (d d^T).
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j <= i; ++j) {
        double sum = inverse_[i][j] * Dot(d[i], d[j]);
        for (int k = 0; k < j; ++k) sum -= factor_[i][k] * factor_[j][k];
        factor_[i][j] = i == j ? std::sqrt(sum) : sum / factor_[j][j];
      }
  }
  Directions Of(const Directions& force) const {
    Directions rate = Mass(force);
    double lambda[kMaxLinks];
    for (int i = 0; i < n_; ++i) {
      lambda[i] = -Dot(d_[i], rate[i]);
      for (int k = 0; k < i; ++k) lambda[i] -= factor_[i][k] * lambda[k];
      lambda[i] /= factor_[i][i];
    }
    for (int i = n_ - 1; i >= 0; --i) {
      for (int k = i + 1; k < n_; ++k) lambda[i] -= factor_[k][i] * lambda[k];
      lambda[i] /= factor_[i][i];
    }
    Directions hold{};
    for (int i = 0; i < n_; ++i) hold[i] = d_[i] * lambda[i];
    const Directions held = Mass(hold);
    for (int i = 0; i < n_; ++i) rate[i] = rate[i] + held[i];
    return rate;
  }

 private:
  Directions Mass(const Directions& force) const {
    Directions out{};
    for (int i = 0; i < n_; ++i) {
      out[i] = kZero3;
      for (int j = 0; j < n_; ++j) out[i] = out[i] + force[j] * inverse_[i][j];
    }
    return out;
  }

  int n_;
  const ChainMatrix& inverse_;
  const Directions& d_;
  double factor_[kMaxLinks][kMaxLinks];
};

// Shares of two segments where they are nearest to each other: of p + s u and q + t v.
void NearestShares(Double3 p, Double3 u, Double3 q, Double3 v, double& s, double& t) {
  const double a = Dot(u, u), b = Dot(u, v), c = Dot(v, v);
  const Double3 w = p - q;
  const double d = Dot(u, w), e = Dot(v, w);
  if (c < 1e-24) {
    t = 0.0;
    s = std::clamp(-d / a, 0.0, 1.0);
    return;
  }
  const double across = a * c - b * b;
  s = across > 1e-12 * a * c ? std::clamp((b * e - c * d) / across, 0.0, 1.0) : 1.0;
  t = (b * s + e) / c;
  if (t < 0.0 || t > 1.0) {
    t = std::clamp(t, 0.0, 1.0);
    s = std::clamp((b * t - d) / a, 0.0, 1.0);
  }
}

}  // namespace

// A link's point and a shape it is at.
struct ContactReference::Touch {
  int link;
  double along, gap;     // of the link; m
  Double3 axis[3];       // the normal, and two directions across it
  double least;          // speed along the normal
  Double3 drift;         // of the root against the shape
  Directions answer[3];  // of the rates to an impulse along each axis
  double own[3][3];      // of the point's speed, along the axes
  double impulse[3];
};

ContactReference::ContactReference(const ChainMaterial& material,
                                   const std::vector<Strand>& strands,
                                   const std::vector<Directions>& start, BodyMotion motion,
                                   std::vector<ContactShape> shapes, double friction,
                                   int steps_per_second)
    : material_(material),
      motion_(std::move(motion)),
      shapes_(std::move(shapes)),
      friction_(friction),
      way_(shapes_.size(), kZero3),
      speed_(shapes_.size(), kZero3),
      rate_(steps_per_second) {
  if (shapes_.size() * size_t(material.links) > size_t(kMostTouches))
    throw Error("contact reference: too many shapes");
  // Speeds are half a step ahead of places.
  const BodyPose pose = motion_(0.0);
  for (size_t i = 0; i < strands.size(); ++i) {
    chains_.emplace_back(material, strands[i]);
    ChainState s{start[i], {}};
    for (int k = 0; k < material.links; ++k) s.rate[size_t(k)] = kZero3;
    Directions bend{};
    chains_[i].Accelerate(pose, s, bend);
    for (int k = 0; k < material.links; ++k)
      s.rate[size_t(k)] = bend[size_t(k)] * (-0.5 / double(rate_));
    states_.push_back(s);
  }
}

Double3 ContactReference::Point(size_t strand, int i) const {
  Double3 at = kZero3;
  for (int k = 0; k <= i; ++k)
    at = at + states_[strand].direction[size_t(k)] * material_.length[size_t(k)];
  return at;
}

void ContactReference::Step() {
  const double now = seconds(), h = 1.0 / double(rate_);
  const BodyPose pose = motion_(now), between = motion_(now + 0.5 * h);
  for (size_t i = 0; i < shapes_.size(); ++i)
    if (shapes_[i].way) {
      way_[i] = shapes_[i].way(now);
      speed_[i] = shapes_[i].speed(now + 0.5 * h);
    }
  for (size_t i = 0; i < chains_.size(); ++i) Move(i, pose, between);
  ++steps_;
}

void ContactReference::Move(size_t strand, const BodyPose& pose, const BodyPose& between) {
  const ChainDynamics& chain = chains_[strand];
  ChainState& s = states_[strand];
  const double h = 1.0 / double(rate_);
  Directions bend{};
  chain.Accelerate(pose, s, bend);
  for (int i = 0; i < material_.links; ++i) s.rate[i] = s.rate[i] + bend[i] * h;
  Touch touches[kMostTouches];
  const int count = FindTouches(chain, s, pose, between, touches);
  Directions moved{};
  for (int i = 0; i < material_.links; ++i) moved[i] = kZero3;
  if (count > 0) {
    FindAnswers(chain, s.direction, touches, count);
    Resolve(touches, count, friction_, s.rate);
    // Depths, by places alone: what leaves an overlap has no speed from it.
    for (int c = 0; c < count; ++c) {
      Touch& t = touches[c];
      t.least = t.gap > 0.0 ? -t.gap / h : std::min(-t.gap * kTakenBack / h, kLeaving);
      t.drift = kZero3;
    }
    Resolve(touches, count, 0.0, moved);
  }
  for (int i = 0; i < material_.links; ++i) {
    s.direction[i] = Unit(s.direction[i] + (s.rate[i] + moved[i]) * h);
    s.rate[i] = s.rate[i] - s.direction[i] * Dot(s.direction[i], s.rate[i]);
  }
}

// What a link could enter within the step.
int ContactReference::FindTouches(const ChainDynamics& chain, const ChainState& s,
                                  const BodyPose& pose, const BodyPose& between,
                                  Touch* touches) const {
  const double h = 1.0 / double(rate_);
  const Double3 root_speed = between.PlaceRate(chain.strand().root);
  Double3 from = pose.Place(chain.strand().root), speed = root_speed;
  int count = 0;
  for (int i = 0; i < material_.links; ++i) {
    const Double3 link = s.direction[i] * material_.length[i];
    const Double3 turning = s.rate[i] * material_.length[i];
    for (size_t k = 0; k < shapes_.size(); ++k) {
      const ContactShape& shape = shapes_[k];
      double along = 1.0, gap, there = 0.0;
      Double3 normal = shape.normal;
      if (Dot(normal, normal) > 0.0) {
        gap = Dot(normal, from + link - way_[k]) + shape.offset;
      } else {
        const Double3 axis = shape.to - shape.from, start = shape.from + way_[k];
        NearestShares(from, link, start, axis, along, there);
        const Double3 out = from + link * along - (start + axis * there);
        const double distance = Length(out);
        gap = distance - shape.radius;
        normal = distance > 0.0 ? out * (1.0 / distance) : Double3{0.0, 1.0, 0.0};
      }
      if (along < kLeastAlong) continue;
      const Double3 met = speed + turning * along - speed_[k];
      // Far enough that no impulse of the others brings it here within the step.
      if (gap > 8.0 * h * (Length(met) + 0.1)) continue;
      Touch& t = touches[count++];
      t.link = i, t.along = along, t.gap = gap;
      t.drift = root_speed - speed_[k];
      t.least = gap > 0.0 ? -gap / h : 0.0;
      const Double3 other = std::fabs(normal.x) < 0.6 ? Double3{1, 0, 0} : Double3{0, 1, 0};
      t.axis[0] = normal;
      t.axis[1] = Unit(Cross(normal, other));
      t.axis[2] = Cross(normal, t.axis[1]);
    }
    from = from + link;
    speed = speed + turning;
  }
  return count;
}

// The touched point's speed that rates give it.
Double3 ContactReference::SpeedOf(const Touch& t, const Directions& rate) const {
  Double3 v = kZero3;
  for (int i = 0; i < t.link; ++i) v = v + rate[i] * material_.length[i];
  return v + rate[t.link] * (material_.length[t.link] * t.along);
}

void ContactReference::FindAnswers(const ChainDynamics& chain, const Directions& d, Touch* touches,
                                   int count) const {
  const Response response(chain, d);
  for (int c = 0; c < count; ++c) {
    Touch& t = touches[c];
    for (int k = 0; k < 3; ++k) {
      Directions force{};
      for (int i = 0; i < material_.links; ++i)
        force[i] = i < t.link    ? t.axis[k] * material_.length[i]
                   : i == t.link ? t.axis[k] * (material_.length[i] * t.along)
                                 : kZero3;
      t.answer[k] = response.Of(force);
      for (int j = 0; j < 3; ++j) t.own[j][k] = Dot(t.axis[j], SpeedOf(t, t.answer[k]));
    }
  }
}

// Impulses one after the other until nothing changes.
void ContactReference::Resolve(Touch* touches, int count, double friction, Directions& rate) const {
  for (int c = 0; c < count; ++c)
    for (double& impulse : touches[c].impulse) impulse = 0.0;
  const auto add = [&](Touch& t, int k, double impulse) {
    t.impulse[k] += impulse;
    for (int i = 0; i < material_.links; ++i) rate[i] = rate[i] + t.answer[k][i] * impulse;
  };
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double most = 0.0;
    for (int c = 0; c < count; ++c) {
      Touch& t = touches[c];
      const auto missing = [&](int k) {
        return (k == 0 ? t.least : 0.0) - Dot(t.axis[k], t.drift + SpeedOf(t, rate));
      };
      if (t.own[0][0] < 1e-9) continue;
      const double push = std::max(t.impulse[0] + missing(0) / t.own[0][0], 0.0);
      most = std::max(most, std::fabs(push - t.impulse[0]) * t.own[0][0]);
      add(t, 0, push - t.impulse[0]);
      if (friction <= 0.0) continue;
      // A step against the slip, no longer than the cone allows.
      const double step = 1.0 / (t.own[1][1] + t.own[2][2]);
      double wanted[2] = {t.impulse[1] + missing(1) * step, t.impulse[2] + missing(2) * step};
      const double size = std::hypot(wanted[0], wanted[1]), limit = friction * t.impulse[0];
      for (int k = 0; k < 2; ++k) {
        if (size > limit) wanted[k] *= limit / size;
        most = std::max(most, std::fabs(wanted[k] - t.impulse[k + 1]) / step);
        add(t, k + 1, wanted[k] - t.impulse[k + 1]);
      }
    }
    if (most < kSettled) break;
  }
}

}  // namespace pelt::accuracy
