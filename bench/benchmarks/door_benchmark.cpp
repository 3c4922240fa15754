// What the door costs.
//
//   door/task      ns that DoorExecutor adds to a task, over the door's own enqueue and finish of a
//                  task that does nothing (target: at most 300)
//   door/item      ns that the scheduler adds to an item
//   tbb/monster    TbbExecutor over a hand-written tbb::parallel_for of the same passes (target: a
//                  ratio of at most 1.05)
//   door/monster   DoorExecutor on the same oneTBB arena over the same hand-written loop
//
// What is compared runs in turn within one benchmark, slice by slice, and medians are taken: other
// work on the machine then hits both. Every figure comes with the digest of what was computed.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "bench/benchmarks/benchmark_main.hpp"
#include "bench/report/budget.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "jobs/adapters/tbb_door.hpp"
#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/engine_door.hpp"
#include "jobs/pass_loop.hpp"
#include "jobs/tbb_executor.hpp"

namespace pelt {
namespace {

// A plan of one pass whose items do nothing: what is left is scheduling.
class NothingFrame {
 public:
  explicit NothingFrame(uint32_t items) {
    shape_.AddLayer(0, 0, items);
    memory_.shape = &shape_;
    plan_.stages.push_back({{"nothing", nullptr, {}, 0, nullptr}, nullptr, Domain::kChunk});
    plan_.passes.push_back({0, 0, Domain::kChunk, {}, 0, 0, 0, false, {}});  // no stage
    plan_.waits_of_end = {{0, Domain::kScene}};
    plan_.graph = BuildGraph(plan_, shape_);
  }
  Frame frame() const { return {&plan_, &memory_}; }

 private:
  SceneShape shape_;
  FrameMemory memory_{};
  Plan plan_;
};

// Tasks run where they are finished, so that every cost is on this thread: nothing overlaps, and
// nothing is hidden behind a wake-up.
EngineDoor LateDoor() {
  struct Given {
    PeltTask task;
    void* context;
  };
  static std::vector<Given> given(1 << 16);
  static size_t next = 0;
  const auto enqueue = [](PeltTask task, void* context, void*, const char*) -> void* {
    Given& g = given[next++ % given.size()];
    g = {task, context};
    return &g;
  };
  const auto finish = [](void* handle, void*) {
    const Given& g = *static_cast<Given*>(handle);
    g.task(g.context);
  };
  return {enqueue, finish, nullptr, 64};
}

void DoorTask(benchmark::State& state, const EngineDoor& engine) {
  constexpr uint32_t kFrames = 200;
  // As many items as there are workers: every task is asked for.
  NothingFrame frames(engine.worker_count);
  DoorExecutor executor(engine);
  SerialExecutor serial;
  std::vector<double> added, bare;
  std::vector<void*> handles;
  for (auto _ : state) {
    const TimePoint start = Now();
    for (uint32_t f = 0; f < kFrames; ++f) serial.Run(frames.frame());
    const double items_ns = double(ElapsedNs(start));
    const uint64_t before = executor.TasksEnqueued();
    const TimePoint through = Now();
    for (uint32_t f = 0; f < kFrames; ++f) executor.Run(frames.frame());
    const double door_ns = double(ElapsedNs(through));
    const uint64_t tasks = executor.TasksEnqueued() - before;
    const TimePoint alone = Now();
    for (uint64_t done = 0; done < tasks;) {
      handles.clear();
      for (uint32_t w = 1; w < engine.worker_count && done < tasks; ++w, ++done)
        handles.push_back(engine.enqueue([](void*) {}, nullptr, engine.user, "nothing"));
      for (void* handle : handles)
        if (handle) engine.finish(handle, engine.user);
    }
    const double bare_ns = double(ElapsedNs(alone));
    if (tasks == 0) continue;
    added.push_back((door_ns - items_ns - bare_ns) / double(tasks));
    bare.push_back(bare_ns / double(tasks));
    state.SetIterationTime((items_ns + door_ns + bare_ns) * 1e-9);
  }
  if (added.empty()) return state.SkipWithError("no task was asked for");
  state.counters["added_ns_per_task"] = SpreadOf(added).median;
  state.counters["own_ns_per_task"] = SpreadOf(bare).median;
  if (executor.faults().Any()) state.SkipWithError(executor.faults().Text().c_str());
}

void DoorItem(benchmark::State& state) {
  constexpr uint32_t kItems = 10'000;
  NothingFrame frames(kItems);
  PullExecutor pull;
  SerialExecutor serial;
  std::vector<double> added;
  for (auto _ : state) {
    const TimePoint start = Now();
    serial.Run(frames.frame());
    const double serial_ns = double(ElapsedNs(start));
    const TimePoint through = Now();
    pull.Run(frames.frame());
    const double pull_ns = double(ElapsedNs(through));
    added.push_back((pull_ns - serial_ns) / kItems);
    state.SetIterationTime((serial_ns + pull_ns) * 1e-9);
  }
  state.counters["added_ns_per_item"] = SpreadOf(added).median;
}

// What a programmer would write who has only oneTBB and RunItem.
class HandWritten final : public Executor {
 public:
  explicit HandWritten(tbb::task_arena& arena) : arena_(arena) {}
  void RunPasses(const Frame& frame) override {
    arena_.execute([&] {
      ForEachPass(frame, [&](uint32_t pass, uint32_t count) {
        tbb::parallel_for(0u, count, [&](uint32_t item) { RunItem(frame, pass, item); });
      });
    });
  }

