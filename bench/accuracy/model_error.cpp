#include "bench/accuracy/model_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "bench/accuracy/modal_solver.hpp"
#include "bench/accuracy/solver_run.hpp"
#include "core/modal/modal_material.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

constexpr int kMost = 16;  // links
constexpr int kKeptPerSecond = 60;
using RodDirections = std::array<Double3, kMost>;

// Whether layers have chains of so many.
bool IsOfLayers(int links) { return links == 3 || links == 4 || links == 8; }

// n equal links of a rod of length 1, mass 1 and bending stiffness 1.
struct Rod {
  int n = 0;
  double stiffness[kMost], mass[kMost];

  explicit Rod(int links) : n(links) {
    const double link = 1.0 / n;
    for (int i = 0; i < n; ++i) {
      // The clamp is half a link from the middle of the first; the tip bears half a link.
      stiffness[i] = (i == 0 ? 2.0 : 1.0) / link;
      mass[i] = (i + 1 == n ? 0.5 : 1.0) * link;
    }
    if (!IsOfLayers(n)) return;
    const RodCoefficients& c = CalibratedCoefficients(uint32_t(n));
    for (int i = 0; i < n; ++i) {
      stiffness[i] = c.stiffness[i] / link;
      mass[i] = c.mass[i] * link;
    }
  }
};

// Tridiagonal a x.
struct Band {
  double diagonal[kMost] = {}, off[kMost] = {};  // off[i]: of i and i + 1

  Double3 Row(const RodDirections& x, int i, int n) const {
    Double3 sum = x[size_t(i)] * diagonal[i];
    if (i > 0) sum = sum + x[size_t(i) - 1] * off[i - 1];
    if (i + 1 < n) sum = sum + x[size_t(i) + 1] * off[i];
    return sum;
  }
};

struct State {
  RodDirections d, v;
};

// The equations of chain_problem.hpp for any number of links.
class Chain {
 public:
  Chain(const Rod& rod, const Preset& preset) : n_(rod.n), link_(preset.length / rod.n) {
    drag_ = preset.drag;
    damping_ = 2.0 * preset.damping_ratio / (2.0 * std::numbers::pi * preset.frequency);
    double below = 0.0;
    for (int i = n_ - 1; i >= 0; --i) pull_[i] = link_ * (below += rod.mass[i]);
    for (int i = 0; i < n_; ++i) {
      const double above = i > 0 ? 1.0 / rod.mass[i - 1] : 0.0;
      inverse_.diagonal[i] = (1.0 / rod.mass[i] + above) / (link_ * link_);
      if (i > 0) inverse_.off[i - 1] = -above / (link_ * link_);
      bending_.diagonal[i] += rod.stiffness[i];
      if (i == 0) continue;
      bending_.diagonal[i - 1] += rod.stiffness[i];
      bending_.off[i - 1] -= rod.stiffness[i];
    }
    const double wanted = 2.0 * std::numbers::pi * preset.frequency;
    const double scale = wanted * wanted / LowestSquare(rod);
    for (int i = 0; i < n_; ++i) bending_.diagonal[i] *= scale, bending_.off[i] *= scale;
  }

  int links() const { return n_; }
  double link() const { return link_; }

  // Where the chain hangs still: each link in turn where its energy is least.
  RodDirections Equilibrium(const RodDirections& rest) const {
    RodDirections d = rest;
    for (int sweep = 0; sweep < 4000; ++sweep)
      for (int i = 0; i < n_; ++i) {
        const Double3 push = bending_.Row(rest, i, n_) - bending_.Row(d, i, n_) +
                             d[size_t(i)] * bending_.diagonal[i] + kGravity * pull_[i];
        d[size_t(i)] = Unit(push);
      }
    return d;
  }

