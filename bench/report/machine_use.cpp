#include "bench/report/machine_use.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

namespace pelt {
namespace {

// Of the workers' time; a system that does nothing else stays far below it.
constexpr double kWaitedShare = 0.02;
// Where waiting is not counted: in a second.
constexpr double kPreemptionsPerSecond = 20.0;

std::string Cores(uint32_t count) { return fmt::format("{} core{}", count, count == 1 ? "" : "s"); }

uint64_t NowNs() {
  return uint64_t(std::chrono::duration_cast<std::chrono::nanoseconds>(
                      std::chrono::steady_clock::now().time_since_epoch())
                      .count());
}

uint32_t CountAllowedCores() {
  cpu_set_t mask;
  CPU_ZERO(&mask);
  if (sched_getaffinity(0, sizeof mask, &mask) == 0) return uint32_t(CPU_COUNT(&mask));
  return std::max(1u, std::thread::hardware_concurrency());  // more cores than a mask has
}

uint64_t CountPreemptions() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return uint64_t(usage.ru_nivcsw);
}

// A thread's line: ns on a core, ns ready without one, times that it got one.
std::optional<double> WaitedMs() {
  namespace fs = std::filesystem;
  std::error_code error;
  std::optional<double> waited;
  for (fs::directory_iterator at("/proc/self/task", error), end; !error && at != end;
       at.increment(error)) {
    std::ifstream file(at->path() / "schedstat");
    uint64_t ran_ns = 0, waited_ns = 0;
    if (file >> ran_ns >> waited_ns) waited = waited.value_or(0.0) + double(waited_ns) * 1e-6;
  }
  return waited;
}

MachineUse ReadUse() {
  MachineUse use;
  use.cores_allowed = CountAllowedCores();
  if (double load = 0.0; getloadavg(&load, 1) == 1) use.load_average = load;
  use.wait = ReadCoreWait();
  return use;
}

}  // namespace

CoreWait ReadCoreWait() { return {CountPreemptions(), WaitedMs()}; }

CoreWait CoreWait::Since(const CoreWait& before) const {
  CoreWait since{preemptions - before.preemptions, waited_ms};
  // A thread that ended takes its time along.
  if (waited_ms) since.waited_ms = std::max(0.0, *waited_ms - before.waited_ms.value_or(0.0));
  return since;
}

bool IsDisturbed(const CoreWait& wait, double wall_ms, uint32_t threads) {
  if (wait.waited_ms) return *wait.waited_ms > kWaitedShare * wall_ms * threads;
  return double(wait.preemptions) > kPreemptionsPerSecond * wall_ms * 1e-3;
}

MachineUseWatch::MachineUseWatch() : begin_(ReadUse()), begin_ns_(NowNs()) {}

MachineUse MachineUseWatch::Finish() const {
  MachineUse use = ReadUse();
  use.load_average = begin_.load_average;  // afterwards the run is in it
  use.wait = use.wait.Since(begin_.wait);
  use.wall_ms = double(NowNs() - begin_ns_) * 1e-6;
  return use;
}

uint32_t Threads(const MachineUse& use, uint32_t workers) {
  return std::max(1u, std::min(workers, use.cores_allowed));
}

std::vector<std::string> FindDisturbances(const MachineUse& use, uint32_t workers) {
  std::vector<std::string> found;
  const uint32_t threads = Threads(use, workers);
  if (workers > use.cores_allowed)
    found.push_back(fmt::format("{} workers had {}: wall times are not those of {} workers",
                                workers, Cores(use.cores_allowed), workers));
  if (IsDisturbed(use.wait, use.wall_ms, threads))
    found.push_back(
        use.wait.waited_ms
            ? fmt::format("threads were ready for {:.0f} ms without a core, of {:.0f} ms on {}; {} "
                          "preemptions",
                          *use.wait.waited_ms, use.wall_ms, Cores(threads), use.wait.preemptions)
            : fmt::format("{} preemptions in {:.0f} ms", use.wait.preemptions, use.wall_ms));
  // Of the minute before: a build that ended, or an earlier run of ours. Counted waiting is of the run itself.
  if (!use.wait.waited_ms && use.load_average &&
      *use.load_average + workers > use.cores_allowed + 0.5)
    found.push_back(fmt::format(
        "load average {:.2f} before the run: with its {} workers more than {} can run at once",
        *use.load_average, workers, Cores(use.cores_allowed)));
  return found;
}

void AddMachineUse(const MachineUse& use, uint32_t workers, ReportTree& tree) {
  ReportTree& section = tree.AddSection("machine_use");
  section.Add({"cores_allowed"}, use.cores_allowed);
  section.Add({"load_average", "", 2}, use.load_average ? Value(*use.load_average) : Value());
  section.Add({"preemptions"}, use.wait.preemptions);
  section.Add({"waited_ms", "ms", 1, "waited for a core"},
              use.wait.waited_ms ? Value(*use.wait.waited_ms) : Value());
  section.Add({"wall_ms", "ms", 0, "of"}, use.wall_ms);
  section.EndLine();
  section.AddTexts("disturbances", FindDisturbances(use, workers), "NOT THE RUN'S OWN MACHINE");
}

}  // namespace pelt
