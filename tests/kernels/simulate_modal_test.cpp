// The modal solver as a kernel: same bits on every vector, rest, restart, strength, long frames, and
// that nothing breaks it. Its contacts: simulate_modal_contact_test.cpp; its accuracy:
// simulate_modal_accuracy_test.cpp.
#include <gtest/gtest.h>

#include "core/groom/layer_params.hpp"
#include "tests/kernels/modal_scene.hpp"

namespace pelt::test {
namespace {

// What a layer asks of all its lanes: each lets a lane's neighbours take other ways than its own.
struct BusyLayer {
  bool clump;
  float surface_hardness, max_distance, friction;
};
constexpr BusyLayer kBusyLayers[] = {{true, 1.0f, 0.6f, 0.0f},
                                     {false, 0.5f, 0.0f, 0.3f},
                                     {false, 1.0f, 0.6f, 1.0f},
                                     {true, 0.0f, 0.0f, 0.0f}};

// Everything at once: curl, strength, new lanes, wind, clump, surface, sphere, ground, violence.
template <uint32_t kPoints>
std::unique_ptr<ModalScene<kPoints>> MakeBusyScene(const BusyLayer& what) {
  auto s = std::make_unique<ModalScene<kPoints>>(StrandMaterial(kPoints, 3.0, 0.05, 4.0), 60);
  std::mt19937 random(7);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const Double3 d = RandomUnit(random), e = RandomUnit(random);
    std::vector<Double3> links;
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      const Double3 link = d + e * (0.3 * i);
      links.push_back(Unit(link));
    }
    s->SetRest(lane, Uniform(random, 0.005f, 0.02f), links);
    s->rest.strength[lane] = lane % 5 == 0 ? Uniform(random, 0.0f, 1.0f) : 1.0f;
    if (lane % 17 == 0) s->rest.strength[lane] = 0.0f;
    s->strands.control[lane] = uint8_t(lane % 16);
    s->MoveRoot(lane, {Uniform(random, -0.1f, 0.1f), Uniform(random, 0.0f, 0.1f), 0.0});
  }
  s->strands.control_count = 16;
  s->layer.flags |= kLayerWind | (what.clump ? kLayerClump : 0u);
  s->layer.clump = 0.3f;
  s->layer.surface_hardness = what.surface_hardness;
  s->layer.max_distance = what.max_distance;
  s->layer.modal.friction = what.friction;
  s->params.rest_threshold = kRestThreshold;
  s->AddGround();
  s->AddSphere(0.03f);
  return s;
}

template <uint32_t kPoints>
void RunBusyFrame(uint32_t frame, Isa isa, ModalScene<kPoints>& s) {
  s.state.live_strands = frame < 10 ? 50 : 60;
  s.state.first_new_strand = frame == 10 ? 50 : s.state.live_strands;
  const double jump = frame == 20 ? 0.3 : 0.01 * std::sin(0.4 * frame);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    s.MoveRoot(lane, At(s.roots.position, lane) + Double3{jump, 0, 0});
    s.wind.acceleration[2][lane] = float(10.0 * std::sin(0.2 * frame + lane));
  }
  // Then the ball goes through all of them, at 10 m/s.
  const float way = frame < 24 ? 0.0f : 1.0f / 6.0f;
  s.params.sphere[0][0] = way * (float(frame) - 26.5f);
  s.params.sphere_step[0] = {{way, 0, 0}, {way, 0, 0}, way > 0.0f ? 1u : 0u, 0};
  s.Step(frame % 7 == 3 ? 1.0 / 30.0 : kDt, isa);
}

// What was struck in frame 26 goes on in short steps, up to 133 per frame in the better qualities: one quality
// sees the end of that.
uint32_t BusyFrames(ModalQuality quality) { return quality == ModalQuality::kFast ? 40 : 30; }