  // Steps a second that an explicit method of fourth order is stable and exact with.
  int StepRate() const {
    double most = 0.0;  // of K M^-1, by Gershgorin
    for (int i = 0; i < n_; ++i) {
      const auto width = [&](const Band& b) {
        return b.diagonal[i] + (i > 0 ? std::abs(b.off[i - 1]) : 0.0) +
               (i + 1 < n_ ? std::abs(b.off[i]) : 0.0);
      };
      most = std::max(most, width(bending_));
    }
    double inverse = 0.0;
    for (int i = 0; i < n_; ++i)
      inverse = std::max(inverse, inverse_.diagonal[i] + 2.0 * std::abs(inverse_.off[i]));
    const double square = most * inverse;
    const double rate = 0.5 * (damping_ * square + drag_) + 0.7 * std::sqrt(square);
    return kKeptPerSecond * (1 + int(rate / kKeptPerSecond));
  }

  void Accelerate(const BodyPose& pose, Double3 root, const RodDirections& rest, const State& s,
                  RodDirections& a) const {
    RodDirections strain, force;
    for (size_t i = 0; i < size_t(n_); ++i)
      strain[i] = s.d[i] - pose.Turn(rest[i]) + (s.v[i] - pose.TurnRate(rest[i])) * damping_;
    for (int i = 0; i < n_; ++i) force[size_t(i)] = bending_.Row(strain, i, n_);
    for (int i = 0; i < n_; ++i)
      a[size_t(i)] = inverse_.Row(force, i, n_) * -1.0 - s.v[size_t(i)] * drag_;
    a[0] = a[0] + (kGravity - pose.PlaceBend(root) - pose.PlaceRate(root) * drag_) * (1.0 / link_);
    KeepLengths(s, a);
  }

 private:
  static constexpr Double3 kGravity = {0.0, -9.81, 0.0};

  // Multipliers along the links that keep their lengths: tridiagonal.
  void KeepLengths(const State& s, RodDirections& a) const {
    double diagonal[kMost], off[kMost] = {}, lambda[kMost];
    for (int i = 0; i < n_; ++i) {
      const size_t k = size_t(i);
      diagonal[i] = inverse_.diagonal[i] * Dot(s.d[k], s.d[k]);
      if (i + 1 < n_) off[i] = inverse_.off[i] * Dot(s.d[k], s.d[k + 1]);
      lambda[i] = -Dot(s.v[k], s.v[k]) - Dot(s.d[k], a[k]);
    }
    for (int i = 1; i < n_; ++i) {
      const double f = off[i - 1] / diagonal[i - 1];
      diagonal[i] -= f * off[i - 1];
      lambda[i] -= f * lambda[i - 1];
    }
    lambda[n_ - 1] /= diagonal[n_ - 1];
    for (int i = n_ - 2; i >= 0; --i)
      lambda[i] = (lambda[i] - off[i] * lambda[i + 1]) / diagonal[i];
    RodDirections push;
    for (int i = 0; i < n_; ++i) push[size_t(i)] = s.d[size_t(i)] * lambda[i];
    for (int i = 0; i < n_; ++i) a[size_t(i)] = a[size_t(i)] + inverse_.Row(push, i, n_);
  }

  // The lowest eigenvalue of K x = w^2 M x, by steps of K^-1 M.
  double LowestSquare(const Rod& rod) const {
    double x[kMost], y[kMost], square = 0.0;
    std::fill_n(x, n_, 1.0);
    for (int step = 0; step < 60; ++step) {
      double below[kMost + 1] = {};
      for (int i = n_ - 1; i >= 0; --i) below[i] = below[i + 1] + rod.mass[i];
      for (int i = 0; i < n_; ++i) {
        y[i] = 0.0;
        for (int j = 0; j < n_; ++j) y[i] += link_ * link_ * below[std::max(i, j)] * x[j];
      }
      Solve(y);
      double top = 0.0;
      for (int i = 0; i < n_; ++i) top = std::max(top, std::abs(y[i]));
      square = 1.0 / top;
      for (int i = 0; i < n_; ++i) x[i] = y[i] / top;
    }
    return square;
  }
  void Solve(double (&b)[kMost]) const {
    double diagonal[kMost];
    for (int i = 0; i < n_; ++i) {
      diagonal[i] = bending_.diagonal[i];
      if (i == 0) continue;
      const double f = bending_.off[i - 1] / diagonal[i - 1];
      diagonal[i] -= f * bending_.off[i - 1];
      b[i] -= f * b[i - 1];
    }
    for (int i = n_ - 1; i >= 0; --i)
      b[i] = (b[i] - (i + 1 < n_ ? bending_.off[i] * b[i + 1] : 0.0)) / diagonal[i];
  }

