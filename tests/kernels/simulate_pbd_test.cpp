// The PBD solver: against its double reference, on every vector type, at rest, in contact and under
// abuse. Over 400 lines because the properties share scenes that would have to be made again
// elsewhere.
#include "core/kernels/simulate_pbd.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "tests/kernels/chain_scene.hpp"

namespace pelt::test {
namespace {

using V = Vec<IsaSse4>;
using Pbd4 = SimulatePbd<V, 4, false>;
using Pbd5 = SimulatePbd<V, 5, false>;
using PbdVertex = SimulatePbd<V, 4, true>;
constexpr ReferenceSolver kSolver = ReferenceSolver::kPbd;

TEST(SimulatePbd, StrandChainsMatchDoubleReference) {
  EXPECT_LT((WorstOfRandom<Pbd4, 4>(kSolver, false, 150)), kReferenceTolerance);
  EXPECT_LT((WorstOfRandom<Pbd5, 5>(kSolver, false, 150)), kReferenceTolerance);
}

TEST(SimulatePbd, VertexChainsMatchDoubleReference) {
  EXPECT_LT((WorstOfRandom<PbdVertex, 4>(kSolver, true, 150)), kReferenceTolerance);
}

// The same step with the tip's segment swept first: what the reference must be able to tell apart.
struct SweptBackwards {
  static bool HasSurface(const LayerBlock& layer) { return layer.surface_hardness > 0.0f; }
  static constexpr uint32_t kFree = 3;
  using Params = SimulateParams;
  using Ports = chain::Ports<4, false>;
  static void Run(const Params& params, const Ports& ports) {
    chain::Step<V, 4, false, SweptBackwards>::Run(params, ports);
  }
  template <class Terms, class W>
  PELT_INLINE static void Iterate(const Terms& terms, const Colliders<W>& colliders, bool clump,
                                  const Vec3<W> (&pull)[kFree], chain::Group<W, kFree>& g) {
    std::swap(g.point[1], g.point[2]);
    SimulatePbd<V, 4, false>::Iterate(terms, colliders, clump, pull, g);
    std::swap(g.point[1], g.point[2]);
  }
};

TEST(SimulatePbd, ReferenceTellsABrokenSolver) {
  EXPECT_GT((WorstOfRandom<SweptBackwards, 4>(kSolver, false, 5)), 100 * kReferenceTolerance);
}

template <class W>
using KernelPbd4 = SimulatePbd<W, 4, false>;
template <class W>
using KernelPbd5 = SimulatePbd<W, 5, false>;
template <class W>
using KernelPbdVertex = SimulatePbd<W, 4, true>;

TEST(SimulatePbd, SameBitsOnEveryVector) {
  ExpectSameStepsEverywhere<KernelPbd4, 4>();
  ExpectSameStepsEverywhere<KernelPbd5, 5>();
  ExpectSameStepsEverywhere<KernelPbdVertex, 4>();
}

TEST(SimulatePbd, LeavingOutUnusedWorkChangesNoBits) {
  auto with = NewScene<4>(), without = NewScene<4>();
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    MakeRandom(*without, seed);
    without->layer.flags &= ~uint32_t(kLayerWind | kLayerClump);
    without->params.use_ground = without->params.sphere_count = without->params.capsule_count = 0;
    *with = *without;
    with->layer.flags |= kLayerWind | kLayerClump;
    with->layer.clump = 0.0f;
    std::memset(&with->wind, 0, sizeof with->wind);
    with->params.use_ground = 1;
    with->params.ground[3] = 100.0f;
    with->params.sphere_count = 1;
    with->params.sphere[0][0] = 0.7f;  // some lanes have it near, none touches it
    with->params.sphere[0][3] = 1e-4f;
    StepChains<Pbd4>(*with);
    StepChains<Pbd4>(*without);
    EXPECT_TRUE(SameChains(*with, *without)) << seed;
  }
}

TEST(SimulatePbd, NewRestartedAndRigidChainsLieOnTheGroom) {
  auto s = NewScene<4>();
  MakeOrderly(*s, 7, 60);
  std::memset(static_cast<void*>(&s->position), 0xff, sizeof s->position);  // never written before
  std::memset(static_cast<void*>(&s->previous), 0xff, sizeof s->previous);
  const auto expect_groom = [&](uint32_t lane) {
    const auto groom = GroomOf(s->rest, s->roots, lane);
    for (uint32_t i = 0; i < 3; ++i) {
      EXPECT_LT(Length(At(s->position.position[i], lane) - groom[i]), 1e-6) << lane;
      EXPECT_EQ(Length(At(s->position.position[i], lane) - At(s->previous.position[i], lane)), 0.0)
          << lane;
    }
  };
  StepChains<Pbd4>(*s);
  for (uint32_t lane = 0; lane < 60; ++lane) expect_groom(lane);
  EXPECT_EQ(s->state.state_changed, 1u);

  s->state.first_new_strand = 40;
  for (uint32_t lane = 5; lane < 9; ++lane) s->rest.strength[lane] = 0.0f;
  MoveRoots(*s, 0.3f, 0.0f, -0.2f);
  StepChains<Pbd4>(*s);
  for (uint32_t lane = 40; lane < 60; ++lane) expect_groom(lane);
  for (uint32_t lane = 5; lane < 9; ++lane) expect_groom(lane);
  const auto groom = GroomOf(s->rest, s->roots, 20);
  EXPECT_GT(Length(At(s->position.position[2], 20) - groom[2]), 0.005);

  // A layer without any strength does the short way, with the same result.
  s->layer.flags &= ~uint32_t(kLayerSimulate);
  StepChains<Pbd4>(*s);
  for (uint32_t lane = 0; lane < 60; ++lane) expect_groom(lane);
  StepChains<Pbd4>(*s);
  EXPECT_EQ(s->state.state_changed, 0u);
}

TEST(SimulatePbd, StrengthGrowsTheDistanceFromTheGroom) {
  auto s = NewScene<4>();
  MakeOrderly(*s, 3);
  const float strengths[] = {0.0f, 0.25f, 0.5f, 0.75f, 1.0f};
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    s->rest.strength[lane] = strengths[lane % 5];
    for (auto& rows : s->rest.offset)  // all chains alike
      for (auto& row : rows) row[lane] = row[0];
    s->rest.segment_length[lane] = s->rest.segment_length[0];
    for (int k = 0; k < 3; ++k) {
      s->roots.normal[k][lane] = s->roots.normal[k][0];
      s->roots.tangent[k][lane] = s->roots.tangent[k][0];
    }
  }
  for (int frame = 0; frame < 120; ++frame) StepChains<Pbd4>(*s);
  double last = -1.0;
  for (uint32_t lane = 0; lane < 5; ++lane) {
    const double sag =
        Length(At(s->position.position[2], lane) - GroomOf(s->rest, s->roots, lane)[2]);
    EXPECT_GT(sag, last);
    last = sag;
  }
}