// Calls expect(make, quality) for every layer and quality.
template <uint32_t kPoints>
void ForEveryBusyScene(bool at_vertices, auto expect) {
  for (const BusyLayer& layer : kBusyLayers)
    for (const ModalQuality quality : kQualities) {
      if (at_vertices && layer.clump) continue;
      SCOPED_TRACE(testing::Message()
                   << "layer " << &layer - kBusyLayers << ", quality " << int(quality));
      expect(
          [&] {
            auto s = MakeBusyScene<kPoints>(layer);
            s->quality = quality;
            return s;
          },
          quality);
    }
}

// Compared after every frame: what is seen of a lane may differ while its state does not.
template <uint32_t kPoints>
void ExpectSameOnEverySet() {
  ForEveryBusyScene<kPoints>(false, [](const auto& make, ModalQuality quality) {
    const auto sets = OnEverySet(make);
    const ModalScene<kPoints>& first = *sets[0].second;
    for (uint32_t frame = 0; frame < BusyFrames(quality); ++frame)
      for (const auto& [isa, s] : sets) {
        RunBusyFrame(frame, isa, *s);
        SCOPED_TRACE(testing::Message() << IsaName(isa) << ", frame " << frame);
        ASSERT_LT(s->Stretch(), 1e-5);
        ASSERT_EQ(0, std::memcmp(&first.chain, &s->chain, sizeof s->chain));
        ASSERT_EQ(0, std::memcmp(&first.position, &s->position, sizeof s->position));
        ASSERT_EQ(first.state.state_changed, s->state.state_changed);
      }
  });
}

TEST(SimulateModal, SameBitsOnEverySet4Points) { ExpectSameOnEverySet<4>(); }
TEST(SimulateModal, SameBitsOnEverySet5Points) { ExpectSameOnEverySet<5>(); }
TEST(SimulateModal, SameBitsOnEverySet9Points) { ExpectSameOnEverySet<9>(); }

// Chains at mesh vertices have the state of strands without clumping, and no points.
TEST(SimulateModal, SameBitsOnEverySetAtVertices) {
  ForEveryBusyScene<4>(true, [](const auto& make, ModalQuality quality) {
    const auto strands = make();
    const auto sets = OnEverySet(make);
    for (const auto& [isa, s] : sets) s->at_vertices = true;
    const PointBlock<4> untouched = strands->position;
    for (uint32_t frame = 0; frame < BusyFrames(quality); ++frame) {
      RunBusyFrame(frame, Isa::kReference, *strands);
      for (const auto& [isa, s] : sets) {
        RunBusyFrame(frame, isa, *s);
        SCOPED_TRACE(testing::Message() << IsaName(isa) << ", frame " << frame);
        ASSERT_LT(s->Stretch(), 1e-5);
        ASSERT_EQ(0, std::memcmp(&strands->chain, &s->chain, sizeof s->chain));
        ASSERT_EQ(sets[0].second->state.state_changed, s->state.state_changed);
        ASSERT_EQ(0, std::memcmp(&untouched, &s->position, sizeof untouched));
      }
    }
  });
}

std::unique_ptr<ModalScene<4>> RestingScene(uint32_t layer_flags = 0, bool at_vertices = false) {
  auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 5.0, 0.05, 6.0));
  s->layer.flags |= layer_flags;
  s->at_vertices = at_vertices;
  s->params.rest_threshold = kRestThreshold;
  int frames = 0;
  do {
    s->Step(kDt);
  } while (s->state.state_changed && ++frames < 1200);
  EXPECT_LT(frames, 600);
  return s;
}

void ExpectAFixedPoint(bool at_vertices) {
  auto s = RestingScene(0, at_vertices);
  const auto chain = s->chain;
  const auto position = s->position;
  s->Step(kDt);
  EXPECT_EQ(s->state.state_changed, 0u);
  EXPECT_EQ(0, std::memcmp(&chain, &s->chain, sizeof chain));
  EXPECT_EQ(0, std::memcmp(&position, &s->position, sizeof position));
  // A root that moves wakes it.
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) s->MoveRoot(lane, {0.001, 0, 0});
  s->Step(kDt);
  EXPECT_EQ(s->state.state_changed, 1u);
  // And without a threshold nothing is held.
  s->params.rest_threshold = 0.0f;
  s->HoldRoots();
  s->Step(kDt);
  EXPECT_EQ(s->state.state_changed, 1u);
}

