// What recording costs per frame.
//
//   trace/EXECUTOR/SCENE   frames with and without a profile, in turn, of one scene in one run
//
// Pairs of frames swap which of the two comes first, so that neither has the later frames. `items`
// and `stages` are ratios of medians: frames that time items, or stages too, over frames that time
// nothing. `ratio` is what a traced run has of them; the aim is under 2 %. Nearly all of it is
// reading the clock (23 ns where this was first measured). `..._cpu` are the same of the time the
// calling thread had a processor, for machines that others use too; of the serial executor it is
// all of the frame. Copying a record out of the profile (`copy_ms`) happens between frames, and is
// in neither.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "bench/benchmarks/benchmark_main.hpp"
#include "bench/report/budget.hpp"
#include "bench/report/timeline.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "jobs/pass_loop.hpp"
#include "jobs/tbb_executor.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

constexpr uint32_t kWarmFrames = 10;
constexpr uint32_t kPairs = 400;

// Time the calling thread had a processor.
double ThreadMs() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) * 1e3 + double(time.tv_nsec) * 1e-6;
}

// workers 0: the serial executor.
void RunPairs(benchmark::State& state, const std::string& name, uint32_t workers) {
  static Scenario scenario;
  if (scenario.name != name) scenario = LoadScenario(name);
  RunningScenario running(scenario, {});
  FurScene& scene = running.scene();
  FrameRecording recording(scene.plan(), scene.shape());
  uint32_t recorded = 0;
  std::unique_ptr<Executor> executor = std::make_unique<SerialExecutor>();
  if (workers) executor = std::make_unique<TbbExecutor>(workers);
  uint32_t frame_number = 0;
  // The record is made as `pelt run --trace` makes it.
  std::vector<double> off_ms, items_ms, stages_ms, off_cpu_ms, items_cpu_ms, stages_cpu_ms, copy_ms;
  const auto run = [&](bool record) {
    const double cpu_ms = ThreadMs();
    const TimePoint start = Now();
    FrameTicks ticks{.begin = ReadTicks()};
    running.Begin(frame_number);
    ticks.prepared = ReadTicks();
    Frame frame = scene.CurrentFrame();
    const bool stages = record && recorded++ % 2 == 1;
    recording.TimeStages(stages);
    if (record) frame.profile = recording.profile();
    executor->Run(frame);
    ticks.end = ReadTicks();
    const double ms = double(ElapsedNs(start)) * 1e-6, now_cpu_ms = ThreadMs();
    (stages ? stages_ms : record ? items_ms : off_ms).push_back(ms);
    (stages ? stages_cpu_ms : record ? items_cpu_ms : off_cpu_ms).push_back(now_cpu_ms - cpu_ms);
    if (!record) return;
    const TimePoint copy = Now();
    benchmark::DoNotOptimize(RecordFrame(scene, *frame.profile, frame_number, ticks));
    copy_ms.push_back(double(ElapsedNs(copy)) * 1e-6);
  };
  Digest digest;
  for (; frame_number < kWarmFrames; ++frame_number) {
    run(frame_number % 2 == 0);
    digest.Add64(scene.DigestFrame());
  }
  for (auto* list :
       {&off_ms, &items_ms, &stages_ms, &off_cpu_ms, &items_cpu_ms, &stages_cpu_ms, &copy_ms})
    list->clear();
  for (auto _ : state) {
    const bool swapped = frame_number % 4 >= 2;
    for (const bool record : {swapped, !swapped}) {
      run(record);
      ++frame_number;
    }
    const double sum_ms = off_ms.back() + (recorded % 2 ? items_ms : stages_ms).back();
    state.SetIterationTime(sum_ms * 1e-3);
  }
  const auto ratios = [&](const char* suffix, auto& off, auto& items, auto& stages) {
    const double base = SpreadOf(off).median;
    const double with_items = SpreadOf(items).median / base,
                 with_stages = SpreadOf(stages).median / base;
    state.counters[fmt::format("items{}", suffix)] = with_items;
    state.counters[fmt::format("stages{}", suffix)] = with_stages;
    // Recording::kTrace: stages in every fourth frame.
    state.counters[fmt::format("ratio{}", suffix)] = 0.75 * with_items + 0.25 * with_stages;
  };
  state.counters["off_ms"] = SpreadOf(off_ms).median;
  ratios("", off_ms, items_ms, stages_ms);
  if (!workers) ratios("_cpu", off_cpu_ms, items_cpu_ms, stages_cpu_ms);
  state.counters["copy_ms"] = SpreadOf(copy_ms).median;
  state.SetLabel(fmt::format("{} digest of {} frames {:016x}", IsaName(BestIsa()), kWarmFrames,
                             digest.Value()));
}

void RegisterAll() {
  for (const auto& [executor, workers] : {std::pair{"serial", 0u}, std::pair{"tbb2", 2u}})
    benchmark::RegisterBenchmark(
        fmt::format("trace/{}/monster", executor).c_str(),
        [workers = workers](benchmark::State& s) { RunPairs(s, "monster", workers); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(kPairs);
}

}  // namespace
}  // namespace pelt

int main(int argc, char** argv) { return pelt::RunBenchmarks(argc, argv, pelt::RegisterAll); }