TEST(SimulatePbd, SegmentsKeepTheirLengthWhileTheBodyShakes) {
  auto s = NewScene<4>();
  MakeOrderly(*s, 11);
  double worst = 0.0, mean = 0.0, last_x = 0.0;
  constexpr int kFrames = 240;
  for (int frame = 0; frame < kFrames; ++frame) {
    // 7 cm to and fro at 2 Hz: a shaken head, 0.9 m/s.
    const double x = 0.07 * std::sin(12.566 * frame / 60.0);
    MoveRoots(*s, float(x - last_x), 0.0f, 0.0f);
    last_x = x;
    StepChains<Pbd4>(*s);
    const auto [w, m] = StretchOf(*s);
    worst = std::max(worst, w);
    mean += m / kFrames;
  }
  RecordProperty("worst_stretch", std::to_string(worst));
  RecordProperty("mean_stretch", std::to_string(mean));
  EXPECT_LT(worst, 0.2);
  EXPECT_LT(mean, 0.006);
}

TEST(SimulatePbd, PointsStayAboveTheSurfacePlane) {
  auto s = NewScene<4>();
  MakeOrderly(*s, 13);
  s->layer.surface_hardness = 1.0f;
  s->layer.link.angular_middle = s->layer.link.angular_end = 0.02f;  // soft: gravity lays them down
  s->layer.gravity[0] = 15.0f;
  s->layer.gravity[1] = -20.0f;
  bool touched = false;
  for (int frame = 0; frame < 200; ++frame) {
    MoveRoots(*s, frame % 20 < 10 ? 0.005f : -0.005f, 0.0f, 0.0f);
    StepChains<Pbd4>(*s);
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      for (uint32_t i = 0; i < 3; ++i) {
        const double height = Dot(At(s->position.position[i], lane) - At(s->roots.position, lane),
                                  At(s->roots.normal, lane));
        EXPECT_GT(height, -1e-6);
        touched |= height < 1e-6;
      }
  }
  EXPECT_TRUE(touched);
}