TEST(SimulateModal, StillSceneReachesAFixedPoint) { ExpectAFixedPoint(false); }
TEST(SimulateModal, StillSceneAtVerticesReachesAFixedPoint) { ExpectAFixedPoint(true); }

// Of the lane groups some change whole, some in part, some not at all.
bool IsTouched(uint32_t lane) { return lane < 32 ? lane % 3 == 0 : lane < 64; }

// Same bits in a lane of every row of a block of such rows.
template <uint32_t kRow, class Block>
bool SameLane(const Block& a, const Block& b, uint32_t lane) {
  for (size_t at = lane; at < sizeof a / sizeof(float); at += kRow)
    if (std::memcmp(reinterpret_cast<const float*>(&a) + at,
                    reinterpret_cast<const float*>(&b) + at, sizeof(float)) != 0)
      return false;
  return true;
}

// Steps a scene at rest in which `change` was done to the touched lanes. It was so small that no
// link turned by what counts as motion; still none of them may keep what it knew of the last frame,
// or it would answer to all that was kept from it at once when it wakes. The others keep every bit.
template <class Change>
void ExpectOnlyTheTouchedWake(ModalScene<4>& s, Change change) {
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    if (IsTouched(lane)) change(lane);
  const auto before = s.chain;
  const auto position = s.position;
  s.Step(kDt);
  EXPECT_EQ(s.state.state_changed, 1u);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    SCOPED_TRACE(lane);
    for (uint32_t i = 0; i < 3; ++i) {
      ASSERT_LT(Length(At(s.chain.direction[i], lane) - At(before.direction[i], lane)),
                modal::kStillTurn)
          << "the change is not small enough to show anything";
    }
    EXPECT_GT(before.quiet_s[lane], 0.0f);
    if (IsTouched(lane)) {
      EXPECT_EQ(s.chain.quiet_s[lane], 0.0f);
    } else {
      EXPECT_TRUE(SameLane<kModalRow>(s.chain, before, lane));
      EXPECT_TRUE(SameLane<kStrandsPerChunk>(s.position, position, lane));
    }
  }
}

// What a strand has swung to turns with the root of a frame too long to be stepped, and lasts no
// longer than it would have; the root goes on as evenly as it came.
TEST(SimulateModal, ALongFrameCarriesStrandsWithTheirRoots) {
  constexpr double kWalk = 1.4, kHitch = 0.4;  // m/s, s
  const auto run = [](double hitch_s) {
    auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 3.0, 0.1, 4.0), 16);
    s->SetRest(0.02, {0.8, 0.0, 0.6});
    double x = 0.0;
    const auto walk = [&](double dt) {
      x += kWalk * dt;
      for (uint32_t lane = 0; lane < 16; ++lane) s->MoveRoot(lane, {x, 0.0, 0.0});
      s->Step(dt);
    };
    for (int frame = 0; frame < 30; ++frame) walk(kDt);
    if (hitch_s > 0.0) walk(hitch_s);
    double worst = 0.0;
    const Double3 before = s->Tip(0) - Double3{x, 0.0, 0.0};
    for (int frame = 0; frame < 30; ++frame) {
      walk(kDt);
      worst = std::max(worst, Length(s->Tip(0) - Double3{x, 0.0, 0.0} - before));
    }
    EXPECT_LT(s->Stretch(), 1e-5);
    return worst;
  };
  // It swings on from where it was, as from a frame of the usual length.
  const double usual = run(0.0), hitch = run(kHitch);
  EXPECT_LT(hitch, usual + 0.1 * 0.06);
}

