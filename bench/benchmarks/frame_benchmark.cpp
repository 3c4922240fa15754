// The whole frame, and each stage of it compared with what the machine could do at most.
//
//   frame/serial/SCENE        the whole frame on one core, ns per strand
//   stage/NAME/SCENE          a stage inside the frame: ns per strand, its limit and the ratio to it
//
// A stage's limit is the larger of its ports' bytes at the rate of the second-level cache (where a
// fused pass keeps its blocks) and its operations at the rate of multiplies and adds. All rates are
// measured at the start of this run; `from_memory_ns` is what the same bytes would take from main
// memory. Bytes are whole blocks, as a DMA would move them: a stage that touches a part of its
// blocks (the pose of a small skeleton, chunks that are not full) can come out below a ratio of 1.
// --isa=NAME chooses the kernels (the widest there is if not given).
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/benchmarks/benchmark_main.hpp"
#include "bench/report/budget.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "core/error.hpp"
#include "core/kernels/frame_table.hpp"
#include "core/simd.hpp"
#include "jobs/scene.hpp"
#include "platform_sim/pricing/record_stage.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

using Clock = std::chrono::steady_clock;
constexpr uint32_t kDigestFrames = 10;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Best of several: what the machine can do, not what it did while something else ran.
template <class Work>
double BestSeconds(int rounds, Work work) {
  double best = 1e30;
  for (int r = 0; r < rounds; ++r) {
    const auto start = Clock::now();
    work();
    best = std::min(best, SecondsSince(start));
  }
  return best;
}

double CopyRate(size_t bytes, int repeats) {
  std::vector<char> from(bytes, 1), to(bytes, 2);
  const double seconds = BestSeconds(7, [&] {
    for (int i = 0; i < repeats; ++i) {
      std::memcpy(to.data(), from.data(), bytes);
      asm volatile("" : : "r"(to.data()), "r"(from.data()) : "memory");
    }
  });
  return 2.0 * double(bytes) * repeats / seconds;
}

// Twelve chains of multiply and add: enough to fill two units of latency four. Without relaxed
// floating point the compiler can neither shorten nor merge them.
constexpr int kChains = 12, kSteps = 1 << 20;

template <int kLanes>
__attribute__((always_inline)) inline float RunChains() {
  using F = typename simd_detail::Native<kLanes>::F;
  F chain[kChains];
#pragma GCC unroll 12
  for (int c = 0; c < kChains; ++c) chain[c] = F{} + float(c);
  const F scale = F{} + 0.999f, step = F{} + 0.5f;
  for (int s = 0; s < kSteps; ++s) {
#pragma GCC unroll 12
    for (int c = 0; c < kChains; ++c) chain[c] = chain[c] * scale + step;
  }
  F sum = chain[0];
#pragma GCC unroll 12
  for (int c = 1; c < kChains; ++c) sum += chain[c];
  return sum[0];
}

#ifdef __x86_64__
__attribute__((target("avx512f"))) float RunChains512() { return RunChains<16>(); }
__attribute__((target("avx2"))) float RunChains256() { return RunChains<8>(); }
#endif
float RunChains128() { return RunChains<4>(); }

double OperationRate(Isa isa) {
  volatile float sink = 0.0f;
  int lanes = 4;
  float (*run)() = RunChains128;
#ifdef __x86_64__
  if (isa == Isa::kAvx512) run = RunChains512, lanes = 16;
  if (isa == Isa::kAvx2) run = RunChains256, lanes = 8;
#else
  static_cast<void>(isa);
#endif
  const double seconds = BestSeconds(7, [&] { sink = run(); });
  static_cast<void>(sink);
  return 2.0 * kChains * kSteps * lanes / seconds;
}

// What this machine can do at most, measured in the same run as the figures that are compared with it.
struct MachineLimits {
  double memory_bytes_per_s = 0.0;     // copying from and to main memory: bytes read plus written
  double cache_bytes_per_s = 0.0;      // the same within 128 KB read and 128 KB written
  double lane_operations_per_s = 0.0;  // multiplies and adds on vectors of the instruction set
};

// One core; takes about a second.
MachineLimits MeasureLimits(Isa isa) {
  return {CopyRate(size_t(256) << 20, 1), CopyRate(size_t(128) << 10, 2000), OperationRate(isa)};
}

// Lane operations of each stage of the scene's plan in the frame that has been begun, which is run
// by this call, on the recording kernels (platform_sim/pricing/recording_vec.hpp). One is an
// arithmetic, compare, select, logic or conversion on one lane; loads, stores and moves between
// lanes are not: bytes are accounted for by the ports. Nor is sorting, scalar code on integers.
std::vector<uint64_t> CountOperations(FurScene& scene) {
  constexpr uint64_t kLanes = 4;  // of a recorded operation
  const Frame frame = scene.CurrentFrame();
  std::vector<uint64_t> operations(frame.plan->stages.size());
  RecordFrame(frame, [&](uint32_t, uint32_t stage, uint32_t item) {
    Recorder recorder(Recorder::Keep::kCounts);
    RecordStage(frame, stage, item, RecordingKernels(), recorder).OrThrow();
    for (uint32_t k = 0; k < kRecordedKindCount; ++k)
      operations[stage] += kLanes * recorder.counts()[k] * LaneArithmetic(RecordedKind(k));
    return true;
  });
  return operations;
}

Isa bench_isa = BestIsa();
MachineLimits limits;

