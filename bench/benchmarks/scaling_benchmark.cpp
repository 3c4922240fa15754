// How the frame spreads over cores, by every executor that has workers.
//
//   scaling/SCENE/EXECUTOR/WORKERS   median ms of a frame's run, how many times faster than the
//                                    serial executor that is, and the 99th percentile over the median
//
// BeginFrame is beside it (begin_ms): it runs on the caller's thread. All executors of a scene run in
// turn on one course of frames, a slice each, in rounds of alternating direction, so that other work on the
// machine hits all. Their last digest is compared with the serial executor's.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "bench/benchmarks/benchmark_main.hpp"
#include "bench/report/budget.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "bench/verify/executors.hpp"
#include "jobs/pass_loop.hpp"

namespace pelt {
namespace {

constexpr uint32_t kWarmUp = 30, kRounds = 12, kSlice = 12, kUntimed = 4;

struct Row {
  std::string executor;
  uint32_t workers;
  std::vector<double> run_ms, begin_ms;
};

double MsSince(TimePoint start) { return double(ElapsedNs(start)) * 1e-6; }

// The rows of one scene, measured together when the first is asked for.
class Scaling {
 public:
  explicit Scaling(const std::string& scene) : scenario_(LoadScenario(scene)) {
    rows_.push_back({"serial", 1, {}, {}});
    const uint32_t cores = std::max(2u, std::thread::hardware_concurrency());
    std::set<uint32_t> counts = {cores};
    for (const uint32_t w : {2u, 4u, 8u, 12u, 16u, 24u, 32u, 48u, 64u})
      if (w < cores) counts.insert(w);
    for (const uint32_t workers : counts)
      for (const ExecutorEntry& entry : ExecutorEntries())
        if (entry.order == ItemOrder::kThreads)
          rows_.push_back({std::string(entry.name), workers, {}, {}});
  }

  std::vector<Row>& rows() { return rows_; }
  // Null, or what went wrong.
  const char* Measure() {
    if (measured_) return fault_;
    measured_ = true;
    RunningScenario running(scenario_, {});
    SerialExecutor serial;
    for (uint32_t f = 0; f < kWarmUp; ++f) RunFrame(running, serial);
    for (uint32_t round = 0; round < kRounds; ++round)
      for (size_t i = 0; i < rows_.size(); ++i)
        RunSlice(running, rows_[round % 2 ? rows_.size() - 1 - i : i]);
    const uint64_t digest = running.scene().DigestFrame();
    RunningScenario truth(scenario_, {});
    const uint32_t frames = frame_;
    for (frame_ = 0; frame_ < frames;) RunFrame(truth, serial);
    if (truth.scene().DigestFrame() != digest) fault_ = "the digest is not the serial one";
    label_ = fmt::format("{} frames, digest {:016x}", frames, digest);
    return fault_;
  }
  const std::string& label() const { return label_; }

 private:
  void RunFrame(RunningScenario& running, Executor& executor, Row* row = nullptr) {
    const TimePoint start = Now();
    running.Begin(frame_++);
    const TimePoint begun = Now();
    executor.Run(running.scene().CurrentFrame());
    if (!row) return;
    row->run_ms.push_back(MsSince(begun));
    row->begin_ms.push_back(std::chrono::duration<double, std::milli>(begun - start).count());
  }
  void RunSlice(RunningScenario& running, Row& row) {
    const auto executor = ExecutorKind(row.executor)->make({.workers = row.workers});
    if (executor->ObservedWorkers() != row.workers)
      fault_ = "fewer workers ran than were asked for";
    for (uint32_t f = 0; f < kUntimed; ++f) RunFrame(running, *executor);
    for (uint32_t f = 0; f < kSlice; ++f) RunFrame(running, *executor, &row);
  }

  Scenario scenario_;
  std::vector<Row> rows_;
  uint32_t frame_ = 0;
  bool measured_ = false;
  const char* fault_ = nullptr;
  std::string label_;
};

double PercentileOf(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[std::min(values.size() - 1, size_t(double(values.size()) * share))];
}

void Show(benchmark::State& state, Scaling& scaling, size_t index) {
  const char* fault = scaling.Measure();
  Row& row = scaling.rows()[index];
  const double median = SpreadOf(row.run_ms).median;
  for (auto _ : state) state.SetIterationTime(median * 1e-3);
  if (fault) return state.SkipWithError(fault);
  state.counters["begin_ms"] = SpreadOf(row.begin_ms).median;
  state.counters["speed_up"] = SpreadOf(scaling.rows().front().run_ms).median / median;
  state.counters["p99_over_median"] = PercentileOf(row.run_ms, 0.99) / median;
  state.SetLabel(scaling.label());
}

void RegisterAll() {
  for (const std::string scene : {"monster", "stage", "cast"}) {
    const auto scaling = std::make_shared<Scaling>(scene);
    for (size_t i = 0; i < scaling->rows().size(); ++i) {
      const Row& row = scaling->rows()[i];
      benchmark::RegisterBenchmark(
          fmt::format("scaling/{}/{}/{}", scene, row.executor, row.workers).c_str(),
          [scaling, i](benchmark::State& state) { Show(state, *scaling, i); })
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond)
          ->Iterations(1);
    }
  }
}

}  // namespace
}  // namespace pelt

int main(int argc, char** argv) { return pelt::RunBenchmarks(argc, argv, pelt::RegisterAll); }
