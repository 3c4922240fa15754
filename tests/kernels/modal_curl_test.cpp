// What a curl that turns with its strand pulls: nothing where the strand rests or is straight, and the numbers its
// matrices are said to be.
#include "core/kernels/modal_curl.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/modal/modal_table.hpp"
#include "tests/kernels/chain_scene.hpp"

namespace pelt::test {
namespace {

using V = ArrayVec<4>;
constexpr uint32_t N = 3;
constexpr double kOmega = 2.0 * 3.14159265358979323846 * 3.0;

ModalTableBlock MakeTable() {
  ModalMaterial material = StrandMaterial(4, 3.0, 0.05, 4.0);
  material.parent_curl = true;
  ModalTableBlock t;
  constexpr double kFrame = 1.0 / 60.0;
  FillModalTable(MakeModalLayer(material), ModalQuality::kFine, {{kFrame, kFrame, kFrame}}, &t);
  return t;
}

Vec3<V> Splat(Double3 v) { return {V(float(v.x)), V(float(v.y)), V(float(v.z))}; }

struct Pull {
  Double3 at[N];
  double Size() const { return Length(at[0]) + Length(at[1]) + Length(at[2]); }
};
Pull PullOn(const ModalTableBlock& t, const Double3 (&u)[N], const Double3 (&r)[N]) {
  Vec3<V> to[N], rest[N], force[N];
  for (uint32_t i = 0; i < N; ++i) to[i] = Splat(u[i]), rest[i] = Splat(r[i]);
  modal::PullOfCurl<V, N>(t, to, rest, force);
  Pull pull;
  for (uint32_t i = 0; i < N; ++i)
    pull.at[i] = {double(force[i].x[0]), double(force[i].y[0]), double(force[i].z[0])};
  return pull;
}

Double3 Leaning(double angle) { return {std::sin(angle), 0.0, std::cos(angle)}; }

TEST(ModalCurl, PullsNothingAtRestNorOnWhatIsStraight) {
  const ModalTableBlock t = MakeTable();
  const Double3 curled[N] = {Leaning(0.1), Leaning(0.4), Leaning(0.9)};
  const Double3 straight[N] = {Leaning(0.2), Leaning(0.2), Leaning(0.2)};
  const Double3 swung[N] = {{0.1, 0.3, std::sqrt(0.9)}, {0.0, 0.6, 0.8}, {-0.6, 0.8, 0.0}};
  const double pull = PullOn(t, swung, curled).Size();
  EXPECT_GT(pull, 10.0);
  EXPECT_LT(PullOn(t, curled, curled).Size(), 1e-5 * pull);
  EXPECT_LT(PullOn(t, swung, straight).Size(), 1e-4 * pull);
}

// A strand turned about its straight clamp as one: its own curl turns with it, and the modes' pull towards the root's
// is what is taken back.
TEST(ModalCurl, StaysBoundedWhereNoRotationIsTheSmallest) {
  const ModalTableBlock t = MakeTable();
  const Double3 curled[N] = {Leaning(0.1), Leaning(0.4), Leaning(0.9)};
  Double3 back[N];
  for (uint32_t i = 0; i < N; ++i) back[i] = curled[i] * -1.0;
  const double pull = PullOn(t, back, curled).Size();
  EXPECT_TRUE(std::isfinite(pull));
  EXPECT_LT(pull, 1e5);
}

TEST(ModalCurl, FollowsNoFurtherThanItSettles) {
  const auto share = [](double turning) {
    const Vec3<V> r[N] = {Splat(Leaning(0.0)), Splat(Leaning(0.5 * turning)),
                          Splat(Leaning(turning))};
    return double(modal::FollowedCurl<V, N>(r)[0]);
  };
  EXPECT_EQ(share(0.5 * double(modal::kMostCurl)), 1.0);
  EXPECT_LT(share(1.25 * double(modal::kMostCurl)), 0.7);
  EXPECT_EQ(share(1.6 * double(modal::kMostCurl)), 0.0);
}

TEST(ModalCurl, MatricesAreThoseWorkedOut) {
  const ModalTableBlock t = MakeTable();
  constexpr double kBend[3][3] = {{1.919679, 3.918051, -.622935},
                                  {-4.774252, 2.089868, 1.100550},
                                  {3.136944, -4.548189, 2.667953}};
  constexpr double kTurn[3][3] = {{-6.296855, 7.436645, -1.139791},
                                  {-2.278732, 1.021203, 1.257529},
                                  {1.156850, -3.700247, 2.543396}};
  constexpr double kPull[3][3] = {{1.631961, -2.990016, 2.618970},
                                  {.277628, .965803, -2.450847},
                                  {-.037743, .312514, 1.353068}};
  constexpr double kWeight[3] = {.249941, .196271, .553788};
  // The rod's stiffness over its mass, in thirds of its length.
  const double rod = 9.0 * kOmega * kOmega / (3.51601527 * 3.51601527);
  for (uint32_t i = 0; i < N; ++i) {
    EXPECT_NEAR(double(t.curl_weight[i]) / rod, kWeight[i], 1e-6);
    for (uint32_t j = 0; j < N; ++j) {
      EXPECT_NEAR(double(t.curl_bend[i][j]), kBend[i][j], 1e-5);
      EXPECT_NEAR(double(t.curl_turn[i][j]), kTurn[i][j], 1e-5);
      EXPECT_NEAR(double(t.curl_pull[i][j]) / rod, kPull[i][j], 1e-5);
    }
  }
}

}  // namespace
}  // namespace pelt::test