  int n_;
  double link_, drag_, damping_;
  double pull_[kMost] = {};
  Band inverse_, bending_;
};

// A helix: the tangent turns about an axis that it leans towards.
struct Helix {
  Double3 root, tangent, axis;
  double turn;  // from root to tip, rad

  RodDirections LinksOf(int n) const {
    RodDirections d;
    for (int i = 0; i < n; ++i) d[size_t(i)] = Unit(TurnAbout(tangent, axis, turn * (i + 0.5) / n));
    return d;
  }
};

Helix DrawHelix(uint64_t seed, int motion, int index) {
  Random random(MixSeed(MixSeed(seed, uint64_t(motion)), uint64_t(1000 + index)));
  const Strand strand = DrawStrands(3, index + 1, seed, motion).back();
  const Double3 tangent = strand.rest[0];
  const Double3 side = Unit(Cross(tangent, strand.rest[1]));
  const double lean = random.Uniform(-0.5, 0.5);
  const Double3 axis = Unit(side + tangent * lean);
  const double turn = 3.0 * random.Uniform(7.0, 22.0) * std::numbers::pi / 180.0;
  return {strand.root, tangent, axis, turn};
}

// Displacements from the rigid shape at s = j / n of the length, j = 1 .. n, frame after frame; a
// point of the rod that lies within a link is on the line between its ends.
class Track {
 public:
  Track(const Chain& chain, const Helix& helix, const BodyMotion& motion, double seconds)
      : n_(chain.links()) {
    const RodDirections rest = helix.LinksOf(n_);
    State s{chain.Equilibrium(rest), {}};
    const RodDirections start = s.d;
    for (Double3& v : s.v) v = kZero3;
    const int rate = chain.StepRate(), frames = int(seconds * kKeptPerSecond);
    const double h = 1.0 / rate;
    int64_t step = 0;
    for (int frame = 1; frame <= frames; ++frame) {
      for (int k = 0; k < rate / kKeptPerSecond; ++k, ++step)
        RungeKutta(chain, helix, rest, motion, double(step) * h, h, s);
      const BodyPose pose = motion(double(frame) / kKeptPerSecond);
      Double3 at = kZero3;
      moved_.push_back(at);
      for (size_t i = 0; i < size_t(n_); ++i)
        moved_.push_back(at = at + (s.d[i] - pose.Turn(start[i])) * chain.link());
    }
  }

  // The same of the solver.
  Track(const SolverFactory& solver, const Chain& chain, const Preset& preset, const Helix& helix,
        const BodyMotion& motion, double seconds)
      : n_(chain.links()) {
    const RodDirections rest = helix.LinksOf(n_), start = chain.Equilibrium(rest);
    Strand strand{helix.root, {}};
    LinkDirections hung{};
    std::copy_n(rest.begin(), n_, strand.rest.begin());
    std::copy_n(start.begin(), n_, hung.begin());
    SolverRun run(solver, MakeMaterial(preset, n_, Coefficients::kCalibrated), 1.0 / kKeptPerSecond,
                  {strand}, std::span(&hung, 1), motion(0.0));
    for (int frame = 1; frame <= int(seconds * kKeptPerSecond); ++frame) {
      const BodyPose pose = motion(double(frame) / kKeptPerSecond);
      run.Step(pose);
      Double3 rigid = kZero3;
      moved_.push_back(rigid);
      for (int i = 0; i < n_; ++i) {
        rigid = rigid + pose.Turn(start[size_t(i)]) * chain.link();
        moved_.push_back(run.Point(0, i) - rigid);
      }
    }
  }