TEST(SimulatePbd, PointsStayAboveGroundAndOutOfSpheres) {
  auto s = NewScene<5>();
  MakeOrderly(*s, 17);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    s->roots.position[1][lane] = 0.01f;  // long enough to touch the ground
  s->layer.link.angular_middle = s->layer.link.angular_end = 0.02f;
  s->layer.surface_hardness = 0.0f;
  s->params.use_ground = 1;
  s->params.ground[1] = 1.0f;
  s->params.sphere_count = 1;
  s->params.sphere[0][1] = 0.05f;
  s->params.sphere[0][3] = 0.1f;
  for (int frame = 0; frame < 120; ++frame) StepChains<Pbd5>(*s);
  uint32_t on_ground = 0;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    for (uint32_t i = 0; i < 4; ++i) {
      const Double3 p = At(s->position.position[i], lane);
      EXPECT_GT(p.y, -1e-6);
      on_ground += p.y < 1e-5;
    }
  EXPECT_GT(on_ground, 20u);
}

TEST(SimulatePbd, ABounceReturnsItsShareOfSpeed) {
  auto s = NewScene<4>();
  MakeOrderly(*s, 19);
  s->layer.gravity[1] = -10.0f;
  s->layer.link.angular_middle = s->layer.link.angular_end = 0.0f;
  s->layer.link.segment_hardness = 0.0f;  // free points: nothing but the contact acts
  s->layer.link.velocity_keep = 1.0f;
  s->layer.surface_hardness = 0.0f;
  s->params.use_ground = 1;
  s->params.ground[1] = 1.0f;
  s->params.rest_threshold = 0.0f;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) s->roots.position[1][lane] = 0.0f;
  for (const float bounce : {0.0f, 0.5f, 1.0f}) {
    s->layer.bounce = bounce;
    s->state.flags |= kChunkRestart;
    StepChains<Pbd4>(*s);
    const float speed = 0.02f;  // m per frame, down
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      s->position.position[2][1][lane] = 0.01f;
      s->previous.position[2][1][lane] = 0.01f + speed;
    }
    StepChains<Pbd4>(*s);
    const double fall = 10.0 / 3600.0;
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      const double leave = s->position.position[2][1][lane] - s->previous.position[2][1][lane];
      const double slide = -0.01;  // without a bounce: what is left of the way down to the ground
      EXPECT_NEAR(leave, slide + bounce * (speed + fall - slide), 1e-6) << bounce;
    }
  }
}

// Frames until a step changes nothing, or -1.
template <class K, uint32_t kPoints>
int FramesToRest(ChainScene<kPoints>& s, int most) {
  for (int frame = 0; frame < most; ++frame) {
    StepChains<K>(s);
    if (s.state.state_changed == 0) return frame;
  }
  return -1;
}

TEST(SimulatePbd, AStillSceneReachesAFixedPoint) {
  struct Layer {
    const char* name;
    float middle, end, damping_keep;
  };
  const Layer layers[] = {{"default", 0.2f, 0.1f, 0.951f},
                          {"stiff", 0.6f, 0.5f, 0.951f},
                          {"soft", 0.05f, 0.03f, 0.951f},
                          {"barely damped", 0.2f, 0.1f, 0.992f}};
  auto s = NewScene<4>(), same = NewScene<4>();
  for (const Layer& layer : layers) {
    MakeOrderly(*s, 23);
    s->layer.link.angular_middle = layer.middle;
    s->layer.link.angular_end = layer.end;
    s->layer.link.velocity_keep = layer.damping_keep;
    StepChains<Pbd4>(*s);
    for (int frame = 0; frame < 10; ++frame) {  // give it something to settle from
      MoveRoots(*s, 0.01f, 0.0f, 0.0f);
      StepChains<Pbd4>(*s);
    }
    MoveRoots(*s, 0.0f, 0.0f, 0.0f);
    const int frames = FramesToRest<Pbd4>(*s, 600);
    RecordProperty(std::string("frames_to_rest ") + layer.name, frames);
    EXPECT_GE(frames, 0) << layer.name;
    EXPECT_LT(frames, 300) << layer.name;  // 5 s
    *same = *s;
    StepChains<Pbd4>(*s);
    EXPECT_TRUE(SameChains(*s, *same)) << layer.name;
  }
}

TEST(SimulatePbd, ComingToRestDoesNotBiasTheShape) {
  auto resting = NewScene<4>(), exact = NewScene<4>();
  MakeOrderly(*resting, 29);
  *exact = *resting;
  exact->params.rest_threshold = 0.0f;
  for (int frame = 0; frame < 1200; ++frame) {
    StepChains<Pbd4>(*resting);
    StepChains<Pbd4>(*exact);
  }
  ASSERT_EQ(resting->state.state_changed, 0u);
  double worst = 0.0;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    worst = std::max(worst, Length(At(resting->position.position[2], lane) -
                                   At(exact->position.position[2], lane)) /
                                (3.0 * resting->rest.segment_length[lane]));
  RecordProperty("worst_tip_bias_share_of_length", std::to_string(worst));
  EXPECT_LT(worst, 0.002);
}

