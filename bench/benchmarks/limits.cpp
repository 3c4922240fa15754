#include "bench/benchmarks/limits.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "core/error.hpp"
#include "core/simd.hpp"
#include "platform_sim/pricing/record_stage.hpp"

namespace pelt {
namespace {

using Clock = std::chrono::steady_clock;

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

}  // namespace

MachineLimits MeasureLimits(Isa isa) {
  return {CopyRate(size_t(256) << 20, 1), CopyRate(size_t(128) << 10, 2000), OperationRate(isa)};
}

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

}  // namespace pelt
