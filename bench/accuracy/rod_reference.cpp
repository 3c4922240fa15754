// The rod among walls.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "bench/accuracy/rod_contact.hpp"

namespace pelt::accuracy {
namespace rod {

// A symmetric matrix's lower half, row after row.
class LowerMatrix {
 public:
  explicit LowerMatrix(size_t size) : size_(size), value_(size * size) {}
  double* operator[](size_t row) { return &value_[row * size_]; }
  const double* operator[](size_t row) const { return &value_[row * size_]; }
  size_t size() const { return size_; }
  // To its Cholesky factor; false where it is not positive definite.
  bool Factorise() {
    LowerMatrix& a = *this;
    for (size_t i = 0; i < size_; ++i)
      for (size_t j = 0; j <= i; ++j) {
        double sum = a[i][j];
        for (size_t k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
        if (i == j && !(sum > 0.0)) return false;
        a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
      }
    return true;
  }
  // b to the solution, this being the factor.
  void Solve(std::vector<double>& b) const {
    const LowerMatrix& a = *this;
    for (size_t i = 0; i < size_; ++i) {
      for (size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
      b[i] /= a[i][i];
    }
    for (size_t i = size_; i-- > 0;) {
      for (size_t k = i + 1; k < size_; ++k) b[i] -= a[k][i] * b[k];
      b[i] /= a[i][i];
    }
  }

 private:
  size_t size_;
  std::vector<double> value_;
};

using Vectors = std::vector<Double3>;

constexpr int kMostRounds = 60;  // of the method of multipliers

// A place of the rod that may touch a wall.
struct Contact {
  size_t wall;
  double s;
  double push = 0.0;     // the multiplier
  Double3 rub = kZero3;  // what acts along the wall
};

struct RodChain {
  size_t links;
  double link;       // length
  Vectors rest;      // directions
  LowerMatrix bend;  // K
  LowerMatrix mass;
  std::vector<double> pull;  // b: of a load on the whole rod

  RodChain(const RestCurve& curve, int n)
      : links(size_t(n)), link(1.0 / n), bend(links), mass(links) {
    for (size_t i = 0; i < links; ++i) {
      const double middle = (double(i) + 0.5) * link;
      rest.push_back(curve.TangentAt(middle));
      pull.push_back(link * (1.0 - middle));
      for (size_t j = 0; j <= i; ++j) mass[i][j] = link * pull[i];
      const double joint = (i == 0 ? 2.0 : 1.0) / link;
      bend[i][i] += joint;
      if (i == 0) continue;
      bend[i - 1][i - 1] += joint;
      bend[i][i - 1] -= joint;
    }
    ScaleToFirstMode();
  }
  // How much of link i lies before s.
  double Reach(size_t i, double s) const { return std::clamp(s - double(i) * link, 0.0, link); }

 private:
  // By inverse iteration, from the shape that a weight bends it to.
  void ScaleToFirstMode() {
    constexpr int kIterations = 40;
    LowerMatrix factor = bend;
    factor.Factorise();
    std::vector<double> shape = pull;
    double square = 0.0;
    for (int k = 0; k < kIterations; ++k) {
      std::vector<double> heavy(links);
      for (size_t i = 0; i < links; ++i)
        for (size_t j = 0; j < links; ++j)
          heavy[i] += mass[std::max(i, j)][std::min(i, j)] * shape[j];
      const double before = std::inner_product(shape.begin(), shape.end(), heavy.begin(), 0.0);
      std::vector<double> next = heavy;
      factor.Solve(next);
      square = before / std::inner_product(next.begin(), next.end(), heavy.begin(), 0.0);
      for (size_t i = 0; i < links; ++i) shape[i] = next[i] * square;
    }
    const double scale = kRodFrequency1 * kRodFrequency1 / square;
    for (size_t i = 0; i < links; ++i)
      for (size_t j = 0; j <= i; ++j) bend[i][j] *= scale;
  }
};

// Least of 1/2 d . A d - load . d over unit vectors d among walls.
class Least {
 public:
  struct Limits {
    double penalty = 3e4, balanced = 1e-6, deepest = 1e-5;
  };

  Least(const RodChain& chain, size_t walls, Limits limits)
      : chain_(chain), n_(chain.links), limits_(limits), matrix_(n_), load_(n_, kZero3) {
    for (size_t wall = 0; wall < walls; ++wall)
      for (size_t p = 1; p <= 2 * n_; ++p)
        contacts_.push_back({wall, 0.5 * double(p) * chain.link});
    d_ = chain.rest;
  }

  LowerMatrix& matrix() { return matrix_; }
  Vectors& load() { return load_; }
  const Vectors& d() const { return d_; }
  void Guess(const Vectors& d) { d_ = d; }

  // False where the forces stay out of balance.
  bool Settle(const std::vector<RodWall>& walls, Double3 rub_share, int rounds) {
    walls_ = &walls;
    for (int round = 0; round < rounds; ++round) {
      const bool balanced = Balance();
      double deepest = 0.0, rubbed = 0.0;
      for (Contact& c : contacts_) {
        const double gap = GapOf(c, d_).gap, push = PushOf(c, gap);
        const Double3 rub = rub_share * push;
        deepest = std::max(deepest, -gap);
        rubbed = std::max(rubbed, Length(rub - c.rub));
        c.push = push;
        c.rub = rub;
      }
      if (balanced && deepest < limits_.deepest && rubbed < kRubbed) return true;
    }
    return false;
  }

  RodShape Shape() const {
    RodShape shape;
    Double3 at = kZero3;
    for (const Double3& d : d_) shape.point.push_back(at = at + d * chain_.link);
    for (const Contact& c : contacts_) {
      shape.pushed += c.push;
      shape.deepest = std::max(shape.deepest, -GapOf(c, d_).gap);
    }
    return shape;
  }

 private:
  static constexpr int kNewtonSteps = 100;
  static constexpr double kMostTurn = 0.3, kRubbed = 1e-2;

  WallGap GapOf(const Contact& c, const Vectors& d) const {
    Double3 at = kZero3;
    for (size_t i = 0; i < n_; ++i) at = at + d[i] * chain_.Reach(i, c.s);
    return (*walls_)[c.wall](c.s, at);
  }
  double PushOf(const Contact& c, double gap) const {
    return std::max(0.0, c.push - limits_.penalty * gap);
  }

  // A d - load.
  Vectors Force(const Vectors& d) const {
    Vectors force(n_);
    for (size_t i = 0; i < n_; ++i) force[i] = load_[i] * -1.0;
    for (size_t i = 0; i < n_; ++i)
      for (size_t j = 0; j <= i; ++j) {
        force[i] = force[i] + d[j] * matrix_[i][j];
        if (j < i) force[j] = force[j] + d[i] * matrix_[i][j];
      }
    return force;
  }

  double Energy(const Vectors& d) const {
    const Vectors force = Force(d);
    double sum = 0.0;
    for (size_t i = 0; i < n_; ++i) sum += 0.5 * (Dot(force[i], d[i]) - Dot(load_[i], d[i]));
    for (const Contact& c : contacts_) {
      const double push = PushOf(c, GapOf(c, d).gap);
      sum += (push * push - c.push * c.push) / (2.0 * limits_.penalty);
      for (size_t i = 0; i < n_; ++i) sum -= Dot(c.rub, d[i]) * chain_.Reach(i, c.s);
    }
    return sum;
  }

  // The energy's slope by each direction, in space.
  Vectors Slope() const {
    Vectors slope = Force(d_);
    for (const Contact& c : contacts_) {
      const WallGap gap = GapOf(c, d_);
      const Double3 force = gap.normal * PushOf(c, gap.gap) + c.rub;
      for (size_t i = 0; i < n_; ++i) slope[i] = slope[i] - force * chain_.Reach(i, c.s);
    }
    return slope;
  }

  void MakeSides() {
    side_.resize(2 * n_);
    for (size_t i = 0; i < n_; ++i) {
      const bool up = std::abs(d_[i].y) > 0.8;
      side_[2 * i] = Unit(Cross(d_[i], up ? Double3{1.0, 0.0, 0.0} : Double3{0.0, 1.0, 0.0}));
      side_[2 * i + 1] = Cross(d_[i], side_[2 * i]);
    }
  }

  // What a wall that is touched adds: to turns along side_, and alike to all of space.
  void AddContact(const Contact& c, LowerMatrix& turns, LowerMatrix& space) const {
    const WallGap gap = GapOf(c, d_);
    const double push = PushOf(c, gap.gap), across = push * gap.bend;
    if (push == 0.0) return;
    std::vector<double> along(2 * n_);
    for (size_t r = 0; r < 2 * n_; ++r)
      along[r] = Dot(side_[r], gap.normal) * chain_.Reach(r / 2, c.s);
    for (size_t r = 0; r < 2 * n_; ++r)
      for (size_t q = 0; q <= r; ++q)
        turns[r][q] += (limits_.penalty + across) * along[r] * along[q];
    for (size_t i = 0; i < n_; ++i)
      for (size_t j = 0; j <= i; ++j)
        space[i][j] -= across * chain_.Reach(i, c.s) * chain_.Reach(j, c.s);
  }

  // The energy's second derivative with respect to turns (rotations) along side_.
  LowerMatrix Curvature(const Vectors& slope) const {
    LowerMatrix space = matrix_, turns(2 * n_);
    for (const Contact& c : contacts_) AddContact(c, turns, space);
    for (size_t r = 0; r < 2 * n_; ++r) {
      for (size_t q = 0; q <= r; ++q) turns[r][q] += space[r / 2][q / 2] * Dot(side_[r], side_[q]);
      turns[r][r] -= Dot(d_[r / 2], slope[r / 2]);
    }
    return turns;
  }

  Vectors Turned(std::vector<double> turn) const {
    double largest = kMostTurn;
    for (const double t : turn) largest = std::max(largest, std::abs(t));
    const double share = kMostTurn / largest;
    Vectors to(n_);
    for (size_t i = 0; i < n_; ++i)
      to[i] =
          Unit(d_[i] + (side_[2 * i] * turn[2 * i] + side_[2 * i + 1] * turn[2 * i + 1]) * share);
    return to;
  }

  // Newton's method, damped until the energy falls.
  bool Balance() {
    double damping = 0.0, energy = Energy(d_);
    for (int step = 0; step < kNewtonSteps; ++step) {
      MakeSides();
      const Vectors slope = Slope();
      std::vector<double> turn(2 * n_);
      double most = 0.0;
      for (size_t r = 0; r < 2 * n_; ++r) {
        turn[r] = -Dot(slope[r / 2], side_[r]);
        most = std::max(most, std::abs(turn[r]));
      }
      if (most < limits_.balanced) return true;
      LowerMatrix curvature = Curvature(slope);
      for (size_t r = 0; r < 2 * n_; ++r) curvature[r][r] += damping;
      if (curvature.Factorise()) {
        curvature.Solve(turn);
        const Vectors to = Turned(turn);
        const double next = Energy(to);
        if (next <= energy + 1e-12 * std::abs(energy) + 1e-14) {
          d_ = to, energy = next;
          damping = damping > 1e-3 ? 0.2 * damping : 0.0;
          continue;
        }
      }
      damping = std::max(10.0 * damping, 1e-2);
    }
    return false;
  }

  const RodChain& chain_;
  size_t n_;
  Limits limits_;
  LowerMatrix matrix_;
  Vectors load_, d_, side_;
  std::vector<Contact> contacts_;
  const std::vector<RodWall>* walls_ = nullptr;
};

// to += a x.
void AddTimes(const LowerMatrix& a, const Vectors& x, double share, Vectors& to) {
  for (size_t i = 0; i < a.size(); ++i)
    for (size_t j = 0; j <= i; ++j) {
      to[i] = to[i] + x[j] * (a[i][j] * share);
      if (j < i) to[j] = to[j] + x[i] * (a[i][j] * share);
    }
}

// What is pulled by the groom and by `load`.
Vectors LoadOf(const RodChain& chain, Double3 load) {
  Vectors to(chain.links);
  for (size_t i = 0; i < chain.links; ++i) to[i] = load * chain.pull[i];
  AddTimes(chain.bend, chain.rest, 1.0, to);
  return to;
}

}  // namespace rod

using namespace rod;

RodWall OutsideBall(Double3 centre, double radius) {
  return [=](double, Double3 x) -> WallGap {
    const Double3 out = x - centre;
    const double distance = Length(out);
    return {distance - radius, out * (1.0 / distance), 1.0 / distance};
  };
}

RodWall AbovePlane(Double3 normal, double offset) {
  return [=](double, Double3 x) -> WallGap { return {Dot(normal, x) + offset, normal, 0.0}; };
}

RodWall NearRest(const RestCurve& rest, double share) {
  constexpr int kSteps = 256;
  std::vector<Double3> place = {kZero3};
  for (int k = 0; k < kSteps; ++k)
    place.push_back(place.back() + rest.TangentAt((k + 0.5) / kSteps) * (1.0 / kSteps));
  return [=](double s, Double3 x) -> WallGap {
    const double at = s * kSteps;
    const size_t k = std::min(size_t(at), size_t(kSteps - 1));
    const Double3 groom = place[k] + (place[k + 1] - place[k]) * (at - double(k));
    const Double3 off = x - groom;
    const double distance = std::max(Length(off), 1e-9);
    return {share * s - distance, off * (-1.0 / distance), -1.0 / distance};
  };
}

Double3 RodShape::At(double s) const {
  const double at = s * double(point.size());
  const size_t link = std::min(size_t(at), point.size() - 1);
  const Double3 from = link == 0 ? kZero3 : point[link - 1];
  return from + (point[link] - from) * (at - double(link));
}

RodShape FindRest(const RodAmongWalls& rod, int links) {
  constexpr int kStages = 12, kRoundsOnTheWay = 3;
  const RodChain chain(rod.rest, links);
  Least least(chain, rod.walls.size(), {});
  least.matrix() = chain.bend;
  bool rests = true;
  for (int stage = 1; stage <= kStages; ++stage) {
    least.load() = LoadOf(chain, rod.load * (double(stage) / kStages));
    rests = least.Settle(rod.walls, rod.rub, stage < kStages ? kRoundsOnTheWay : kMostRounds);
  }
  RodShape shape = least.Shape();
  shape.rests = rests;
  return shape;
}

class RodMotion::Body {
 public:
  Body(const RodAmongWalls& rod, const RodDamping& damping, int links, double step)
      : chain_(rod.rest, links),
        damping_(damping),
        step_(step),
        pull_(LoadOf(chain_, rod.load)),
        least_(chain_, rod.walls.size(), LimitsOf(step)) {
    const RodShape shape = FindRest({rod.rest, rod.load}, links);
    for (size_t i = 0; i < chain_.links; ++i)
      d_.push_back(Unit(i == 0 ? shape.point[0] : shape.point[i] - shape.point[i - 1]));
    rate_.assign(chain_.links, kZero3);
    for (size_t i = 0; i < chain_.links; ++i)
      for (size_t j = 0; j <= i; ++j)
        least_.matrix()[i][j] = chain_.mass[i][j] * (1.0 / step + damping.drag) / step +
                                chain_.bend[i][j] * (1.0 + damping.bending / step);
    least_.Guess(d_);
  }

