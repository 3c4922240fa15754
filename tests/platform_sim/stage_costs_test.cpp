// Prices: from windows of a trace to cycles of every item, the same on every run and machine.
#include "platform_sim/pricing/stage_costs.hpp"

#include <algorithm>
#include <bit>
#include <memory>
#include <numeric>

#include "bench/scenarios/scenarios.hpp"
#include "core/random.hpp"
#include "platform_sim/pricing/kernel_cost.hpp"
#include "platform_sim/pricing/record_stage.hpp"
#include "tests/platform_sim/check_finished.hpp"
#include "tests/platform_sim/recording.hpp"
#include "traces/digest.hpp"

namespace pelt::testing {
namespace {

const PlatformParameters kPlatforms;

KernelCost Price(const Trace& trace, uint32_t iterations, CoreKind kind,
                 const PriceRules& rules = {}) {
  return PriceTrace(trace, iterations, MakePricedCore(kind, kPlatforms), rules).OrThrow();
}

// y = a x + b over many groups: two loads, a multiply-add and a store per iteration.
Trace Saxpy(uint32_t iterations) {
  return Record([&](Rows& rows) {
    float(&row)[16][64] = rows.row;
    for (uint32_t t = 0; t < iterations; ++t) {
      const uint32_t lane = 4 * t % 64;
      const uint32_t group = t / 16 % 4;
      (V::Load(row[group] + lane) * V(3.0f) + V::Load(row[4 + group] + lane))
          .Store(row[8 + group] + lane);
    }
  });
}

TEST(KernelCost, AStreamIsBoundByTheOddPipe) {
  const KernelCost cost = Price(Saxpy(64), 64, CoreKind::kSpu);
  EXPECT_EQ(cost.operations, 64u * 5);
  // lqd lqd fma stqd ai hbrr brnz: five of the odd pipe, two of the even one.
  EXPECT_NEAR(cost.instructions_per_iteration, 7.0, 0.1);
  EXPECT_NEAR(cost.scheduled.cycles_per_iteration, 5.0, 0.3);
  EXPECT_EQ(cost.binding, "odd pipe");
  // In order each iteration waits for its load, multiply-add and store.
  EXPECT_GT(cost.as_written.cycles_per_iteration, 2.0 * cost.scheduled.cycles_per_iteration);
  EXPECT_GE(cost.scheduled.fixed_cycles, 36.0);  // two mispredicted branches
}

// `rounds` times the same `length` operations.
Trace LoopOf(uint32_t length, uint32_t rounds) {
  constexpr RecordedKind kKinds[] = {RecordedKind::kAdd, RecordedKind::kSubtract,
                                     RecordedKind::kMultiply, RecordedKind::kLoad};
  Random random(1);
  std::vector<RecordedOperation> round(length);
  for (RecordedOperation& operation : round) operation.kind = kKinds[random.Below(4)];
  Trace trace;
  for (uint32_t r = 0; r < rounds; ++r)
    trace.operations.insert(trace.operations.end(), round.begin(), round.end());
  return trace;
}

TEST(RolledCode, ALongLoopIsThereOnce) {
  const auto share = [](const Trace& trace, uint32_t furthest) {
    return ShareOfOwnCode(trace, 0, uint32_t(trace.operations.size()), furthest);
  };
  const Trace loop = LoopOf(kLongEnough + 40, 5);
  EXPECT_EQ(share(loop, kLongEnough + 40), 0.2);
  // The next iteration's code is there beside this one's.
  EXPECT_EQ(share(loop, kLongEnough + 39), 1.0);
  EXPECT_EQ(share(LoopOf(kLongEnough + 40, 1), 10'000), 1.0);
  // A shorter one is written out as often as it takes.
  EXPECT_EQ(share(LoopOf(kLongEnough / 2, 2), 10'000), 1.0);
  EXPECT_EQ(share(LoopOf(kLongEnough / 2, 8), 10'000), 0.25);
  // Where something else comes between, what is left must be as long.
  Trace parted = loop;
  for (size_t i = kLongEnough / 2; i < parted.operations.size(); i += kLongEnough)
    parted.operations[i].kind = RecordedKind::kDivide;
  EXPECT_EQ(share(parted, 10'000), 1.0);
  EXPECT_EQ(share({}, 10), 1.0);
}

TEST(KernelCost, TwoThreadsOfAXenonShareItsDispatch) {
  const KernelCost cost = Price(Saxpy(64), 64, CoreKind::kXenon);
  EXPECT_GT(cost.scheduled.shared_cycles_per_iteration, cost.scheduled.cycles_per_iteration);
  EXPECT_LE(cost.scheduled.shared_cycles_per_iteration, 2.2 * cost.scheduled.cycles_per_iteration);
  const KernelCost spu = Price(Saxpy(64), 64, CoreKind::kSpu);
  EXPECT_EQ(spu.scheduled.shared_cycles_per_iteration, spu.scheduled.cycles_per_iteration);
}

// The windows see every loop of a kernel, in its proportion: two loops of unequal cost come out
// between the two, near the mean.
TEST(KernelCost, WindowsAreSpreadOverTheWholeTrace) {
  const auto work = [](Rows& rows, uint32_t iterations, int products) {
    for (uint32_t t = 0; t < iterations; ++t) {
      V x = V::Load(rows.row[t / 16 % 16] + 4 * t % 64);
      for (int p = 0; p < products; ++p) x = x * V(1.5f) + x;
      x.Store(rows.row[t / 16 % 16] + 4 * t % 64);
    }
  };
  PriceRules rules;
  rules.windows = 4;
  const auto price = [&](uint32_t few, uint32_t many) {
    return Price(Record([&](Rows& rows) {
                   work(rows, few, 4);
                   work(rows, many, 12);
                 }),
                 few + many, CoreKind::kSpu, rules)
        .scheduled.cycles_per_iteration;
  };
  const double light = price(128, 0), heavy = price(0, 128);
  EXPECT_GT(heavy, 1.8 * light);
  // As many operations in each: three times the iterations in the light loop, nearly.
  const double mixed = price(240, 80);
  EXPECT_NEAR(mixed, (240 * light + 80 * heavy) / 320, 0.25 * mixed);
}

TEST(KernelCost, TheHostsOperationsCostMore) {
  const Trace roots = Record([](Rows& rows) {
    for (int t = 0; t < 64; ++t)
      Rsqrt(V::Load(rows.row[t / 16] + 4 * t % 64)).Store(rows.row[8 + t / 16] + 4 * t % 64);
  });
  PriceRules host;
  host.lowering.host_operations = true;
  const KernelCost console = Price(roots, 64, CoreKind::kSpu);
  EXPECT_EQ(console.roots_per_iteration, 1.0);
  // 7 operations against 17, and the iteration's counter.
  EXPECT_NEAR(console.scheduled.cycles_per_iteration, 8.0, 1.5);
  EXPECT_NEAR(Price(roots, 64, CoreKind::kSpu, host).scheduled.cycles_per_iteration, 18.0, 2.0);
}

TEST(KernelCost, ALoadHitStoreIsSeenByItsAddress) {
  const auto extract = [](bool read) {
    return Price(Record([&](Rows& rows) {
                   for (int t = 0; t < 8; ++t) {
                     const V x = V::Load(rows.row[t]) * V(2.0f);
                     x.Store(rows.row[t]);
                     if (read) static_cast<void>(x[1]);
                   }
                 }),
                 1, CoreKind::kXenon)
        .as_written.cycles_per_iteration;
  };
  EXPECT_GT(extract(true), extract(false) + 8 * 30);
}

// A planted error in the core's numbers reaches the price.
TEST(KernelCost, FollowsTheCoresParameters) {
  PlatformParameters slow;
  slow.cell.spu.Of(SpuClass::kFp6).latency_cycles = 12;
  const KernelCost cost =
      PriceTrace(Saxpy(64), 64, MakePricedCore(CoreKind::kSpu, slow), {}).OrThrow();
  EXPECT_GT(cost.as_written.cycles_per_iteration,
            Price(Saxpy(64), 64, CoreKind::kSpu).as_written.cycles_per_iteration + 4.0);
}

class PricedScene {
 public:
  explicit PricedScene(const char* name)
      : scenario_(LoadScenario(name)), running_(scenario_, {.isa = Isa::kReference}) {
    Begin(0);
    SerialExecutor().Run(frame());
    Begin(1);
  }
  void Begin(uint32_t f) {
    running_.Begin(f, {false, false, false, false, false, false}, scenario_.base.lod);
  }
  Frame frame() { return running_.scene().CurrentFrame(); }
  StageCosts Price(CoreKind kind, const PriceRules& rules = {}) {
    return PriceStages(frame(), RecordingKernels(), MakePricedCore(kind, kPlatforms), rules)
        .OrThrow();
  }
  uint64_t digest() { return running_.scene().DigestFrame(); }

 private:
  Scenario scenario_;
  RunningScenario running_;
};

const StageCosts::Stage& Find(const StageCosts& costs, std::string_view name) {
  const auto at = std::ranges::find(costs.stages, name, &StageCosts::Stage::name);
  EXPECT_NE(at, costs.stages.end()) << name;
  return *at;
}
float Most(const StageCosts::Stage& stage) {
  return *std::ranges::max_element(stage.scheduled.cycles_per_iteration);
}

// Priced once for all that look at it.
struct Priced {
  PricedScene scene{"tiny"};
  StageCosts costs = scene.Price(CoreKind::kSpu);
};
Priced& OnSpu() {
  static Priced priced;
  return priced;
}

uint64_t DigestOf(const StageCosts& costs) {
  Digest digest;
  const auto add = [&](float f) { digest.Add(std::bit_cast<uint32_t>(f)); };
  for (const StageCosts::Stage& stage : costs.stages) {
    for (const StageCosts::Stage::Price* price : {&stage.as_written, &stage.scheduled}) {
      std::ranges::for_each(price->cycles_per_iteration, add);
      std::ranges::for_each(price->shared_cycles_per_iteration, add);
      add(price->fixed_cycles);
    }
    digest.Add(stage.code_bytes);
  }
  return digest.Value();
}

// For any compiler and any build of the kernels, and wherever in memory they ran. What
// changes a kernel, a core or a schedule changes these: put in what the test prints, once the costs
// themselves have been looked at.
TEST(KnownPrices, AreThoseOfEachTrace) {
  const PricedCore core = MakePricedCore(CoreKind::kSpu, kPlatforms);
  KnownPrices known;
  Trace other = Saxpy(64);
  other.operations.back().address += 16;
  for (int again = 0; again < 2; ++again)
    for (const auto& [trace, iterations] :
         {std::pair{Saxpy(64), 64u}, {Saxpy(64), 32u}, {Saxpy(32), 32u}, {other, 64u}}) {
      const KernelCost is = PriceTrace(trace, iterations, core, {}).OrThrow();
      const KernelCost found = known.Find(trace, iterations, core, {}).OrThrow();
      EXPECT_EQ(found.scheduled.cycles_per_iteration, is.scheduled.cycles_per_iteration);
      EXPECT_EQ(found.as_written.fixed_cycles, is.as_written.fixed_cycles);
      EXPECT_EQ(found.operations, is.operations);
      EXPECT_EQ(found.code_bytes, is.code_bytes);
    }
}

TEST(StageCosts, AreTheSameFromEveryCompilerAndInEveryPlace) {
  constexpr uint64_t kOnSpu = 3193261170554024843u, kOnXenon = 7290608679558397835u;
  EXPECT_EQ(DigestOf(OnSpu().costs), kOnSpu);
  const auto in_between = std::make_unique<char[]>(12345);
  PricedScene elsewhere("tiny");
  EXPECT_EQ(DigestOf(elsewhere.Price(CoreKind::kXenon, {.lowering = {}, .windows = 1})), kOnXenon);
}

// On real kernels: what the scheduler makes does what was lowered, and a solver, whose chains one
// iteration cannot hide, keeps the busiest pipe busy.
TEST(KernelCost, ScheduledWindowsOfAFrameAreRight) {
  PricedScene scene("tiny");
  const Frame frame = scene.frame();
  std::vector<bool> seen(frame.plan->stages.size());
  std::string error;
  const bool done = RecordFrame(frame, [&](uint32_t, uint32_t stage, uint32_t item) {
    Recorder recorder(seen[stage] ? Recorder::Keep::kCounts : Recorder::Keep::kOperations);
    RecordStage(frame, stage, item, RecordingKernels(), recorder).OrThrow();
    const uint32_t iterations = CountIterations(frame, stage, item);
    if (seen[stage] || iterations < 8 || recorder.operation_count() == 0) return true;
    seen[stage] = true;
    for (const CoreKind kind : {CoreKind::kSpu, CoreKind::kPpe, CoreKind::kXenon}) {
      const PricedCore core = MakePricedCore(kind, kPlatforms);
      const auto window = ScheduleWindow(recorder.trace(), iterations, core, {}).OrThrow();
      EXPECT_TRUE(CheckFinishedCode(window.lowered, window.code, core.scheduling, error))
          << frame.plan->stages[stage].kernel.name << ", " << CoreKindName(kind) << ": " << error;
    }
    return true;
  });
  EXPECT_TRUE(done) << error;
  EXPECT_GT(std::ranges::count(seen, true), 8);
}

TEST(StageCosts, ASolverKeepsTheBusiestPipeBusy) {
  for (const KernelCost& kind : Find(OnSpu().costs, "simulate_pbd_5").kinds)
    EXPECT_GT(kind.busiest_unit_share, 0.75);
}

TEST(StageCosts, PricingAFrameRunsIt) {
  PricedScene run("tiny");
  SerialExecutor().Run(run.frame());
  EXPECT_EQ(OnSpu().scene.digest(), run.digest());
}

TEST(StageCosts, EveryStageThatRunsCostsSomething) {
  const StageCosts& costs = OnSpu().costs;
  ASSERT_EQ(costs.stages.size(), OnSpu().scene.frame().plan->stages.size());
  for (const StageCosts::Stage& stage : costs.stages) {
    EXPECT_GT(Most(stage), 0.0f) << stage.name;
    EXPECT_GT(stage.scheduled.fixed_cycles, 0.0f) << stage.name;
    for (const StageCosts::Stage::Price* price : {&stage.as_written, &stage.scheduled})
      EXPECT_EQ(price->cycles_per_iteration, price->shared_cycles_per_iteration) << stage.name;
    for (const KernelCost& kind : stage.kinds) {
      EXPECT_LE(kind.scheduled.cycles_per_iteration, kind.as_written.cycles_per_iteration * 1.01)
          << stage.name;
      EXPECT_LE(kind.most_live, kind.register_limit) << stage.name;
    }
  }
  // A chain of five points costs more than a cubic through it.
  EXPECT_GT(Most(Find(costs, "simulate_pbd_5")), 10 * Most(Find(costs, "fit_cubic_5")));
  // What no recording sees is charged by the rule, not left out.
  for (const char* name : {"activate_patch", "activate", "activate_followers"})
    EXPECT_TRUE(Find(costs, name).kinds.empty()) << name;
  EXPECT_GT(Most(Find(costs, "collect_changes")), 100.0f);
}

TEST(StageCosts, IterationsFollowTheLivingLanes) {
  PricedScene scene("tiny");
  SerialExecutor().Run(scene.frame());
  const Frame frame = scene.frame();
  uint32_t chunks = 0, patches = 0;
  const auto expect = [&](uint32_t stage, uint32_t item, uint32_t& live) {
    EXPECT_EQ(CountIterations(frame, stage, item), (live + 15) / 16 * 4);
    live = 17;
    EXPECT_EQ(CountIterations(frame, stage, item), 8u);
    live = 0;
    EXPECT_EQ(CountIterations(frame, stage, item), 0u);
  };
  for (uint32_t s = 0; s < frame.plan->stages.size(); ++s) {
    const Stage& stage = frame.plan->stages[s];
    if (stage.kernel.name == "select_lod") {
      EXPECT_EQ(CountIterations(frame, s, 0), 1u);
    }
    if (stage.kernel.name == "roots")
      for (; chunks < frame.memory->shape->chunk_count; ++chunks)
        expect(s, chunks, frame.memory->Of<&Streams::chunk_state>(chunks)->live_strands);
    if (stage.kernel.name == "skin")
      for (; patches < frame.memory->shape->patch_count; ++patches)
        expect(s, patches, frame.memory->Of<&Streams::patch_state>(patches)->live_vertices);
  }
  EXPECT_GT(chunks, 0u);
  EXPECT_GT(patches, 0u);
}

}  // namespace
}  // namespace pelt::testing
