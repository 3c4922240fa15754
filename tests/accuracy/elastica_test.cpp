// The clamped rod under its own weight: the exact solution, and how far 3 and 4 links are from it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "bench/accuracy/solver_checks.hpp"
#include "core/modal/modal_material.hpp"

namespace pelt::accuracy {
namespace {

TEST(Elastica, FixedValues) {
  // Gamma, H, W, H / W: to all digits given.
  static constexpr double kRows[][4] = {
      {0.01, 0.001249998437503, 0.9999991071447, 0.001249999553572},
      {0.1, 0.01249843784804, 0.9999107322241, 0.0124995536554},
      {0.3, 0.03745789689277, 0.9991978786152, 0.03748796679261},
      {1, 0.1234714019834, 0.9912463953466, 0.1245617664417},
      {2, 0.2385065828729, 0.9668929468961, 0.2466732057965},
      {5, 0.4959050446224, 0.8466571799543, 0.5857211825088},
      {10, 0.7001997155143, 0.6563537612386, 1.066802320433},
      {20, 0.8298814434393, 0.4452320522396, 1.863930144438},
      {30, 0.8730924232233, 0.342763680656, 2.547213933379},
      {100, 0.9375239353963, 0.1592233826284, 5.888104623327},
      {1000, 0.9811412692687, 0.04598645475692, 21.33544049992},
      {10000, 0.9941099339109, 0.01426088975975, 69.70882957923}};
  for (const auto& row : kRows) {
    const Sag sag = SolveElastica(row[0]);
    EXPECT_NEAR(sag.drop / row[1], 1.0, 1e-11) << row[0];
    EXPECT_NEAR(sag.reach / row[2], 1.0, 1e-11) << row[0];
    EXPECT_NEAR(sag.drop / sag.reach / row[3], 1.0, 1e-11) << row[0];
  }
}

// Linear beam theory for small Gamma; a rod clamped upwards stands higher, one clamped downwards
// hangs lower; a straight rod stays straight as Gamma vanishes.
TEST(Elastica, OtherClampAngles) {
  EXPECT_NEAR(SolveElastica(1e-5).drop / (1e-5 / 8.0), 1.0, 1e-8);
  for (const double angle : {-1.2, -0.5, 0.4, 1.3}) {
    const Sag stiff = SolveElastica(1e-9, angle);
    EXPECT_NEAR(stiff.drop, std::sin(angle), 1e-9);
    EXPECT_NEAR(stiff.reach, std::cos(angle), 1e-9);
    for (const double gamma : {0.5, 3.0, 20.0}) {
      const Sag sag = SolveElastica(gamma, angle);
      EXPECT_GT(sag.drop, std::sin(angle));
      EXPECT_LT(std::hypot(sag.drop, sag.reach), 1.0);
    }
  }
}

// theta'' = -Gamma (1 - s) cos theta is the limit of ever more links: Richardson's difference of
// fine chains of springs is a second, independent way to the same curve.
TEST(Elastica, IsTheLimitOfManyLinks) {
  const double gamma = 4.0, angle = 0.3;
  // Links of half-spacing joints: theta at link midpoints, moments at joints, by relaxation.
  const auto drop = [&](int n) {
    std::vector<double> theta(size_t(n), angle);
    const double l = 1.0 / n;
    for (int newton = 0; newton < 40; ++newton) {
      // Tridiagonal Newton step on -(theta_{i+1} - 2 theta_i + theta_{i-1}) / l^2 = Gamma (1 - s)
      // cos theta; the clamp is half a link above the first midpoint.
      std::vector<double> diagonal(theta.size()), right(theta.size()), lower(theta.size());
      for (size_t i = 0; i < theta.size(); ++i) {
        const double s = (double(i) + 0.5) * l, up = i > 0 ? 1.0 : 2.0;
        const double down = i + 1 < theta.size() ? 1.0 : 0.0;
        const double above = i > 0 ? theta[i - 1] : angle;
        const double below = i + 1 < theta.size() ? theta[i + 1] : theta[i];
        right[i] = gamma * (1.0 - s) * std::cos(theta[i]) * l * l + up * (above - theta[i]) +
                   down * (below - theta[i]);
        diagonal[i] = up + down + gamma * (1.0 - s) * std::sin(theta[i]) * l * l;
        if (i > 0) {
          const double f = 1.0 / diagonal[i - 1];
          diagonal[i] -= f;
          right[i] += f * right[i - 1];
        }
      }
      for (size_t i = theta.size(); i-- > 0;) {
        lower[i] = (right[i] + (i + 1 < theta.size() ? lower[i + 1] : 0.0)) / diagonal[i];
        theta[i] += lower[i];
      }
    }
    double sum = 0.0;
    for (const double t : theta) sum += l * std::sin(t);
    return sum;
  };
  const double coarse = drop(400), fine = drop(800);
  EXPECT_NEAR(fine + (fine - coarse) / 3.0, SolveElastica(gamma, angle).drop, 1e-7);
}

struct ModelError {
  double worst = 0.0;   // in H / W, Gamma up to 30
  double frequency[3];  // over the rod's
};

// Exact sags for Gamma up to 30, found once.
const std::vector<std::pair<double, Sag>>& ExactSags() {
  static const auto sags = [] {
    std::vector<std::pair<double, Sag>> list;
    for (double gamma = 0.05; gamma < 30.0; gamma *= 1.1)
      list.emplace_back(gamma, SolveElastica(gamma));
    return list;
  }();
  return sags;
}

ModelError MeasureModel(const ChainMaterial& material) {
  ModelError error;
  for (const auto& [gamma, exact] : ExactSags()) {
    const Sag chain = SolveChainSag(material, gamma, 1.0, 1.0);
    error.worst = std::max(error.worst,
                           std::abs(chain.drop / chain.reach / (exact.drop / exact.reach) - 1.0));
  }
  const ChainMatrices x = MatricesOf(material);
  for (int m = 0; m < 3; ++m) error.frequency[m] = x.omega[m] / kRodFrequency[m];
  return error;
}

// The calibration that ours is measured against (modal_material.hpp says why ours is another).
ChainMaterial PublishedRod(int links) {
  static constexpr RodCoefficients kRods[] = {
      {{3.17611, 0.81414, 1.42676}, {0.23681, 1.75071, 0.27435}},
      {{2.90762, 0.80570, 1.44262, 0.66483}, {0.24497, 1.08881, 1.45562, 0.27374}}};
  ChainMaterial rod = NaiveRod(links, 1.0, 1.0, 1.0);
  for (int i = 0; i < links; ++i) {
    rod.stiffness[i] *= kRods[links - 3].stiffness[i];
    rod.mass[i] *= kRods[links - 3].mass[i];
  }
  return rod;
}

double RatioError(int links, double gamma) {
  const Sag exact = SolveElastica(gamma),
            chain = SolveChainSag(PublishedRod(links), gamma, 1.0, 1.0);
  return std::abs(chain.drop / chain.reach / (exact.drop / exact.reach) - 1.0);
}

// The fastest frequency, over sqrt(g / link), that tension alone gives a chain that hangs from its
// root: what a solver that takes tension step by step has to resolve.
double TensionFrequency(ChainMaterial rod) {
  const int links = rod.links;
  std::vector<double> hung(size_t(links), 0.0);
  for (int i = 0; i < links; ++i)
    for (int p = i; p < links; ++p) hung[size_t(i)] += rod.mass[p];
  // |d - down|^2 / 2 of every link, times the weight below it, in place of joints: K is diagonal.
  // Power iteration on M^-1 K through a Cholesky of M.
  std::vector<double> x(size_t(links), 1.0);
  for (int i = 0; i < links; ++i) x[size_t(i)] = i % 2 ? -1.0 : 1.0;
  double value = 0.0;
  for (int iteration = 0; iteration < 200; ++iteration) {
    // M_ij = sum of the masses at and below max(i, j): its inverse is the difference of forces
    // over each mass.
    std::vector<double> force(x.size()), next(x.size());
    for (int i = 0; i < links; ++i) force[size_t(i)] = hung[size_t(i)] * x[size_t(i)];
    double above = 0.0;
    for (int i = 0; i < links; ++i) {
      const double down = i + 1 < links ? force[size_t(i) + 1] : 0.0;
      const double speed = (force[size_t(i)] - down) / rod.mass[i];
      next[size_t(i)] = speed - above;
      above = speed;
    }
    value = 0.0;
    for (const double v : next) value = std::max(value, std::abs(v));
    for (int i = 0; i < links; ++i) x[size_t(i)] = next[size_t(i)] / value;
  }
  return std::sqrt(value);
}

TEST(CalibratedRod, OfEightLinksIsTheRodAndAsEasyToSolveAsEvenMasses) {
  const ChainMaterial rod = CalibratedRod(8, 1.0, 1.0, 1.0);
  const ModelError off = MeasureModel(rod);
  EXPECT_LT(off.worst, 0.001);
  for (const double frequency : off.frequency) EXPECT_NEAR(frequency, 1.0, 0.001);
  EXPECT_LT(TensionFrequency(rod), 1.06 * TensionFrequency(NaiveRod(8, 1.0, 1.0, 1.0)));
  double mass = 0.0;
  for (int i = 0; i < 8; ++i) mass += rod.mass[size_t(i)];
  EXPECT_NEAR(mass, 7.5 / 8, 1e-3);
}

TEST(CalibratedRod, IsCloserToTheRodThanThePublishedOneAndAsEasyToSolveAsEvenMasses) {
  for (const int links : {3, 4}) {
    const ChainMaterial rod = CalibratedRod(links, 1.0, 1.0, 1.0);
    const ModelError ours = MeasureModel(rod), published = MeasureModel(PublishedRod(links));
    EXPECT_LT(ours.worst, links == 3 ? 0.0155 : 0.0055) << links;
    EXPECT_LT(ours.worst, published.worst) << links;
    EXPECT_NEAR(ours.frequency[0], 1.0, 0.001) << links;
    EXPECT_NEAR(ours.frequency[1], 1.0, 0.01) << links;
    EXPECT_NEAR(ours.frequency[2], 1.0, links == 3 ? 0.01 : 0.1) << links;
    const double even = TensionFrequency(NaiveRod(links, 1.0, 1.0, 1.0));
    EXPECT_LT(TensionFrequency(rod), 1.06 * even) << links;
    EXPECT_GT(TensionFrequency(PublishedRod(links)), 1.6 * even) << links;
    double mass = 0.0;
    for (int i = 0; i < links; ++i) mass += rod.mass[i];
    EXPECT_NEAR(mass, (links - 0.5) / links, 1e-3);
  }
}

double TipError(const ChainMaterial& rod, double gamma, double angle, const Sag& exact) {
  const Sag chain = SolveChainSag(rod, gamma, 1.0, 1.0, angle);
  return std::hypot(chain.drop - exact.drop, chain.reach - exact.reach);
}

// Clamped at other angles: below the horizontal within a hundredth of the length; above it, where a
// rod is near buckling and any small difference is large, no further off than the published one.
TEST(CalibratedRod, TipsAreAsGoodAsThePublishedOnesAtOtherClampAngles) {
  for (const double angle : {-1.2, -0.6, 0.6, 1.2})
    for (const double gamma : {0.3, 3.0, 10.0, 30.0}) {
      const Sag exact = SolveElastica(gamma, angle);
      for (const int links : {3, 4}) {
        const double ours = TipError(CalibratedRod(links, 1.0, 1.0, 1.0), gamma, angle, exact);
        const double published = TipError(PublishedRod(links), gamma, angle, exact);
        const auto where = [&] {
          return ::testing::Message() << links << ' ' << angle << ' ' << gamma;
        };
        if (angle > 0.0) {
          EXPECT_LT(ours, 0.01) << where();
        }
        EXPECT_LT(ours, 1.2 * published + 0.006) << where();
      }
    }
}

TEST(CalibratedRod, PublishedModelErrorIsWhatWasPublished) {
  // The published maxima are those at Gamma 15 and 30; between, the error is a little larger.
  EXPECT_NEAR(RatioError(3, 15.0), 0.0155, 0.00005);
  EXPECT_NEAR(RatioError(4, 30.0), 0.0071, 0.00005);
  const ModelError three = MeasureModel(PublishedRod(3));
  const ModelError four = MeasureModel(PublishedRod(4));
  EXPECT_NEAR(three.worst, 0.0159, 0.0002);
  EXPECT_NEAR(four.worst, 0.0084, 0.0002);
  EXPECT_NEAR(three.frequency[0], 1.0002, 0.00005);
  EXPECT_NEAR(three.frequency[1], 0.991, 0.0005);
  EXPECT_NEAR(four.frequency[0], 1.0001, 0.00005);
  EXPECT_NEAR(four.frequency[1], 0.999, 0.0005);
}

// Any rod: length, stiffness and density scale out.
TEST(CalibratedRod, ScalesOut) {
  const double length = 0.03, bending = 2e-9, density = 3e-6;
  const ChainMaterial rod = CalibratedRod(4, length, bending, density);
  const Sag sag = SolveChainSag(rod, 7.0, bending, density, 0.3),
            unit = SolveChainSag(CalibratedRod(4, 1.0, 1.0, 1.0), 7.0, 1.0, 1.0, 0.3);
  EXPECT_NEAR(sag.drop, unit.drop, 1e-9);
  const double scale = std::sqrt(bending / (density * std::pow(length, 4)));
  EXPECT_NEAR(MatricesOf(rod).omega[0] / scale,
              MatricesOf(CalibratedRod(4, 1.0, 1.0, 1.0)).omega[0], 1e-9);
}

TEST(NaiveRod, IsFarOff) {
  const ModelError naive = MeasureModel(NaiveRod(3, 1.0, 1.0, 1.0));
  EXPECT_GT(naive.worst, 1.0);
  EXPECT_NEAR(naive.frequency[0], 0.58, 0.01);  // 42 % low
}

}  // namespace
}  // namespace pelt::accuracy