 private:
  tbb::task_arena& arena_;
};

class DoorOnTbb final : public Executor {
 public:
  DoorOnTbb(tbb::task_arena& arena, uint32_t workers)
      : arena_(arena), tasks_(workers), executor_(tasks_.door()) {}
  ~DoorOnTbb() noexcept override {}  // a task group may throw when it goes
  void RunPasses(const Frame& frame) override {
    arena_.execute([&] { executor_.Run(frame); });
  }

 private:
  tbb::task_arena& arena_;
  TbbDoor tasks_;
  DoorExecutor executor_;
};

// Both run the same frames of scenes of their own, a slice each in turn.
void CompareOnMonster(benchmark::State& state, bool door) {
  constexpr uint32_t kSlice = 10;
  const uint32_t workers = std::max(2u, std::thread::hardware_concurrency());
  static Scenario& scenario = *new Scenario(LoadScenario("monster"));
  TbbExecutor tbb(workers);  // also holds oneTBB's limit on threads
  if (tbb.ObservedWorkers() != workers)
    return state.SkipWithError("oneTBB gave fewer workers than asked for");
  tbb::task_arena arena{int(workers)};
  HandWritten by_hand(arena);
  DoorOnTbb through_door(arena, workers);
  Executor& ours = door ? static_cast<Executor&>(through_door) : tbb;
  RunningScenario ours_run(scenario, {}), hand_run(scenario, {});
  uint32_t frame = 0;
  std::vector<double> ratio, ours_ms, hand_ms;
  const auto slice = [&](RunningScenario& run, Executor& executor) {
    double ns = 0.0;
    for (uint32_t f = 0; f < kSlice; ++f) {
      run.Begin(frame + f);
      const TimePoint start = Now();
      executor.Run(run.scene().CurrentFrame());
      ns += double(ElapsedNs(start));
    }
    return ns * 1e-6 / kSlice;
  };
  for (auto _ : state) {
    double ours_now, hand_now;
    if (frame / kSlice % 2) {
      ours_now = slice(ours_run, ours);
      hand_now = slice(hand_run, by_hand);
    } else {
      hand_now = slice(hand_run, by_hand);
      ours_now = slice(ours_run, ours);
    }
    frame += kSlice;
    ours_ms.push_back(ours_now);
    hand_ms.push_back(hand_now);
    ratio.push_back(ours_now / hand_now);
    state.SetIterationTime((ours_now + hand_now) * kSlice * 1e-3);
  }
  const uint64_t digest = ours_run.scene().DigestFrame();
  if (digest != hand_run.scene().DigestFrame()) return state.SkipWithError("digests differ");
  state.counters["ms"] = SpreadOf(ours_ms).median;
  state.counters["by_hand_ms"] = SpreadOf(hand_ms).median;
  state.counters["ratio"] = SpreadOf(ratio).median;
  state.SetLabel(fmt::format("{} workers, digest {:016x}", workers, digest));
}

void RegisterAll() {
  const auto add = [](const char* name, auto run, int iterations) {
    benchmark::RegisterBenchmark(name, run)->UseManualTime()->Iterations(iterations);
  };
  add(
      "door/task/late", [](benchmark::State& s) { DoorTask(s, LateDoor()); }, 101);
  add(
      "door/task/threads",
      [](benchmark::State& s) {
        ThreadPoolDoor pool(std::max(2u, std::thread::hardware_concurrency()));
        DoorTask(s, pool.door());
      },
      101);
  add("door/item", DoorItem, 101);
  add(
      "tbb/monster", [](benchmark::State& s) { CompareOnMonster(s, false); }, 101);
  add(
      "door/monster", [](benchmark::State& s) { CompareOnMonster(s, true); }, 101);
}

}  // namespace
}  // namespace pelt

int main(int argc, char** argv) { return pelt::RunBenchmarks(argc, argv, pelt::RegisterAll); }
