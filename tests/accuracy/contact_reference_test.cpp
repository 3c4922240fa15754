// What errors of contact are measured from is itself right where the motion is known. That it
// converges on what is measured: feature_errors_test.cpp.
#include <gtest/gtest.h>

#include "bench/accuracy/reference_integrator.hpp"

namespace pelt::accuracy {
namespace {

using Directions = std::array<Double3, kMaxLinks>;

// One strand along x without springs, on a half-space below it.
ContactReference LyingStrand(double gravity_aside, double friction, int rate,
                             std::function<Double3(double)> way = {},
                             std::function<Double3(double)> speed = {}) {
  ChainMaterial material = MakeMaterial(kPresets[2], 3);
  material.stiffness = {};
  material.drag = material.bending_damping = 0.0;
  material.gravity = {0.0, -9.81, gravity_aside};
  Strand strand;
  strand.root = kZero3;
  Directions start{};
  for (int i = 0; i < 3; ++i) strand.rest[size_t(i)] = start[size_t(i)] = {1.0, 0.0, 0.0};
  ContactShape ground;
  ground.normal = {0.0, 1.0, 0.0};
  ground.way = std::move(way), ground.speed = std::move(speed);
  return {material, {strand}, {start}, MotionOf(Motion::kStill), {ground}, friction, rate};
}

TEST(ContactReference, HoldsWithinTheConeAndSlidesBeyondIt) {
  for (const double share : {0.99, 1.01}) {
    ContactReference reference = LyingStrand(share * 0.5 * 9.81, 0.5, 48000);
    while (reference.seconds() < 0.5) reference.Step();
    EXPECT_NEAR(reference.Point(0, 2).y, 0.0, 1e-8);
    if (share < 1.0)
      EXPECT_LT(std::fabs(reference.Point(0, 2).z), 1e-9);
    else
      EXPECT_GT(reference.Point(0, 2).z, 1e-3);
  }
}

// A strand that slides feels mu g less than what pulls it, as long as it goes straight down.
TEST(ContactReference, SlidesAsIfItWerePulledThatMuchLess) {
  ContactReference rubbed = LyingStrand(2.0 + 0.3 * 9.81, 0.3, 48000);
  ContactReference free = LyingStrand(2.0, 0.0, 48000);
  while (free.seconds() < 0.05) rubbed.Step(), free.Step();
  EXPECT_GT(free.Point(0, 2).z, 2e-3);
  EXPECT_NEAR(rubbed.Point(0, 2).z, free.Point(0, 2).z, 1e-2 * free.Point(0, 2).z);
}

// Ground that moves aside takes what lies on it along: 0.02 m/s for 0.1 s, held fast.
TEST(ContactReference, MovingGroundTakesAlongWhatItHolds) {
  ContactReference reference = LyingStrand(
      0.0, 1.0, 48000,
      [](double t) {
        return Double3{0.0, 0.0, 0.02 * t};
      },
      [](double) {
        return Double3{0.0, 0.0, 0.02};
      });
  while (reference.seconds() < 0.1) reference.Step();
  EXPECT_NEAR(reference.Point(0, 2).z, 0.002, 1e-4);
}

// A free strand is that of the eighth-order integrator.
TEST(ContactReference, IsTheExactMotionWhereNothingTouches) {
  const ChainMaterial material = MakeMaterial(kPresets[2], 3);
  const std::vector<Strand> strands = SeededStrands(3, 2, 5);
  std::vector<Directions> start;
  std::vector<ChainProblem> problems;
  for (const Strand& strand : strands) {
    start.push_back(FindEquilibrium(material, strand));
    problems.push_back({material, strand, MotionOf(Motion::kHeadshake), start.back(), {}});
  }
  ContactReference reference(material, strands, start, MotionOf(Motion::kHeadshake), {}, 0.0,
                             48000);
  ReferenceIntegrator exact(problems, 1920);
  for (int i = 0; i < 48000; ++i) reference.Step();
  for (int i = 0; i < 1920; ++i) exact.Step();
  for (size_t s = 0; s < 2; ++s)
    for (int k = 0; k < 3; ++k)
      EXPECT_LT(
          Length(reference.state(s).direction[size_t(k)] - exact.state(s).direction[size_t(k)]),
          2e-4);
}

}  // namespace
}  // namespace pelt::accuracy