  void Step(const std::vector<RodWall>& walls) {
    Vectors free(chain_.links), load = pull_;
    for (size_t i = 0; i < chain_.links; ++i) free[i] = d_[i] + rate_[i] * step_;
    AddTimes(chain_.mass, free, 1.0 / (step_ * step_), load);
    AddTimes(chain_.mass, d_, damping_.drag / step_, load);
    AddTimes(chain_.bend, d_, damping_.bending / step_, load);
    least_.load() = load;
    rests_ = least_.Settle(walls, kZero3, kMostRounds);
    for (size_t i = 0; i < chain_.links; ++i) rate_[i] = (least_.d()[i] - d_[i]) * (1.0 / step_);
    d_ = least_.d();
  }

  RodShape Shape() const {
    RodShape shape;
    Double3 at = kZero3;
    for (const Double3& d : d_) shape.point.push_back(at = at + d * chain_.link);
    shape.rests = rests_;
    return shape;
  }

 private:
  static Least::Limits LimitsOf(double step) {
    Least::Limits limits;
    limits.penalty = 0.1 / (step * step);
    limits.balanced = 1e-12 / (step * step);
    return limits;
  }

  RodChain chain_;
  RodDamping damping_;
  double step_;
  Vectors pull_;
  Least least_;
  Vectors d_, rate_;
  bool rests_ = true;
};

RodMotion::RodMotion(const RodAmongWalls& rod, const RodDamping& damping, int links, double step)
    : body_(std::make_unique<Body>(rod, damping, links, step)) {}
RodMotion::~RodMotion() = default;
void RodMotion::Step(const std::vector<RodWall>& walls) { body_->Step(walls); }
RodShape RodMotion::Shape() const { return body_->Shape(); }

}  // namespace pelt::accuracy
