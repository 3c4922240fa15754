#include "bench/verify/executors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/error.hpp"
#include "jobs/adapters/pull_pool.hpp"
#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/engine_door.hpp"
#include "jobs/tbb_executor.hpp"
#include "jobs/verify/guarded_executor.hpp"
#include "platform_sim/local_store.hpp"

namespace pelt {
namespace {

// The door with an engine behind it.
class PooledDoor final : public Executor {
 public:
  explicit PooledDoor(uint32_t workers) : pool_(workers), executor_(pool_.door()) {}
  void RunPasses(const Frame& frame) override { executor_.Run(frame); }
  uint32_t ObservedWorkers() { return pool_.ObservedWorkers(); }
  DoorFaults faults() const { return executor_.faults(); }

 private:
  ThreadPoolDoor pool_;
  DoorExecutor executor_;
};

std::vector<Finding> ListFindings(const GuardedExecutor& guarded) { return guarded.findings(); }
std::vector<Finding> ListFindings(const PooledDoor& door) {
  if (!door.faults().Any()) return {};
  std::string text = "door: " + door.faults().Text();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return {{FindingKind::kExecutor, {}, {}, std::move(text)}};
}
std::vector<Finding> ListFindings(const LocalStoreExecutor& store) {
  std::vector<Finding> findings;
  for (const LocalStoreFault& fault : store.faults())
    findings.push_back(
        {fault.kind == LocalStoreFault::Kind::kWrote ? FindingKind::kUndeclaredWrite
                                                     : FindingKind::kExecutor,
         std::string(fault.stage), std::string(fault.stream),
         fmt::format("local store: stage {}, item {}: {}", fault.stage, fault.item, fault.what)});
  return findings;
}

// What E has to say is taken from what it has.
template <class E>
class Watched final : public WatchedExecutor {
 public:
  explicit Watched(auto... settings) : executor_(settings...) {}

  uint32_t ObservedWorkers() override {
    if constexpr (requires(E & e) { e.ObservedWorkers(); }) return executor_.ObservedWorkers();
    return 1;
  }
  std::vector<Finding> Findings() const override {
    if constexpr (requires(const E& e) { ListFindings(e); }) return ListFindings(executor_);
    return {};
  }
  uint64_t StagesRun() const override {
    if constexpr (requires(const E& e) { e.stages_run(); }) return executor_.stages_run();
    return 0;
  }

 private:
  void RunPasses(const Frame& frame) override { executor_.Run(frame); }

  E executor_;
};

// Of an executor whose constructor takes these settings.
template <class E, auto... kSettings>
std::unique_ptr<WatchedExecutor> Make(const ExecutorSettings& settings) {
  return std::make_unique<Watched<E>>(settings.*kSettings...);
}

using S = ExecutorSettings;
constexpr ExecutorEntry kEntries[] = {
    {"serial", "one item after another", ItemOrder::kAscending, Make<SerialExecutor>},
    {"tbb", "threads of oneTBB", ItemOrder::kThreads, Make<TbbExecutor, &S::workers>},
    {"door", "an engine's jobs, here of a thread pool", ItemOrder::kThreads,
     Make<PooledDoor, &S::workers>},
    {"pull", "threads that poll", ItemOrder::kThreads, Make<PullPool, &S::workers>},
    {"permuted", "one item after another, in any order that its waits allow", ItemOrder::kSeeded,
     Make<PermutedExecutor, &S::order_seed>},
    {.name = "local-store",
     .text = "one item after another, on copies in a console's local store",
     .order = ItemOrder::kAscending,
     .make = Make<LocalStoreExecutor, &S::local_store_data_bytes>,
     .local_store = true},
    {.name = "guarded",
     .text = "each stage between closed pages",
     .order = ItemOrder::kAscending,
     .make = Make<GuardedExecutor>,
     .stages_alone = true,
     .available = GuardedExecutor::IsAvailable},
};

}  // namespace

std::span<const ExecutorEntry> ExecutorEntries() { return kEntries; }

ExecutorKind::ExecutorKind(std::string_view name) {
  const auto* entry = std::ranges::find(kEntries, name, &ExecutorEntry::name);
  if (entry == std::end(kEntries)) throw Error(fmt::format("no executor '{}'", name));
  entry_ = entry;
}

std::vector<std::string> OfferedExecutors(bool (ExecutorEntry::*which)() const) {
  std::vector<std::string> names;
  for (const ExecutorEntry& entry : kEntries)
    if (!entry.stages_alone && (!which || (entry.*which)())) names.emplace_back(entry.name);
  return names;
}

std::vector<std::string> WatchedExecutor::Faults() const {
  std::vector<std::string> texts;
  for (Finding& finding : Findings()) texts.push_back(std::move(finding.text));
  return texts;
}

}  // namespace pelt