Scenario& GetScenario(const std::string& name) {
  static std::map<std::string, Scenario> loaded;
  auto [at, fresh] = loaded.try_emplace(name);
  if (fresh) at->second = LoadScenario(name);
  return at->second;
}

SceneOptions Options() {
  SceneOptions options;
  options.isa = bench_isa;
  return options;
}

// A scenario that has run its first frames, whose digest stands beside every figure.
struct WarmScenario {
  RunningScenario running;
  uint32_t frame = 0;
  Digest digest;

  explicit WarmScenario(const std::string& name) : running(GetScenario(name), Options()) {
    SerialExecutor serial;
    while (frame < kDigestFrames) {
      running.Begin(frame++);
      serial.Run(running.scene().CurrentFrame());
      digest.Add64(running.scene().DigestFrame());
    }
  }
  double strands() { return double(running.scene().layout().strand_count); }
  std::string Label() const {
    return fmt::format("{} digest of {} frames {:016x}", IsaName(bench_isa), kDigestFrames,
                       digest.Value());
  }
};

void RunSerialFrames(benchmark::State& state, const std::string& scene) {
  WarmScenario warm(scene);
  SerialExecutor serial;
  double seconds = 0.0;
  for (auto _ : state) {
    const auto start = Clock::now();
    warm.running.Begin(warm.frame++);
    serial.Run(warm.running.scene().CurrentFrame());
    const double took = SecondsSince(start);
    state.SetIterationTime(took);
    seconds += took;
  }
  state.counters["ns_per_strand"] = seconds * 1e9 / (double(state.iterations()) * warm.strands());
  state.SetLabel(warm.Label());
}

void RunStage(benchmark::State& state, const std::string& scene_name, uint32_t stage_index) {
  WarmScenario warm(scene_name);
  FurScene& scene = warm.running.scene();
  BudgetRecorder recorder(scene, 4096);
  SerialExecutor serial;
  for (auto _ : state) {
    // The recorder profiles every second frame.
    for (int i = 0; i < 2; ++i) {
      warm.running.Begin(warm.frame++);
      Frame frame = scene.CurrentFrame();
      frame.profile = recorder.Begin();
      serial.Run(frame);
      recorder.Finish(0, 0);
    }
    state.SetIterationTime(recorder.LastStageMs(stage_index) * 1e-3);
  }
  const StageBudget stage = recorder.Summarise().stages[stage_index];
  warm.running.Begin(warm.frame++);
  const double operations = double(CountOperations(scene)[stage_index]);
  const double strands = warm.strands();
  const double limit_s =
      std::max(stage.bytes / limits.cache_bytes_per_s, operations / limits.lane_operations_per_s);
  state.counters["ns_per_strand"] = stage.ns_per_strand;
  state.counters["B_per_strand"] = stage.bytes / strands;
  state.counters["ops_per_strand"] = operations / strands;
  state.counters["from_memory_ns"] = stage.bytes / limits.memory_bytes_per_s * 1e9 / strands;
  state.counters["limit_ns"] = limit_s * 1e9 / strands;
  state.counters["ratio"] = stage.core_ms.median * 1e-3 / limit_s;
  state.SetLabel(warm.Label());
}

void RegisterStages(const std::string& scene_name) {
  RunningScenario running(GetScenario(scene_name), Options());
  SerialExecutor serial;
  BudgetRecorder recorder(running.scene(), 4);
  for (uint32_t f = 0; f < 4; ++f) {
    running.Begin(f);
    Frame frame = running.scene().CurrentFrame();
    frame.profile = recorder.Begin();
    serial.Run(frame);
    recorder.Finish(0, 0);
  }
  const Budget budget = recorder.Summarise();
  for (uint32_t s = 0; s < budget.stages.size(); ++s) {
    if (budget.stages[s].ran == 0.0) continue;
    benchmark::RegisterBenchmark(
        fmt::format("stage/{}/{}", budget.stages[s].name, scene_name).c_str(),
        [scene_name, s](benchmark::State& state) { RunStage(state, scene_name, s); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(15);
  }
}

void RegisterAll() {
  limits = MeasureLimits(bench_isa);
  benchmark::AddCustomContext(
      "limits of one core",
      fmt::format("memory {:.1f} GB/s, cache {:.1f} GB/s, {:.1f} G lane operations/s ({})",
                  limits.memory_bytes_per_s * 1e-9, limits.cache_bytes_per_s * 1e-9,
                  limits.lane_operations_per_s * 1e-9, IsaName(bench_isa)));
  for (const std::string scene : {"cast", "monster"}) {
    benchmark::RegisterBenchmark(("frame/serial/" + scene).c_str(),
                                 [scene](benchmark::State& s) { RunSerialFrames(s, scene); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(100);
  }
  RegisterStages("cast");
  RegisterStages("eyepet");
}

// Takes --isa=NAME out of the arguments. The exit code.
int Main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::strncmp(argv[i], "--isa=", 6) != 0) continue;
    const auto isa = ParseIsa(argv[i] + 6);
    if (!isa || !FindKernels(*isa)) {
      fmt::print(stderr, "frame_benchmark: no kernels '{}' here\n", argv[i] + 6);
      return 2;
    }
    bench_isa = *isa;
    std::copy(argv + i + 1, argv + argc + 1, argv + i);
    --argc;
    break;
  }
  return RunBenchmarks(argc, argv, RegisterAll);
}

}  // namespace
}  // namespace pelt

int main(int argc, char** argv) { return pelt::Main(argc, argv); }