  size_t frames() const { return moved_.size() / size_t(n_ + 1); }
  Double3 At(size_t frame, double share) const {
    const double place = share * n_;
    const int below = std::min(int(place + 1e-9), n_ - 1);
    const Double3* const row = &moved_[frame * size_t(n_ + 1)];
    return row[below] + (row[below + 1] - row[below]) * (place - below);
  }

 private:
  static void RungeKutta(const Chain& chain, const Helix& helix, const RodDirections& rest,
                         const BodyMotion& motion, double t, double h, State& s) {
    static constexpr double kAt[4] = {0.0, 0.5, 0.5, 1.0}, kShare[4] = {1, 2, 2, 1};
    const BodyPose poses[3] = {motion(t), motion(t + 0.5 * h), motion(t + h)};
    const size_t n = size_t(chain.links());
    State sum = s, at = s;
    RodDirections a;
    for (int stage = 0; stage < 4; ++stage) {
      chain.Accelerate(poses[(stage + 1) / 2], helix.root, rest, at, a);
      const double next = stage < 3 ? kAt[stage + 1] * h : 0.0, share = kShare[stage] * h / 6.0;
      for (size_t i = 0; i < n; ++i) {
        const Double3 v = at.v[i];
        sum.d[i] = sum.d[i] + v * share;
        sum.v[i] = sum.v[i] + a[i] * share;
        at.d[i] = s.d[i] + v * next;
        at.v[i] = s.v[i] + a[i] * next;
      }
    }
    for (size_t i = 0; i < n; ++i) {
      s.d[i] = Unit(sum.d[i]);
      s.v[i] = sum.v[i] - s.d[i] * Dot(s.d[i], sum.v[i]);
    }
  }

  int n_;
  std::vector<Double3> moved_;
};

double Distance(const Track& chain, const Track& rod, int links) {
  double off = 0.0, moved = 0.0;
  for (size_t frame = 0; frame < rod.frames(); ++frame)
    for (int j = 1; j <= links; ++j) {
      const double share = double(j) / links;
      const Double3 is = chain.At(frame, share), wanted = rod.At(frame, share);
      off += Dot(is - wanted, is - wanted);
      moved += Dot(wanted, wanted);
    }
  return std::sqrt(off / moved);
}

}  // namespace

std::vector<ModelErrorRow> MeasureModelError(const ModelErrorOptions& options) {
  std::vector<ModelErrorRow> rows;
  for (const int links : options.links)
    for (size_t preset = 0; preset < options.presets.size(); ++preset) {
      rows.push_back({links, preset, {}, {}});
      if (options.isa && IsOfLayers(links))
        for (const ModalQuality quality :
             {ModalQuality::kFast, ModalQuality::kDefault, ModalQuality::kBest})
          rows.push_back({links, preset, quality, {}});
    }
  for (int m = 0; m < options.drawn.motions; ++m)
    for (size_t p = 0; p < options.presets.size(); ++p) {
      Preset preset = options.presets[p];
      preset.length *= DrawLengthScale(options.drawn.seed, m);
      const BodyMotion motion = DrawMotion(options.drawn.seed, m);
      for (int s = 0; s < options.strands; ++s) {
        const Helix helix = DrawHelix(options.drawn.seed, m, s);
        const Track rod(Chain(Rod(kRodLinks), preset), helix, motion, options.seconds);
        for (ModelErrorRow& row : rows) {
          if (row.preset != p) continue;
          const Chain links(Rod(row.links), preset);
          const Track chain = row.quality
                                  ? Track(ModalFactory(ModalKernelsOf(*options.isa), *row.quality),
                                          links, preset, helix, motion, options.seconds)
                                  : Track(links, helix, motion, options.seconds);
          row.errors.push_back(Distance(chain, rod, row.links));
        }
      }
    }
  return rows;
}

}  // namespace pelt::accuracy