TEST(SimulateModal, ALongFrameTurnsTheShapeWithTheRoot) {
  auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 3.0, 0.1, 4.0), 16);
  s->SetRest(0.02, {0.8, 0.0, 0.6});
  s->Step(kDt);
  for (int frame = 0; frame < 20; ++frame) s->Step(kDt);
  const Double3 before = s->Tip(0);
  ASSERT_GT(Length(before + Double3{-0.048, 0.0, -0.036}), 0.003) << "it hangs off its rest shape";
  // A quarter turn about z, and a step aside.
  for (uint32_t lane = 0; lane < 16; ++lane) {
    s->roots.tangent[0][lane] = 0.0f;
    s->roots.tangent[1][lane] = 1.0f;
    s->MoveRoot(lane, {0.5, 0.0, 0.0});
  }
  s->Step(0.3);
  const Double3 after = s->Tip(0) + Double3{-0.5, 0.0, 0.0};
  // The least turn from (0.8, 0, 0.6) to (0, 0.8, 0.6) keeps length and angle to the rest shape.
  const Double3 rest = {0.8, 0.0, 0.6}, turned = {0.0, 0.8, 0.6};
  EXPECT_NEAR(Length(after), Length(before), 1e-6);
  EXPECT_NEAR(Dot(after, turned), Dot(before, rest), 1e-6);
  EXPECT_LT(s->Stretch(), 1e-5);
}

TEST(SimulateModal, ALongFrameLetsWhatRestsRest) {
  auto s = RestingScene();
  s->Step(0.5);
  EXPECT_EQ(s->state.state_changed, 0u);
}

TEST(SimulateModal, TheLeastChangeOfWindWakes) {
  auto s = RestingScene(kLayerWind);
  ExpectOnlyTheTouchedWake(*s, [&](uint32_t lane) { s->wind.acceleration[2][lane] = 1.0e-5f; });
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    EXPECT_EQ(s->chain.wind[2][lane], s->wind.acceleration[2][lane]) << lane;
}

// The root stays where it is and turns its frame about the normal, by less than a link may turn.
TEST(SimulateModal, TheLeastChangeOfTheRestDirectionWakes) {
  constexpr float kTurn = 2.0e-7f;
  auto s = RestingScene();
  ExpectOnlyTheTouchedWake(*s, [&](uint32_t lane) { s->roots.tangent[1][lane] = kTurn; });
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    EXPECT_EQ(s->chain.bend[0][1][lane] != 0.0f, IsTouched(lane)) << lane;
}

TEST(SimulateModal, RestartNewLanesAndNoStrengthLieOnTheGroom) {
  auto s = MakeBusyScene<4>(kBusyLayers[0]);
  const auto on_groom = [&](uint32_t lane) {
    for (uint32_t i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        const float turned = s->rest.offset[i][k][lane];
        if (s->position.position[i][k][lane] != s->roots.position[k][lane] + turned) return false;
      }
    return true;
  };
  s->state.live_strands = s->state.first_new_strand = 50;
  s->Step(kDt);
  for (uint32_t lane = 0; lane < 50; ++lane) EXPECT_TRUE(on_groom(lane)) << lane;
  s->Step(kDt);
  uint32_t away = 0;
  for (uint32_t lane = 0; lane < 50; ++lane) {
    EXPECT_TRUE(on_groom(lane) || s->rest.strength[lane] > 0.0f) << lane;
    away += !on_groom(lane);
  }
  EXPECT_GT(away, 33u);
  s->state.live_strands = 60;
  s->Step(kDt);
  for (uint32_t lane = 50; lane < 60; ++lane) EXPECT_TRUE(on_groom(lane)) << lane;
}

