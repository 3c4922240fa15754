// The comb field: what vectors, joints and angles make of a strand's direction.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/groom/attributes.hpp"
#include "tests/error_from.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt::test {
namespace {

struct Combed : CoatedTorus {
  Combed() { layer.name = "coat"; }
  Comb Make() const { return Comb(character, rest, setup, layer); }
};

// On top of the ring at its +x side: normal +y.
const glm::vec3 kTop(0.3f, 0.1f, 0.0f);
const RootFrame kTopFrame = MakeRootFrame({0, 1, 0}, {0, 0, 1});

TEST(RootFrame, IsOrthonormalAndRightHanded) {
  const glm::dvec3 normals[] = {{0, 1, 0}, {1, 0, 0}, {0.3, -2.0, 0.4}, {0, 0, -1}, {0, 0, 0}};
  const glm::dvec3 tangents[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0.3, -2.0, 0.4}};
  for (const auto& n : normals) {
    for (const auto& t : tangents) {
      const RootFrame f = MakeRootFrame(n, t);
      EXPECT_NEAR(glm::length(f.normal), 1.0, 1e-12);
      EXPECT_NEAR(glm::length(f.tangent), 1.0, 1e-12);
      EXPECT_NEAR(glm::dot(f.normal, f.tangent), 0.0, 1e-9);
      EXPECT_NEAR(glm::length(f.bitangent - glm::cross(f.normal, f.tangent)), 0.0, 1e-12);
      const glm::dvec3 v(1.0, -2.0, 3.0);
      EXPECT_NEAR(glm::length(f.FromFrame(f.ToFrame(v)) - v), 0.0, 1e-9);
    }
  }
}

TEST(Comb, AzimuthAndElevationAreInTangentSpace) {
  const Combed f;
  const Comb comb = f.Make();
  for (const double azimuth : {-170.0, -30.0, 0.0, 45.0, 90.0}) {
    for (const double elevation : {0.0, 10.0, 45.0, 90.0}) {
      const double a = azimuth * M_PI / 180, e = elevation * M_PI / 180;
      const glm::dvec3 expected(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e));
      const glm::dvec3 got = comb.Direction(kTop, kTopFrame, azimuth, elevation);
      EXPECT_NEAR(glm::length(got - expected), 0.0, 1e-12);
    }
  }
}

TEST(Comb, AVectorRulesAtItsPlaceAndFadesToNothingAtItsReach) {
  Combed f;
  f.layer.comb = {{kTop, {0.0f, 0.0f, -3.0f}, 0.1f}};
  const Comb comb = f.Make();
  const glm::dvec3 drawn = kTopFrame.ToFrame({0, 0, -1});
  EXPECT_NEAR(DegreesBetween(comb.Direction(kTop, kTopFrame, 0, 60), drawn), 0.0, 1e-6);
  const glm::dvec3 fallback = Combed().Make().Direction(kTop, kTopFrame, 0, 60);
  for (const float outside : {0.1f, 0.11f, 5.0f}) {
    const glm::vec3 there = kTop + glm::vec3(outside, 0, 0);
    EXPECT_EQ(comb.Direction(there, kTopFrame, 0, 60), fallback);
  }
  double last = 0.0;
  for (float x = 0.0f; x <= 0.12f; x += 0.001f) {  // no jump anywhere, edge of reach included
    const double turned =
        DegreesBetween(comb.Direction(kTop + glm::vec3(x, 0, 0), kTopFrame, 0, 60), drawn);
    EXPECT_GE(turned, last - 1e-9);
    EXPECT_LT(turned - last, 6.0);
    last = turned;
  }
  const glm::vec3 near_edge = kTop + glm::vec3(0.0999f, 0, 0);
  EXPECT_LT(DegreesBetween(comb.Direction(near_edge, kTopFrame, 0, 60), fallback), 0.01);
}

TEST(Comb, WhatTheSetupSaysHoldsOutsideEveryReach) {
  Combed f;
  f.layer.comb = {{kTop, {0.0f, 0.0f, -3.0f}, 0.1f}};
  f.layer.comb_joint = "ring_2";
  const glm::dvec3 said(0.6, 0.0, 0.8), drawn = kTopFrame.ToFrame({0, 0, -1});
  const Comb comb = f.Make();
  EXPECT_EQ(comb.Direction(kTop + glm::vec3(0.2f, 0, 0), kTopFrame, 0, 60, &said), said);
  EXPECT_NEAR(DegreesBetween(comb.Direction(kTop, kTopFrame, 0, 60, &said), drawn), 0.0, 1e-6);
}

