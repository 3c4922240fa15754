// Which chains rest: those none of whose points moved by the limit, and no others. Nothing acts on
// the chains here, so that each goes on as fast as it came and only the limit decides. Sleeping
// stands on the limit: a smaller one leaves chains awake that no viewer sees move, a larger one stops
// them where it is seen.
#include <gtest/gtest.h>

#include <memory>

#include "core/kernels/frame_table.hpp"
#include "tests/kernels/chain_scene.hpp"

namespace pelt::test {
namespace {

// What a lane of a scene does: how far one of its points moves per frame along x, and whether that
// is below the limit.
struct Pace {
  float step_m;
  bool rests;
};

// Chains at `root_x` on their groom, of which one point moves.
template <uint32_t kPoints, class PaceOf>
std::unique_ptr<ChainScene<kPoints>> CoastingScene(float root_x, PaceOf pace_of) {
  auto s = std::make_unique<ChainScene<kPoints>>();
  MakeOrderly(*s, 41);
  s->state.flags = kChunkSimulate;
  s->layer.gravity[1] = s->layer.surface_hardness = 0.0f;
  s->layer.link.velocity_keep = 1.0f;
  s->layer.link.iterations = 0;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    SetRoot(*s, lane, {root_x, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {1.0f, 0.0f, 0.0f});
    const std::vector<Double3> groom = GroomOf(s->rest, s->roots, lane);
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      SetAt(s->position.position[i], lane, groom[i]);
      SetAt(s->previous.position[i], lane, groom[i]);
    }
    s->previous.position[lane % (kPoints - 1)][0][lane] -= pace_of(*s, lane).step_m;
  }
  return s;
}

template <uint32_t kPoints>
void Run(const KernelDesc& kernel, ChainScene<kPoints>& s) {
  RunOnBlocks(kernel, &s.params, s.layer, s.state, s.rest, s.roots, s.wind, s.strands, s.position,
              s.previous);
}

template <uint32_t kPoints, class PaceOf>
void ExpectRest(const char* kernel, float root_x, PaceOf pace_of) {
  for (const Isa isa : kAllIsas) {
    if (!FindKernels(isa)) continue;
    SCOPED_TRACE(testing::Message()
                 << kernel << ", " << IsaName(isa) << ", root at " << root_x << " m");
    const auto s = CoastingScene<kPoints>(root_x, pace_of);
    const PointBlock<kPoints> before = s->position;
    Run(*FindKernels(isa)->Find(kernel), *s);
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      const uint32_t moving = lane % (kPoints - 1);
      const Pace pace = pace_of(*s, lane);
      const float moved = s->position.position[moving][0][lane] - before.position[moving][0][lane];
      // A chain that rests has no speed left either.
      EXPECT_EQ(s->previous.position[moving][0][lane], before.position[moving][0][lane]);
      if (pace.rests) {
        EXPECT_EQ(moved, 0.0f) << "lane " << lane << " moved by " << pace.step_m << " m";
      } else {
        EXPECT_NEAR(moved, pace.step_m, 0.02f * pace.step_m) << "lane " << lane;
      }
    }
  }
}

template <uint32_t kPoints, class PaceOf>
void ExpectRestOfBoth(float root_x, PaceOf pace_of) {
  ExpectRest<kPoints>(kPoints == 4 ? "simulate_pbd_4" : "simulate_pbd_5", root_x, pace_of);
  ExpectRest<kPoints>(kPoints == 4 ? "simulate_verlet_4" : "simulate_verlet_5", root_x, pace_of);
}

TEST(ChainRest, BelowTheThresholdsShareOfASegment) {
  const auto pace_of = [](const auto& s, uint32_t lane) -> Pace {
    constexpr float kShares[] = {0.45f, 0.55f, 0.95f, 1.05f, 2.0f};
    const float share = kShares[lane % 5];
    return {share * kRestThreshold * s.rest.segment_length[lane], share < 1.0f};
  };
  ExpectRestOfBoth<4>(0.0f, pace_of);
  ExpectRestOfBoth<5>(0.0f, pace_of);
}

// Far from the world's origin a step of a float is more than the threshold: 6 of them at 100 m are
// rounding, 7 are motion.
TEST(ChainRest, BelowSomeStepsOfAFloatFarAway) {
  const auto pace_of = [](const auto&, uint32_t lane) -> Pace {
    constexpr uint32_t kSteps[] = {2, 4, 6, 7, 12};
    constexpr float kStepAt100 = 0x1p-17f;
    return {float(kSteps[lane % 5]) * kStepAt100, kSteps[lane % 5] <= 6};
  };
  ExpectRestOfBoth<4>(100.0f, pace_of);
  ExpectRestOfBoth<5>(100.0f, pace_of);
}

}  // namespace
}  // namespace pelt::test
