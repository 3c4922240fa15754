// The matrices of strands with nodes, against values worked out apart from this code.
#include "core/modal/node_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pelt::test {
namespace {

TEST(NodeModel, ThreeNodesHaveTheirMatrices) {
  const NodeModel<3> m = MakeNodeModel(kThreeNodes);
  constexpr double kMass[3][3] = {
      {.016734, .027421, .011284}, {.027421, .087373, .041177}, {.011284, .041177, .033239}};
  constexpr double kStiffness[3][3] = {
      {2.0727, -.9518, .2168}, {-.9518, 1.1529, -.4569}, {.2168, -.4569, .3217}};
  constexpr double kPull[3] = {.1185, .2433, .1060};
  constexpr double kPlace[3][3] = {
      {.1961, .1352, -.0072}, {.0794, .4227, .1115}, {.1755, .2968, .5140}};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(m.pull[i], kPull[i], 5e-5);
    for (size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(m.mass[i][j], kMass[i][j], 5e-7);
      EXPECT_NEAR(m.stiffness[i][j], kStiffness[i][j], 5e-5);
      EXPECT_NEAR(m.PlaceAt(double(i + 1) / 3.0)[j], kPlace[i][j], 5e-5);
    }
  }
}

template <size_t N>
void ExpectCurve(const NodePlaces<N>& places) {
  const NodeModel<N> m = MakeNodeModel(places);
  for (size_t i = 0; i < N; ++i) {
    const auto at = m.TangentAt(places.node[i]), clamp = m.TangentAt(0.0);
    for (size_t j = 0; j < N; ++j) {
      EXPECT_NEAR(at[j], i == j ? 1.0 : 0.0, 1e-14);
      EXPECT_EQ(clamp[j], 0.0);
    }
  }
  // Derivative and integral of the tangent's shares, by differences and a sum of 2,000 parts.
  constexpr double kStep = 1e-6;
  constexpr int kParts = 2000;
  typename NodeModel<N>::Row sum{};
  for (int k = 0; k < kParts; ++k) {
    const double s = (k + 0.5) / kParts;
    const auto at = m.TangentAt(s), before = m.TangentAt(s - kStep), after = m.TangentAt(s + kStep);
    const auto bend = m.BendAt(s);
    for (size_t i = 0; i < N; ++i) {
      sum[i] += at[i] / kParts;
      EXPECT_NEAR(bend[i], (after[i] - before[i]) / (2.0 * kStep),
                  1e-5 * (1.0 + std::fabs(bend[i])));
    }
  }
  const auto tip = m.PlaceAt(1.0);
  for (size_t i = 0; i < N; ++i) EXPECT_NEAR(sum[i], tip[i], 1e-5);
}

TEST(NodeModel, SharesAreThoseOfACurveThroughTheNodes) {
  ExpectCurve(kThreeNodes);
  ExpectCurve(kThreeStiffNodes);
  ExpectCurve(kFourNodes);
}

}  // namespace
}  // namespace pelt::test