TEST(Comb, BetweenTwoEqualVectorsIsTheirMean) {
  Combed f;
  f.layer.comb = {{kTop + glm::vec3(0.02f, 0, 0), {0, 0, 1}, 0.1f},
                  {kTop - glm::vec3(0.02f, 0, 0), {0, 1, 0}, 0.1f}};
  f.layer.comb_normal_weight = 0.0f;
  const glm::dvec3 got = f.Make().Direction(kTop, kTopFrame, 180, 30);
  // Mean of the vectors, with a little of the fallback: weight w each leaves (1 - w)^2.
  const double w = std::pow(1.0 - 0.04, 2);
  const glm::dvec3 mean = glm::normalize(kTopFrame.ToFrame({0, 1, 1}));
  const glm::dvec3 fallback = Combed().Make().Direction(kTop, kTopFrame, 180, 30);
  const double left = (1 - w) * (1 - w);
  EXPECT_NEAR(glm::length(got - glm::normalize(mean * (1 - left) + fallback * left)), 0.0, 1e-6);
}

TEST(Comb, NormalsThatDisagreeWeakenAVector) {
  Combed f;
  f.layer.comb = {{kTop, {0, 0, -1}, 1.0f}};
  const RootFrame below = MakeRootFrame({0, -1, 0}, {0, 0, 1});
  const glm::dvec3 fallback = Combed().Make().Direction(kTop, below, 0, 60);
  auto share_taken = [&](float weight) {
    f.layer.comb_normal_weight = weight;
    return DegreesBetween(f.Make().Direction(kTop, below, 0, 60), fallback);
  };
  EXPECT_NEAR(share_taken(0.0f), 120.0, 1e-6);  // position alone: as drawn
  EXPECT_GT(share_taken(0.5f), 1.0);
  EXPECT_LT(share_taken(0.5f), share_taken(0.0f));
  EXPECT_NEAR(share_taken(1.0f), 0.0, 1e-6);  // the other side does not count
}

TEST(Comb, OutsideEveryReachTheJointGivesTheHeadingAndElevationRaisesIt) {
  Combed f;
  f.layer.comb_joint = "ring_2";  // at +z; its child ring_3 lies towards -x and a little -z
  const glm::dvec3 along =
      glm::normalize(glm::dvec3(TorusPoint(3.0 / 8, 0, 0)) - glm::dvec3(TorusPoint(2.0 / 8, 0, 0)));
  const glm::dvec3 got = kTopFrame.FromFrame(f.Make().Direction(kTop, kTopFrame, 77, 30));
  const glm::dvec3 expected = along * std::cos(M_PI / 6) + glm::dvec3(0, 1, 0) * std::sin(M_PI / 6);
  EXPECT_LT(DegreesBetween(got, expected), 1e-4);
  // Where the joint points straight out of the surface, the strand stands up.
  const RootFrame cap = MakeRootFrame(along, {0, 1, 0});
  EXPECT_LT(DegreesBetween(f.Make().Direction(kTop, cap, 77, 30), {0, 0, 1}), 1e-4);
  // The last of the chain has no child: from its parent.
  f.layer.comb_joint = "ring_7";
  const glm::dvec3 last =
      glm::normalize(glm::dvec3(TorusPoint(7.0 / 8, 0, 0)) - glm::dvec3(TorusPoint(6.0 / 8, 0, 0)));
  EXPECT_LT(DegreesBetween(kTopFrame.FromFrame(f.Make().Direction(kTop, kTopFrame, 0, 0)), last),
            1e-4);
}

TEST(Comb, UnknownAndPointlessJointsAreErrors) {
  Combed f;
  f.layer.comb_joint = "ring_9";
  const std::string error = ErrorFrom([&] { f.Make(); });
  EXPECT_NE(error.find("layer 'coat': key 'comb_joint'"), std::string::npos) << error;
  EXPECT_NE(error.find("'ring_7'"), std::string::npos) << error;
  for (JointPose& pose : f.character.skeleton.rest) pose.translation = glm::vec3(0.0f);
  f.layer.comb_joint = "ring_2";
  EXPECT_THROW(f.Make(), Error);
}

}  // namespace
}  // namespace pelt::test
