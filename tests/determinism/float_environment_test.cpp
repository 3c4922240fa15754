// Engines set flush-to-zero and odd rounding on their threads. A frame run there gives the same
// bits, and hands the thread back as it was.
#include "jobs/float_environment.hpp"

#include <gtest/gtest.h>

#include <cfenv>

#include "core/kernel.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/synthetic_scene.hpp"
#include "tests/jobs/tiny_scene.hpp"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace pelt {
namespace {

using namespace testing;

// The worst an engine's thread may bring along, and back again on the way out.
class OddThread {
 public:
  OddThread() {
    std::fegetenv(&saved_);
    std::fesetround(FE_UPWARD);
#if defined(__SSE__)
    _mm_setcsr(_mm_getcsr() | 0x8040u);  // flush to zero, denormals are zero
#endif
  }
  ~OddThread() { std::fesetenv(&saved_); }
  static bool IsStillOdd() {
#if defined(__SSE__)
    if ((_mm_getcsr() & 0x8040u) != 0x8040u) return false;
#endif
    return std::fegetround() == FE_UPWARD;
  }

 private:
  std::fenv_t saved_;
};

float Opaque(float x) {
  volatile float v = x;
  return v;
}

// 1.666...: to nearest it is rounded down.
float FiveThirds() { return Opaque(5.0f) / Opaque(3.0f); }

// Denormals and roundings: what an odd thread would change.
struct Fragile {
  static constexpr std::string_view kName = "fragile";
  struct Params {
    float third;
  };
  struct Ports {
    In<&Toys::baked> baked;
    Out<&Toys::made> made;
  };
  static void Run(const Params& p, const Ports& ports) {
    for (uint32_t i = 0; i < kToyLanes; ++i) {
      const float x = ports.baked->a[0][i];
      ports.made->value[0][i] = x * p.third;
      ports.made->value[1][i] = x * 1e-30f * 1e-11f;
      ports.made->value[2][i] = x + p.third;
    }
  }
};

TEST(FloatEnvironment, OddThreadsReallyRoundAndFlushOtherwise) {
  const float plain = FiveThirds();
  const OddThread odd;
  EXPECT_TRUE(OddThread::IsStillOdd());
  EXPECT_NE(FiveThirds(), plain);
#if defined(__SSE__)
  EXPECT_EQ(Opaque(1e-30f) * Opaque(1e-11f), 0.0f);
#endif
}

TEST(FloatEnvironment, IsPlainInsideAndAsItWasOutside) {
  const float plain = FiveThirds();
  const OddThread odd;
  {
    const FloatEnvironment inside;
    EXPECT_EQ(FiveThirds(), plain);
    EXPECT_GT(Opaque(1e-30f) * Opaque(1e-11f), 0.0f);
  }
  EXPECT_TRUE(OddThread::IsStillOdd());
}

constexpr Fragile::Params kParams{0.7f};

// One frame of a scene that was filled on an ordinary thread.
uint64_t RunFragile(Executor& executor, bool on_odd_thread) {
  SyntheticScene scene({{0, 0, 3}});
  const Plan plan =
      CompilePlan({MakeStage<Fragile>(Domain::kChunk, kParams)}, scene.shape(), {}).OrThrow();
  if (on_odd_thread) {
    const OddThread odd;
    executor.Run({&plan, &scene.memory()});
    EXPECT_TRUE(OddThread::IsStillOdd());
  } else {
    executor.Run({&plan, &scene.memory()});
  }
  return scene.DigestOf({StreamOf<&Toys::made>});
}

TEST(FloatEnvironment, EveryExecutorProtectsItsKernels) {
  SerialExecutor serial;
  const uint64_t truth = RunFragile(serial, false);
  PermutedExecutor permuted(1);
  LocalStoreExecutor local(PlanOptions{}.local_store_data_bytes);
  EXPECT_EQ(RunFragile(serial, true), truth);
  EXPECT_EQ(RunFragile(permuted, true), truth);
  EXPECT_EQ(RunFragile(local, true), truth);
}

TEST(FloatEnvironment, UnprotectedTheKernelGivesOtherBits) {
  SerialExecutor serial;
  SyntheticScene scene({{0, 0, 3}});
  {
    const OddThread odd;
    for (uint32_t c = 0; c < 3; ++c) {
      const Binding bindings[] = {{scene.memory().Block(StreamOf<&Toys::baked>, c), nullptr, 1},
                                  {scene.memory().Block(StreamOf<&Toys::made>, c), nullptr, 1}};
      MakeKernelDesc<Fragile>().run(&kParams, bindings);
    }
  }
  EXPECT_NE(scene.DigestOf({StreamOf<&Toys::made>}), RunFragile(serial, false));
}

// Parameters are worked out on the caller's thread: they are part of the bits too.
TEST(FloatEnvironment, WholeFrameIsTheSameOnAnOddThread) {
  SerialExecutor serial;
  Scenario scenario = TinyScenario();
  const auto truth = RunDigests(scenario, {}, serial, 12);
  RunningScenario running(scenario, {});
  for (uint32_t f = 0; f < truth.size(); ++f) {
    const FrameInput input = scenario.PrepareFrame(f, running.scene());
    const OddThread odd;
    ASSERT_EQ(running.scene().BeginFrame(input), nullptr);
    serial.Run(running.scene().CurrentFrame());
    EXPECT_TRUE(OddThread::IsStillOdd());
    ASSERT_EQ(running.scene().DigestFrame(), truth[f]) << "frame " << f;
  }
}

}  // namespace
}  // namespace pelt