TEST(SimulatePbd, MotionDoesNotGrowByItself) {
  auto s = NewScene<4>();
  for (const float hardness : {0.0f, 0.1f, 0.7f}) {
    MakeOrderly(*s, 31);
    s->layer.gravity[1] = 0.0f;
    s->layer.link.velocity_keep = 1.0f;
    s->layer.link.angular_middle = s->layer.link.angular_end = hardness;
    s->params.rest_threshold = 0.0f;
    StepChains<Pbd4>(*s);
    std::mt19937 random(5);
    for (uint32_t i = 0; i < 3; ++i)
      for (auto& row : s->previous.position[i])
        for (float& x : row) x += Uniform(random, -0.002f, 0.002f);
    const auto fastest = [&] {
      double worst = 0.0;
      for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
        double energy = 0.0;  // masses 9, 3, 1: what the shares of a correction say
        for (uint32_t i = 0; i < 3; ++i) {
          const Double3 v = At(s->position.position[i], lane) - At(s->previous.position[i], lane);
          energy += Dot(v, v) * (i == 0 ? 9.0 : i == 1 ? 3.0 : 1.0);
        }
        worst = std::max(worst, energy);
      }
      return worst;
    };
    const double start = fastest();
    double later = 0.0;
    for (int frame = 0; frame < 600; ++frame) {
      StepChains<Pbd4>(*s);
      if (frame >= 60) later = std::max(later, fastest());
    }
    EXPECT_LT(later, start) << hardness;
  }
}

TEST(SimulatePbd, StaysFiniteAndNearItsRootWhateverHappens) {
  auto s = NewScene<4>();
  std::mt19937 random(1234);
  for (uint32_t seed = 0; seed < 40; ++seed) {  // 40 x 128 chains
    MakeRandom(*s, 1000 + seed);
    s->params.use_ground = s->params.sphere_count = s->params.capsule_count = 0;
    s->layer.flags &= ~uint32_t(kLayerClump);  // its controls are anywhere
    s->params.dt = seed % 2 ? 1.0f / 15.0f : 1.0f / 240.0f;
    s->layer.link.segment_hardness = float(seed / 2 % 2);
    s->layer.link.angular_middle = s->layer.link.angular_end = float(seed / 4 % 2);
    s->layer.surface_hardness = float(seed / 8 % 2);
    for (uint32_t lane = 0; lane < kStrandsPerChunk; lane += 3)  // folded and collapsed starts
      for (uint32_t i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
          s->position.position[i][k][lane] =
              lane % 2 ? s->roots.position[k][lane]
                       : s->roots.position[k][lane] -
                             (s->rest.offset[i][k][lane] * (i % 2 ? 0.0f : 1.0f));
          s->previous.position[i][k][lane] = s->position.position[i][k][lane];
        }
    for (int frame = 0; frame < 40; ++frame) {
      const float jump = frame % 10 == 3 ? 5.0f : 0.0f;
      MoveRoots(*s, jump * (random() % 2 ? 1.0f : -1.0f), 0.4f * jump, 0.01f);
      if (frame % 7 == 5)
        for (auto& row : s->roots.motion) std::memset(row, 0, sizeof row);  // it may also lie
      StepChains<Pbd4>(*s);
      for (uint32_t lane = 0; lane < s->state.live_strands; ++lane)
        for (uint32_t i = 0; i < 3; ++i) {
          const double far =
              Length(At(s->position.position[i], lane) - At(s->roots.position, lane));
          // In the box (corner: 2 sqrt 3), give or take the length constraint's push.
          ASSERT_LT(far, 8.0 * s->rest.segment_length[lane] * 3) << "seed " << seed;
        }
    }
  }
}

TEST(SimulatePbd, AFarWorldIsSolvedAsFinelyAsTheOrigin) {
  auto near = NewScene<4>(), far = NewScene<4>();
  MakeOrderly(*near, 37);
  *far = *near;
  for (float& x : far->roots.position[0]) x += 64.0f;
  for (int frame = 0; frame < 60; ++frame) {
    StepChains<Pbd4>(*near);
    StepChains<Pbd4>(*far);
  }
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const Double3 a = At(near->position.position[2], lane) - At(near->roots.position, lane);
    const Double3 b = At(far->position.position[2], lane) - At(far->roots.position, lane);
    EXPECT_LT(Length(a - b), 6e-4) << lane;  // a float at 64 m steps by 8e-6 m
  }
}

TEST(SimulatePbd, EmptyChunkReportsNothing) {
  auto s = NewScene<4>();
  MakeOrderly(*s, 41, 0);
  s->state.state_changed = 1;
  StepChains<Pbd4>(*s);
  EXPECT_EQ(s->state.state_changed, 0u);
}

}  // namespace
}  // namespace pelt::test
