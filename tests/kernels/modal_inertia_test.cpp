// How much of what its root does a modal strand feels, and what it keeps when its links grow.
#include <gtest/gtest.h>

#include "core/groom/layer_params.hpp"
#include "tests/kernels/modal_scene.hpp"

namespace pelt::test {
namespace {

using Scene = ModalScene<4>;

// Sixteen strands that lean off the skin in all directions, with some curl.
std::unique_ptr<Scene> MakeScene(double damping = 0.05, double drag = 1.0) {
  auto s = std::make_unique<Scene>(StrandMaterial(4, 4.0, damping, drag), 16);
  std::mt19937 random(11);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const double a = 0.4 * lane;
    std::vector<Double3> links;
    for (int i = 0; i < 4; ++i) {
      const Double3 d{std::cos(a + 0.1 * i), std::sin(a + 0.1 * i), 0.8};
      links.push_back(Unit(d));
    }
    s->SetRest(lane, 0.02, links);
  }
  return s;
}

Double3 TurnedAboutY(Double3 p, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
}

// The skin at `to`, turned about the vertical.
void Place(Scene& s, Double3 to, double angle) {
  const Double3 normal = TurnedAboutY({0, 0, 1}, angle), tangent = TurnedAboutY({1, 0, 0}, angle);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    s.MoveRoot(lane, to);
    s.SetFrame(lane, normal, tangent);
  }
}

// Of a root that was on its way before the first frame.
void SetOff(Scene& s, Double3 speed) {
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) SetAt(s.roots.motion, lane, speed * kDt);
}

// The largest angle, rad, between links of two scenes, each turned back by its angle.
double Apart(const Scene& a, double angle_a, const Scene& b, double angle_b) {
  double worst = 0.0;
  for (uint32_t lane = 0; lane < 16; ++lane)
    for (uint32_t i = 0; i < 3; ++i)
      worst = std::max(worst, Length(TurnedAboutY(At(a.chain.direction[i], lane), -angle_a) -
                                     TurnedAboutY(At(b.chain.direction[i], lane), -angle_b)));
  return worst;
}

Double3 Shaken(double t) { return {0.1 * std::sin(9.0 * t), 0.05 * std::sin(14.0 * t), 0.3 * t}; }
double Yaw(double t) { return 2.0 * std::sin(3.0 * t) + t; }

TEST(ModalInertia, HalfOfItIsARootThatMovesHalfAsFar) {
  for (const float inertia : {0.0f, 0.25f, 0.5f}) {
    auto whole = MakeScene(), part = MakeScene();
    whole->layer.motion_follow = 1.0f - inertia;
    for (int f = 0; f < 90; ++f) {
      Place(*whole, Shaken(f * kDt), 0.0);
      Place(*part, Shaken(f * kDt) * double(inertia), 0.0);
      whole->Step(kDt);
      part->Step(kDt);
    }
    EXPECT_EQ(0, std::memcmp(&whole->chain.direction, &part->chain.direction,
                             sizeof part->chain.direction))
        << inertia;
    // Another than with all of it.
    auto all = MakeScene();
    for (int f = 0; f < 90; ++f) Place(*all, Shaken(f * kDt), 0.0), all->Step(kDt);
    EXPECT_GT(Apart(*all, 0.0, *part, 0.0), 0.02) << inertia;
    EXPECT_LT(whole->Stretch(), 1e-5);
  }
}

// About the vertical, as gravity does not turn.
TEST(ModalInertia, WithoutTurnsAStrandTurnsWithItsRoot) {
  auto still = MakeScene(), carried = MakeScene(), free = MakeScene();
  carried->layer.modal.turn_follow = 1.0f;
  double worst = 0.0, worst_free = 0.0;
  for (int f = 0; f < 120; ++f) {
    const double yaw = Yaw(f * kDt);
    Place(*still, {0, 0, 0}, 0.0);
    Place(*carried, {0, 0, 0}, yaw);
    Place(*free, {0, 0, 0}, yaw);
    for (Scene* s : {still.get(), carried.get(), free.get()}) s->Step(kDt);
    worst = std::max(worst, Apart(*carried, yaw, *still, 0.0));
    worst_free = std::max(worst_free, Apart(*free, yaw, *still, 0.0));
  }
  EXPECT_LT(worst, 2e-4);
  EXPECT_GT(worst_free, 0.2);
}

