#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <thread>

#include "bench/command/commands.hpp"
#include "bench/report/report_tree.hpp"
#include "jobs/adapters/tbb_door.hpp"
#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/conformance.hpp"

namespace pelt {
namespace {

ConformanceReport CheckThreadPool(uint32_t workers) {
  ThreadPoolDoor pool(workers);
  return CheckDoor(pool.door());
}

ConformanceReport CheckOneTbb(uint32_t workers) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, workers);
  tbb::task_arena arena{int(workers)};
  TbbDoor tasks(workers);
  ConformanceOptions options;
  options.enter = [&](const auto& body) { arena.execute(body); };
  return CheckDoor(tasks.door(), options);
}

// The smallest door there is.
ConformanceReport CheckInline(uint32_t workers) {
  const auto enqueue = [](PeltTask task, void* context, void*, const char*) -> void* {
    task(context);
    return nullptr;
  };
  return CheckDoor({enqueue, [](void*, void*) {}, nullptr, workers});
}

struct BuiltInDoor {
  std::string_view name;
  ConformanceReport (*check)(uint32_t workers);
};
constexpr BuiltInDoor kDoors[] = {
    {"threads", CheckThreadPool}, {"tbb", CheckOneTbb}, {"inline", CheckInline}};

void AddReport(std::string_view door, uint32_t workers, const ConformanceReport& report,
               ReportTree& tree) {
  ReportTree& entry = tree.AddEntry({});
  entry.Say(fmt::format("door '{}', {} workers", door, workers));
  entry.Add(InJson("door"), door).Add(InJson("conforms"), report.Passed());
  ReportTable& checks =
      entry.AddTable("checks", {InText(" "), {"check"}, InJson("passed"), {"detail"}});
  for (const ConformanceCheck& check : report.checks)
    checks.Add({check.passed ? "ok" : "FAIL", check.name, check.passed, check.detail});
  entry.Say(report.Passed() ? "the door conforms"
                            : "the door does not conform: see the lines marked FAIL");
  entry.BlankLine();
}

}  // namespace

std::vector<std::string> ConformanceDoorNames() {
  std::vector<std::string> names;
  for (const BuiltInDoor& door : kDoors) names.emplace_back(door.name);
  return names;
}

ExitCode CheckConformance(const ConformanceArgs& args) {
  const uint32_t workers =
      args.workers ? args.workers : std::max(2u, std::thread::hardware_concurrency());
  bool passed = true;
  ReportTree tree;
  tree.BeginList({});
  for (const BuiltInDoor& door : kDoors) {
    if (!args.door.empty() && args.door != door.name) continue;
    const ConformanceReport report = door.check(workers);
    passed &= report.Passed();
    AddReport(door.name, workers, report, tree);
  }
  tree.Print(args.json);
  return AnswerOf(passed);
}

}  // namespace pelt