// Towards a control strand that stands behind it by more than a link is long.
TEST(SimulateModal, AClumpedStrandOfEightLinksDoesNotFold) {
  constexpr double kLink = 0.01;
  auto s = std::make_unique<ModalScene<9>>(StrandMaterial(9, 3.0, 0.1, 6.0));
  s->layer.flags |= kLayerClump;
  s->layer.clump = 0.8f;
  s->layer.gravity[1] = 0.0f;
  s->strands.control_count = 16;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    s->strands.control[lane] = uint8_t(lane % 16);
    s->MoveRoot(lane, {lane < 16 ? -1.5 * kLink : 0.0, 0.0, 0.0});
  }
  s->Step(kDt);
  s->Step(kDt);
  for (uint32_t lane = 16; lane < kStrandsPerChunk; ++lane)
    for (uint32_t i = 1; i < 8; ++i)
      EXPECT_NEAR(s->position.position[i][0][lane] - s->position.position[i - 1][0][lane], kLink,
                  1e-6)
          << lane << ", link " << i;
}

// Starts and motions that make bare Newton solvers stick in wrong states.
struct Trial {
  const char* name;
  ModalMaterial material;
  double jump;    // m, at the first frame
  double jitter;  // m, every frame of the first second
};

std::vector<Trial> Trials() {
  const ModalMaterial fur = StrandMaterial(4, 5.0, 0.05, 6.0);
  const double k = UniformLinks(3, 5.0, 0.05, 6.0).stiffness[2][2];
  const ModalMaterial uneven = LinkMaterial({k, 1e6 * k, k}, {0.3, 0.3, 0.3}, 6.0);
  const ModalMaterial masses = LinkMaterial({k, k, k}, {0.3, 0.3e-4, 0.3}, 6.0);
  return {{"random starts and root jumps", fur, 0.1, 0.0},
          {"teleport", fur, 5.0, 0.0},
          {"jitter", fur, 0.0, 0.02},
          {"1,000 Hz", StrandMaterial(4, 1000.0, 0.05, 6.0, true), 0.1, 0.0},
          {"stiffness ratio 1e6", uneven, 0.1, 0.0},
          {"mass ratio 1e4", masses, 0.1, 0.0},
          {"no stiffness", StrandMaterial(4, 0.0, 0.0, 6.0), 0.1, 0.01}};
}

TEST(SimulateModal, NothingBreaksIt) {
  for (const Trial& trial : Trials())
    for (const ModalQuality quality : kQualities)
      for (const double rate : {15.0, 60.0, 240.0}) {
        SCOPED_TRACE(testing::Message()
                     << trial.name << ", quality " << int(quality) << ", " << rate << " fps");
        auto s = std::make_unique<ModalScene<4>>(trial.material);
        s->quality = quality;
        std::mt19937 random(11);
        s->Step(1.0 / rate);
        for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
          for (uint32_t i = 0; i < 3; ++i) s->SetDirection(lane, i, RandomUnit(random));
          if (lane == 0)  // folded
            for (uint32_t i = 0; i < 3; ++i) s->SetDirection(lane, i, {i % 2 ? -1.0 : 1.0, 0, 0});
          s->MoveRoot(lane, RandomUnit(random) * trial.jump);
        }
        for (int frame = 0; frame < int(rate * 8); ++frame) {
          if (frame < rate)
            for (uint32_t lane = 0; lane < kStrandsPerChunk && trial.jitter > 0; ++lane)
              s->MoveRoot(lane, RandomUnit(random) * trial.jitter);
          s->Step(1.0 / rate);
          s->HoldRoots();
          ASSERT_LT(s->Stretch(), 1e-5) << "frame " << frame;
        }
        // Links of 1 cm without stiffness swing faster than 15 fps can tell: bounded, not at rest.
        if (trial.material.stiffness[0][0] == 0.0 && rate < 30.0) continue;
        // All lanes have one rest shape and so one place to settle.
        for (uint32_t lane = 1; lane < kStrandsPerChunk; ++lane) {
          const auto offset = [&](uint32_t l) { return s->Tip(l) - At(s->roots.position, l); };
          ASSERT_LT(Length(offset(lane) - offset(1)), 1e-3 * 0.03) << "lane " << lane;
        }
      }
}

}  // namespace
}  // namespace pelt::test
