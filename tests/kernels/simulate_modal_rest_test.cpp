// Strands that touch something come to rest, all bits, wherever their roots are: above the ground,
// under it, in a sphere or a capsule, between the ground and their own skin; with friction too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "tests/kernels/modal_scene.hpp"

namespace pelt::test {
namespace {

enum Solid { kGround, kSphere, kCapsule };

constexpr double kRadius = 0.02, kLength = 0.04;

// Roots from `low` to `high` m off the surface, the skin any way round.
template <uint32_t kPoints>
std::unique_ptr<ModalScene<kPoints>> StrandsAt(Solid solid, double low, double high, double hz) {
  auto s = std::make_unique<ModalScene<kPoints>>(StrandMaterial(kPoints, hz, 0.1, 4.0));
  s->params.rest_threshold = kRestThreshold;
  s->flags = kChunkSteady;
  std::mt19937 random(11);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const double off = low + (high - low) * lane / (kStrandsPerChunk - 1.0);
    // The root frame is turned only so that its normal is n; rest offsets are given in it.
    const Double3 n = RandomUnit(random), d = RandomUnit(random);
    const Double3 t = std::fabs(n.z) < 0.9 ? Double3{n.y, -n.x, 0.0} : Double3{0.0, n.z, -n.y};
    s->SetFrame(lane, n, Unit(t));
    s->SetRest(lane, kLength / (kPoints - 1), {d.x, d.y, std::fabs(d.z)});
    const Double3 out = RandomUnit(random), flat = Double3{out.x, out.y, 0.0};
    Double3 at = {0.0, off, 0.0};
    if (solid == kSphere) at = out * (kRadius + off);
    if (solid == kCapsule)
      at = flat * ((kRadius + off) / Length(flat)) + Double3{0, 0, 0.03 * out.z};
    s->MoveRoot(lane, at);
  }
  s->params.use_ground = solid == kGround;
  s->params.ground[1] = 1.0f;
  s->params.sphere_count = solid == kSphere;
  s->params.sphere[0][3] = float(kRadius);
  s->params.capsule_count = solid == kCapsule;
  s->params.capsule[0] = {{0.0f, 0.0f, -0.05f}, float(kRadius), {0.0f, 0.0f, 1.0f}, 0.1f};
  return s;
}

// Strands of which some bit of the state still changes.
template <uint32_t kPoints>
uint32_t CountMoving(ModalScene<kPoints>& s) {
  const ModalStateBlock<NodesOf(kPoints)> last = s.chain;
  s.Step(kDt);
  uint32_t moving = 0;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    moving += !SameLinks(last, s.chain, lane);
  return moving;
}

template <uint32_t kPoints>
uint32_t CountMovingAfter(double seconds, ModalScene<kPoints>& s) {
  for (int frame = 0; frame < int(seconds / kDt); ++frame) {
    s.Step(kDt);
    s.HoldRoots();
  }
  EXPECT_LT(s.Stretch(), 1e-5);
  return CountMoving(s);
}

// A bare root under the ground has nothing to fight with but the ground. One of 128 needs the rule for the
// restless all the same.
TEST(SimulateModalRest, StrandsUnderTheGroundRestByThemselves) {
  for (const ModalQuality quality : kQualities)
    for (const double hz : {1.0, 3.0}) {
      auto s = StrandsAt<5>(kGround, -0.02, 0.02, hz);
      s->quality = quality;
      EXPECT_EQ(CountMovingAfter(12.0, *s), 0u) << hz << " Hz, quality " << int(quality);
    }
}

// A few swing on for ever between a soft skin and the ground, each at its own pace: 11 of 27,648 with
// both frequencies and all qualities.
TEST(SimulateModalRest, StrandsInAndAboutSolidsRest) {
  uint32_t moving = 0;
  for (const Solid solid : {kGround, kSphere, kCapsule})
    for (const ModalQuality quality : {ModalQuality::kFast, ModalQuality::kFine})
      for (const float hardness : {0.0f, 0.7f})
        for (const float friction : {0.0f, 0.4f})
          for (const double side : {-1.0, 1.0}) {
            auto s = StrandsAt<5>(solid, side * 0.0001, side * 0.019, 3.0);
            s->quality = quality;
            s->layer.surface_hardness = hardness;
            s->layer.modal.friction = friction;
            moving += CountMovingAfter(8.0, *s);
          }
  EXPECT_LE(moving, 2u) << "of " << 48 * kStrandsPerChunk;
}

// Those beside the ground must not be stopped on their way: they lie where they would lie without.
TEST(SimulateModalRest, WhoSettlesByItselfSettlesThere) {
  for (const ModalQuality quality : kQualities) {
    const auto run = [&](uint32_t flags, float friction) {
      auto s = StrandsAt<4>(kGround, 0.001, 0.03, 3.0);
      s->quality = quality;
      s->layer.modal.friction = friction;
      s->flags = flags;
      CountMovingAfter(12.0, *s);
      return s;
    };
    for (const float friction : {0.0f, 0.4f}) {
      const auto kept = run(kChunkSteady, friction), free = run(0, friction);
      uint32_t elsewhere = 0;
      for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
        elsewhere += Length(kept->Tip(lane) - free->Tip(lane)) > 0.01 * kLength;
      EXPECT_LE(elsewhere, 1u) << "friction " << friction << ", quality " << int(quality);
    }
  }
}

// Held by friction 5 mm above the ground, in fast: still after a second and what it takes to fall.
TEST(SimulateModalRest, FrictionDoesNotCreep) {
  auto s = StrandsAt<4>(kGround, 0.005, 0.005, 2.0);
  s->quality = ModalQuality::kFast;
  s->layer.modal.friction = 0.4f;
  EXPECT_EQ(CountMovingAfter(4.0, *s), 0u);
}

// Who is kept as it is wakes as soon as something changes.
TEST(SimulateModalRest, WhoIsKeptIsMovedByWhatComes) {
  auto s = StrandsAt<4>(kGround, -0.01, 0.01, 3.0);
  s->layer.surface_hardness = 0.7f;
  s->layer.modal.friction = 0.4f;
  ASSERT_EQ(CountMovingAfter(12.0, *s), 0u);
  const auto before = std::make_unique<ModalScene<4>>(*s);
  s->flags = s->state.flags = 0;
  s->params.ground[3] = -0.01f;  // it rises by a centimetre
  s->params.ground_step.at_once = 1;
  s->Step(kDt);
  s->params.ground_step.at_once = 0;
  s->flags = s->state.flags = kChunkSteady;
  CountMovingAfter(1.0, *s);
  uint32_t moved = 0;
  for (uint32_t lane = kStrandsPerChunk / 2; lane < kStrandsPerChunk; ++lane)
    moved += Length(before->Tip(lane) - s->Tip(lane)) > 1e-4;
  EXPECT_GT(moved, kStrandsPerChunk / 4);
}

}  // namespace
}  // namespace pelt::test