// Nor does what its root does besides become something else.
TEST(ModalInertia, TurnsLeaveTheRootsPathAlone) {
  auto moving = MakeScene(0.05, 0.0), standing = MakeScene(0.05, 0.0);
  for (Scene* s : {moving.get(), standing.get()}) s->layer.modal.turn_follow = 0.7f;
  double worst = 0.0;
  for (int f = 0; f < 120; ++f) {
    const double yaw = Yaw(f * kDt);
    const Double3 speed{3.0, -1.0, 2.0};
    Place(*moving, speed * (f * kDt), yaw);
    if (f == 0) SetOff(*moving, speed);
    Place(*standing, {0, 0, 0}, yaw);
    for (Scene* s : {moving.get(), standing.get()}) s->Step(kDt);
    worst = std::max(worst, Apart(*moving, yaw, *standing, yaw));
  }
  EXPECT_LT(worst, 2e-3);
}

// Half of the turns are those of a root that turns half as far; ever more so at higher rates.
TEST(ModalInertia, IsTheSameAtEveryFrameRate) {
  const auto apart_at = [](int rate) {
    auto whole = MakeScene(), part = MakeScene();
    whole->layer.modal.turn_follow = 0.5f;
    double worst = 0.0;
    for (int f = 0; f <= rate; ++f) {
      const double t = double(f) / rate, yaw = 2.0 * std::sin(3.0 * t);
      Place(*whole, {0, 0, 0}, yaw);
      Place(*part, {0, 0, 0}, 0.5 * yaw);
      whole->Step(1.0 / rate);
      part->Step(1.0 / rate);
      worst = std::max(worst, Apart(*whole, yaw, *part, 0.5 * yaw));
    }
    return worst;
  };
  const double at_30 = apart_at(30), at_60 = apart_at(60), at_240 = apart_at(240);
  std::printf("half the turns, off by %.4f at 30 Hz, %.4f at 60, %.4f at 240 Hz\n", at_30, at_60,
              at_240);
  EXPECT_LT(at_60, 0.05);
  EXPECT_LT(at_240, 0.3 * at_60 + 1e-4);
}

TEST(ModalInertia, NothingFasterIsFelt) {
  auto limited = MakeScene(), slow = MakeScene(), none = MakeScene();
  limited->layer.modal.fastest_felt = float(0.5 * kDt);
  double x = 0.0, felt = 0.0;
  for (int f = 0; f < 60; ++f) {
    const double speed = f > 20 && f < 30 ? 4.0 : 0.3 * std::sin(0.3 * f);
    x += speed * kDt;
    felt += std::min(std::max(speed, -0.5), 0.5) * kDt;
    Place(*limited, {x, 0, 0}, 0.0);
    Place(*none, {x, 0, 0}, 0.0);
    Place(*slow, {felt, 0, 0}, 0.0);
    for (Scene* s : {limited.get(), slow.get(), none.get()}) s->Step(kDt);
  }
  EXPECT_LT(Apart(*limited, 0.0, *slow, 0.0), 1e-3);
  EXPECT_GT(Apart(*limited, 0.0, *none, 0.0), 0.05);
}

