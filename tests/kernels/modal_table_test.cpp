// The modal solver's tables against what they stand for: modes against the matrices, an
// oscillator's step against a fine integration, the root's polynomial against a cubic.
#include "core/modal/modal_table.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/modal/modal_response.hpp"
#include "core/modal/node_model.hpp"
#include "tests/kernels/modal_scene.hpp"

namespace pelt::test {
namespace {

const std::vector<double> kUnevenStiffness = {1e6, 1.0, 300.0, 1e3},
                          kUnevenMass = {1.0, 1e-4, 0.3, 0.01};

TEST(ModalModes, DiagonaliseBothMatrices) {
  for (const ModalMaterial& material :
       {UniformLinks(3, 5.0, 0.05, 6.0), StrandMaterial(4, 2.0, 0.02, 3.0),
        StrandMaterial(4, 2.0, 0.02, 3.0, true), StrandMaterial(9, 12.0, 0.05, 10.0),
        LinkMaterial(kUnevenStiffness, kUnevenMass, 1.0)}) {
    const ModalModes m = FindModes(material);
    const uint32_t n = m.nodes;
    double biggest = 0.0;
    for (uint32_t a = 0; a < n; ++a) biggest = std::max(biggest, m.omega2[a]);
    for (uint32_t a = 0; a < n; ++a)
      for (uint32_t b = 0; b < n; ++b) {
        double mass = 0.0, stiffness = 0.0, unit = 0.0;
        for (uint32_t i = 0; i < n; ++i) {
          unit += m.inverse_mass[a][i] * material.mass[i][b];
          for (uint32_t j = 0; j < n; ++j) {
            mass += m.shape[i][a] * material.mass[i][j] * m.shape[j][b];
            stiffness += m.shape[i][a] * material.stiffness[i][j] * m.shape[j][b];
          }
        }
        EXPECT_NEAR(mass, a == b ? 1.0 : 0.0, 1e-10);
        EXPECT_NEAR(unit, a == b ? 1.0 : 0.0, 1e-8);
        EXPECT_NEAR(stiffness / biggest, (a == b ? m.omega2[a] : 0.0) / biggest, 1e-10);
      }
    for (uint32_t a = 1; a < n; ++a) EXPECT_LE(m.omega2[a - 1], m.omega2[a]);
  }
}

TEST(ModalMaterial, SwingsAsTheRod) {
  for (const uint32_t points : {4u, 5u, 9u}) {
    const ModalModes m = FindModes(StrandMaterial(points, 5.0, 0.0, 0.0));
    EXPECT_NEAR(std::sqrt(m.omega2[0]) / (2.0 * M_PI * 5.0), 1.0, 0.003) << points;
    EXPECT_NEAR(std::sqrt(m.omega2[1] / m.omega2[0]), 22.034492 / 3.5160153,
                points == 4 ? 0.4 : 0.2)
        << points;
  }
  // A fibre as stiff as that: it is as heavy for its stiffness in any unit of length.
  const double bending = 1.0e-9, density = 3.0e-5, length = 0.07;
  const double hz = RodFrequency(bending, density, length);
  EXPECT_NEAR(GammaOf(hz, length, 9.81), density * 9.81 * length * length * length / bending, 1e-9);
}

// Straight and evenly bent strands have rest tangents that are theirs.
TEST(ModalMaterial, FindsRestTangentsInTheGroom) {
  struct Set {
    uint32_t points;
    bool stiff;
    std::vector<double> node;
  };
  for (const Set& set : {Set{4, false, {kThreeNodes.node.begin(), kThreeNodes.node.end()}},
                         Set{4, true, {kThreeStiffNodes.node.begin(), kThreeStiffNodes.node.end()}},
                         Set{5, false, {kFourNodes.node.begin(), kFourNodes.node.end()}},
                         Set{9, false, {kFourNodes.node.begin(), kFourNodes.node.end()}}}) {
    const ModalMaterial m = StrandMaterial(set.points, 5.0, 0.05, 1.0, set.stiff);
    const int parts = int(set.points) - 1;
    for (uint32_t i = 0; i < m.nodes; ++i) {
      double sum = 0.0, x = 0.0, y = 0.0;
      constexpr double kTurn = 1.0;  // rad from root to tip
      for (int part = 0; part < parts; ++part) {
        sum += m.rest[i][part];
        const double angle = kTurn * (part + 0.5) / parts;
        x += m.rest[i][part] * std::cos(angle);
        y += m.rest[i][part] * std::sin(angle);
      }
      EXPECT_NEAR(sum, 1.0, 1e-12) << set.points;
      EXPECT_NEAR(std::atan2(y, x), kTurn * set.node[i], 0.008) << set.points << ", node " << i;
    }
  }
}

// The classical fourth-order method in small steps: an independent answer.
void IntegrateFinely(double damping, double omega2, double h, int power, long double* y,
                     long double* v) {
  constexpr int kSteps = 40000;
  const long double dt = (long double)h / kSteps;
  const auto force = [&](long double t) {
    return power < 0 ? 0.0L : power == 0 ? 1.0L : std::pow(t, (long double)power);
  };
  const auto acceleration = [&](long double t, long double x, long double u) {
    return force(t) - (long double)damping * u - (long double)omega2 * x;
  };
  for (int i = 0; i < kSteps; ++i) {
    const long double t = dt * i, x = *y, u = *v;
    const long double a1 = acceleration(t, x, u);
    const long double a2 = acceleration(t + dt / 2, x + dt / 2 * u, u + dt / 2 * a1);
    const long double u3 = u + dt / 2 * a2;
    const long double a3 = acceleration(t + dt / 2, x + dt / 2 * (u + dt / 2 * a1), u3);
    const long double a4 = acceleration(t + dt, x + dt * u3, u + dt * a3);
    *y += dt * u + dt * dt / 6 * (a1 + a2 + a3);
    *v += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
}

TEST(ModalResponse, EqualsAFineIntegrationInEveryRegime) {
  const double h = 1.0 / 60.0;
  struct Case {
    double damping, omega2;
  };
  // No stiffness with and without drag; weak, critical and strong damping; a stiff mode.
  for (const Case c : {Case{0, 0}, Case{6, 0}, Case{0.5, 25}, Case{10, 25}, Case{10.0001, 25},
                       Case{300, 25}, Case{40, 3.6e4}, Case{2000, 3.6e4}, Case{1e-9, 1e-9}}) {
    const OscillatorStep s = StepOscillator(c.damping, c.omega2, h);
    const double rate = std::max(1.0, std::sqrt(c.omega2));
    long double y = 1, v = 0;
    IntegrateFinely(c.damping, c.omega2, h, -1, &y, &v);
    EXPECT_NEAR(s.y_of_y, double(y), 1e-12);
    EXPECT_NEAR(s.v_of_y, double(v), 1e-12 * rate * rate);
    y = 0, v = 1;
    IntegrateFinely(c.damping, c.omega2, h, -1, &y, &v);
    EXPECT_NEAR(s.y_of_v, double(y), 1e-12 * h);
    EXPECT_NEAR(s.v_of_v, double(v), 1e-12 * rate);
    for (int power = 0; power < kResponsePowers; ++power) {
      y = v = 0;
      IntegrateFinely(c.damping, c.omega2, h, power, &y, &v);
      const double size = std::pow(h, power);
      EXPECT_NEAR(s.y_of_force[power], double(y), 1e-12 * size * h * h) << power;
      EXPECT_NEAR(s.v_of_force[power], double(v), 1e-12 * size * h * rate) << power;
    }
  }
}

TEST(ModalResponse, KeepsTheWronskianFarBeyondTheStep) {
  // w h = 105 and 1e4: whole turns within a step. The determinant of the free motion is exp(-C h).
  const double h = 1.0 / 60.0;
  for (const double omega : {6283.0, 6e5}) {
    const OscillatorStep s = StepOscillator(3.0, omega * omega, h);
    const double determinant = s.y_of_y * s.v_of_v - s.y_of_v * s.v_of_y;
    EXPECT_NEAR(determinant, std::exp(-3.0 * h), 1e-9);
    EXPECT_NEAR(s.y_of_force[0] * omega * omega, 1.0 - s.y_of_y, 1e-9);
  }
  // Beyond every scale: nothing, and no NaN.
  const OscillatorStep stiff = StepOscillator(1e13, 1e18, h);
  EXPECT_TRUE(std::isfinite(stiff.y_of_y) && std::isfinite(stiff.v_of_v));
  EXPECT_LT(std::fabs(stiff.v_of_v), 1e-3);
}

TEST(ModalTable, DrawsACubicThroughUnevenFrames) {
  const FrameTimes times{{1.0 / 60.0, 1.0 / 45.0, 1.0 / 100.0}};
  ModalTableBlock t;
  FillModalTable(MakeModalLayer(StrandMaterial(4, 5.0, 0.05, 6.0)), ModalQuality::kBest, times, &t);
  const auto place = [](double x) { return 0.3 + 2.0 * x - 50.0 * x * x + 900.0 * x * x * x; };
  const auto speed = [](double x) { return 2.0 - 100.0 * x + 2700.0 * x * x; };
  double at[4] = {}, sample[4];
  for (int j = 1; j < 4; ++j) at[j] = at[j - 1] - times.dt_s[j - 1];
  for (int j = 0; j < 4; ++j) sample[j] = place(at[j]);
  const double difference[] = {sample[0] - sample[1], sample[0] - 2 * sample[1] + sample[2],
                               sample[0] - 3 * sample[1] + 3 * sample[2] - sample[3]};
  const auto weigh = [&](const float(&w)[3]) {
    return w[0] * difference[0] + w[1] * difference[1] + w[2] * difference[2];
  };
  ASSERT_EQ(t.substeps, 3u);
  for (uint32_t k = 0; k < t.substeps; ++k) {
    const double end = (double(k + 1) / t.substeps - 1.0) * times.dt_s[0];
    EXPECT_NEAR(weigh(t.substep[k].root_place), place(end) - place(0.0), 1e-7);
    EXPECT_NEAR(weigh(t.substep[k].root_speed), speed(end), 1e-5);
  }
  EXPECT_NEAR(weigh(t.root_end_speed), speed(0.0), 1e-5);
  EXPECT_EQ(weigh(t.substep[2].root_place), 0.0);
}

TEST(ModalTable, KeepsSubstepsShort) {
  const ModalLayer layer = MakeModalLayer(StrandMaterial(4, 5.0, 0.05, 6.0));
  const auto substeps = [&](ModalQuality quality, double rate) {
    ModalTableBlock t;
    FillModalTable(layer, quality, {{1.0 / rate, 1.0 / rate, 1.0 / rate}}, &t);
    return t.substeps;
  };
  const double rates[] = {15, 24, 30, 60, 120, 240};
  const uint32_t fast[] = {4, 2, 2, 1, 1, 1}, normal[] = {6, 6, 5, 3, 2, 1};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(substeps(ModalQuality::kFast, rates[i]), fast[i]) << rates[i];
    EXPECT_EQ(substeps(ModalQuality::kFine, rates[i]), normal[i]) << rates[i];
    EXPECT_EQ(substeps(ModalQuality::kBest, rates[i]), normal[i]) << rates[i];
  }
  EXPECT_EQ(substeps(ModalQuality::kBest, 1.0 / kLongestModalFrame_s), kModalSubsteps);
  EXPECT_EQ(substeps(ModalQuality::kBest, 1.0), 0u);
}

}  // namespace
}  // namespace pelt::test
