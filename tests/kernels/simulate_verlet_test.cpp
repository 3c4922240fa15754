#include "core/kernels/simulate_verlet.hpp"

#include <gtest/gtest.h>

#include "tests/kernels/chain_scene.hpp"

namespace pelt::test {
namespace {

using V = Vec<IsaSse4>;
using Verlet4 = SimulateVerlet<V, 4>;
using Verlet5 = SimulateVerlet<V, 5>;
constexpr ReferenceSolver kSolver = ReferenceSolver::kVerlet;

TEST(SimulateVerlet, MatchesDoubleReference) {
  EXPECT_LT((WorstOfRandom<Verlet4, 4>(kSolver, false, 150)), kReferenceTolerance);
  EXPECT_LT((WorstOfRandom<Verlet5, 5>(kSolver, false, 150)), kReferenceTolerance);
}

TEST(SimulateVerlet, ReferenceTellsTheOtherSolver) {
  EXPECT_GT((WorstOfRandom<SimulatePbd<V, 5, false>, 5>(kSolver, false, 5)),
            100 * kReferenceTolerance);
}

template <class W>
using KernelVerlet5 = SimulateVerlet<W, 5>;

TEST(SimulateVerlet, SameBitsOnEveryVector) { ExpectSameStepsEverywhere<KernelVerlet5, 5>(); }

// Roots 4 mm around their control's.
void GatherAroundControls(ChainScene<5>& s) {
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    for (int k = 0; k < 3; ++k)
      s.roots.position[k][lane] =
          s.roots.position[k][s.strands.control[lane]] + 0.002f * float((lane >> k) % 3);
}

TEST(SimulateVerlet, ClumpingDrawsTipsTogetherAndLeavesControlsAlone) {
  auto loose = NewScene<5>(), clumped = NewScene<5>();
  MakeOrderly(*loose, 3);
  GatherAroundControls(*loose);
  *clumped = *loose;
  clumped->layer.flags |= kLayerClump;
  clumped->layer.clump = 0.4f;
  for (int frame = 0; frame < 120; ++frame) {
    StepChains<Verlet5>(*loose);
    StepChains<Verlet5>(*clumped);
  }
  const auto tip_distance = [](const ChainScene<5>& s, uint32_t lane) {
    return Length(At(s.position.position[3], lane) -
                  At(s.position.position[3], s.strands.control[lane]));
  };
  double before = 0.0, after = 0.0;
  for (uint32_t lane = 16; lane < kStrandsPerChunk; ++lane) {
    before += tip_distance(*loose, lane);
    after += tip_distance(*clumped, lane);
  }
  EXPECT_LT(after, 0.5 * before);
  for (uint32_t lane = 0; lane < 16; ++lane)
    EXPECT_EQ(
        Length(At(loose->position.position[3], lane) - At(clumped->position.position[3], lane)),
        0.0);
}

TEST(SimulateVerlet, AStillSceneReachesAFixedPointWithoutBias) {
  struct Layer {
    const char* name;
    float stiffness, clump;
  };
  auto s = NewScene<5>(), exact = NewScene<5>();
  for (const Layer& layer : {Layer{"default", 0.1f, 0.0f}, Layer{"clumped", 0.1f, 0.5f},
                             Layer{"soft", 0.02f, 0.0f}, Layer{"stiff", 0.5f, 0.2f}}) {
    MakeOrderly(*s, 23);
    s->layer.link.stiffness = layer.stiffness;
    s->layer.clump = layer.clump;
    GatherAroundControls(*s);
    if (layer.clump > 0) s->layer.flags |= kLayerClump;
    *exact = *s;
    exact->params.rest_threshold = 0.0f;
    int frames = -1;
    for (int frame = 0; frame < 1200; ++frame) {
      StepChains<Verlet5>(*s);
      StepChains<Verlet5>(*exact);
      if (frames < 0 && s->state.state_changed == 0) frames = frame;
    }
    RecordProperty(std::string("frames_to_rest ") + layer.name, frames);
    EXPECT_GE(frames, 0) << layer.name;
    EXPECT_LT(frames, 300) << layer.name;
    EXPECT_EQ(s->state.state_changed, 0u) << layer.name;
    double worst = 0.0;
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      worst = std::max(
          worst, Length(At(s->position.position[3], lane) - At(exact->position.position[3], lane)) /
                     (4.0 * s->rest.segment_length[lane]));
    RecordProperty(std::string("worst_tip_bias ") + layer.name, std::to_string(worst));
    EXPECT_LT(worst, 0.003) << layer.name;
  }
}

TEST(SimulateVerlet, MotionFollowCarriesTheChainAlong) {
  auto s = NewScene<5>();
  for (const float follow : {0.0f, 1.0f}) {
    MakeOrderly(*s, 5);
    s->layer.motion_follow = follow;
    s->layer.link.stiffness = 0.0f;
    s->layer.link.segment_hardness = 0.0f;
    s->layer.gravity[1] = 0.0f;
    s->params.rest_threshold = 0.0f;
    StepChains<Verlet5>(*s);
    const auto before = *s;
    MoveRoots(*s, 0.01f, 0.002f, 0.0f);
    StepChains<Verlet5>(*s);
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      const Double3 moved =
          At(s->position.position[3], lane) - At(before.position.position[3], lane);
      EXPECT_NEAR(moved.x, follow * 0.01, 1e-6);
      EXPECT_NEAR(moved.y, follow * 0.002, 1e-6);
      // Carried motion is no velocity.
      EXPECT_NEAR(s->position.position[3][0][lane], s->previous.position[3][0][lane], 1e-6);
    }
  }
}

TEST(SimulateVerlet, StaysFiniteWhateverHappens) {
  auto s = NewScene<5>();
  std::mt19937 random(99);
  for (uint32_t seed = 0; seed < 30; ++seed) {
    MakeRandom(*s, 2000 + seed);
    s->params.dt = seed % 2 ? 1.0f / 15.0f : 1.0f / 240.0f;
    s->layer.link.segment_hardness = float(seed / 2 % 2);
    s->layer.link.stiffness = float(seed / 4 % 2);
    s->layer.clump = float(seed / 8 % 2);
    std::memset(static_cast<void*>(&s->previous), 0, sizeof s->previous);  // thrown at 60 m/s
    for (int frame = 0; frame < 40; ++frame) {
      const float jump = frame % 10 == 3 ? 5.0f : 0.0f;
      MoveRoots(*s, jump * (random() % 2 ? 1.0f : -1.0f), 0.4f * jump, 0.01f);
      StepChains<Verlet5>(*s);
      for (uint32_t lane = 0; lane < s->state.live_strands; ++lane)
        for (uint32_t i = 0; i < 4; ++i)
          ASSERT_LT(Length(At(s->position.position[i], lane)), 300.0) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace pelt::test