// A strand whose links grow feels no more of an even motion than one that stands.
TEST(ModalInertia, GrowingLinksFeelNothingOfAnEvenMotion) {
  auto moving = MakeScene(0.05, 0.0), standing = MakeScene(0.05, 0.0);
  double worst = 0.0;
  for (int f = 0; f < 120; ++f) {
    const Double3 speed{4.0, 0.0, -3.0};
    Place(*moving, speed * (f * kDt), 0.0);
    if (f == 0) SetOff(*moving, speed);
    Place(*standing, {0, 0, 0}, 0.0);
    const float scale = 1.0f + float(std::min(f, 60)) / 60.0f;
    for (Scene* s : {moving.get(), standing.get()}) {
      s->layer.modal.shrink = s->layer.scale / scale;
      s->layer.scale = scale;
      s->Step(kDt);
    }
    worst = std::max(worst, Apart(*moving, 0.0, *standing, 0.0));
    // Points are as far apart as the parts have grown, but for what those are bent.
    for (uint32_t lane = 0; lane < 16; ++lane) {
      const Double3 first =
          At(moving->position.position[0], lane) - At(moving->roots.position, lane);
      ASSERT_NEAR(Length(first), 0.02 * scale, 0.03 * 0.02) << f;
    }
  }
  EXPECT_LT(worst, 2e-3);
}

// For any motion of the root.
TEST(ModalInertia, StaysFiniteAndKeepsItsLength) {
  for (const float follow : {0.3f, 1.0f}) {
    auto s = MakeScene();
    s->layer.modal.turn_follow = s->layer.motion_follow = follow;
    s->layer.modal.fastest_felt = 0.01f;
    std::mt19937 random(3);
    for (int f = 0; f < 300; ++f) {
      const double wild = f < 200 ? 1.0 : 0.0;
      for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
        const Double3 to = RandomUnit(random) * wild, n = RandomUnit(random),
                      e = RandomUnit(random);
        s->MoveRoot(lane, to);
        if (wild == 0.0) continue;
        const Double3 t = e + n * -Dot(n, e), unit = t * (1.0 / std::max(Length(t), 1e-3));
        s->SetFrame(lane, Unit(n), unit);
      }
      s->layer.modal.shrink = f % 50 == 0 ? 100.0f : f % 50 == 1 ? 0.01f : 1.0f;
      s->Step(f % 3 ? kDt : 1.0 / 24.0);
      ASSERT_LT(s->Stretch(), 1e-5) << f;
    }
  }
}

// A root that does not turn is as if nothing had been said of turns.
TEST(ModalInertia, OfTurnsIsNotAskedWhereThereAreNone) {
  auto with = MakeScene(), without = MakeScene();
  with->layer.modal.turn_follow = 0.5f;
  for (int f = 0; f < 60; ++f) {
    for (Scene* s : {with.get(), without.get()}) Place(*s, Shaken(f * kDt), 0.3), s->Step(kDt);
    ASSERT_EQ(0, std::memcmp(&with->chain, &without->chain, sizeof with->chain)) << f;
  }
}

TEST(ModalInertia, SameBitsOnEverySet) {
  const auto sets = OnEverySet([] { return MakeScene(); });
  for (int f = 0; f < 60; ++f)
    for (auto& [isa, s] : sets) {
      s->layer.motion_follow = 0.3f;
      s->layer.modal.turn_follow = 0.4f;
      s->layer.modal.fastest_felt = 0.02f;
      s->layer.modal.shrink = f % 9 == 5 ? 0.9f : 1.0f;
      Place(*s, Shaken(f * kDt), Yaw(f * kDt));
      s->Step(f % 7 == 3 ? 1.0 / 30.0 : f % 31 == 30 ? 0.2 : kDt, isa);
      const Scene& first = *sets[0].second;
      ASSERT_EQ(0, std::memcmp(&first.chain, &s->chain, sizeof s->chain)) << IsaName(isa) << f;
      ASSERT_EQ(0, std::memcmp(&first.position, &s->position, sizeof s->position)) << f;
    }
}

TEST(ModalInertia, IsTheModalSolversAlone) {
  LayerParams params;
  params.inertia = 0.5f;
  EXPECT_EQ(FindBadParam(params), "");
  params.solver = Solver::kPbd;
  EXPECT_EQ(FindBadParam(params),
            "inertia: only solver = \"modal\" has it; motion_damping is that of the others");
  params.inertia = 1.0f;
  params.inertia_speed = 3.0f;
  EXPECT_NE(FindBadParam(params), "");
}

}  // namespace
}  // namespace pelt::test
