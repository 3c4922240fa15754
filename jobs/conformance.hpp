// Whether an engine's door does what Pelt's side of it relies on: to be included by the engine's
// own tests.
//
//   const ConformanceReport report = CheckDoor(my_door);
//   puts(report.Text().c_str());
//   return report.Passed() ? 0 : 1;
//
// First the door's tasks by themselves, then frames through it under schedules that a game meets
// rarely: tasks finished at once, started out of order, late, on workers that are busy, on many
// more workers than there are threads, one item at a time on changing threads. Every course of
// frames must give the serial executor's digest. Two more checks break the door's promises on
// purpose, in front of the engine, and want the executor to find out.
//
// A check that hangs is given up after a time limit; the thread it hangs on is left behind, and
// with it all that it points to: end the process after a report that says so. Every check runs on a
// thread of its own. This is a test tool: it allocates, starts threads and reads clocks as it
// likes.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "jobs/conformance/frames.hpp"
#include "jobs/conformance/schedules.hpp"
#include "jobs/engine_door.hpp"
#include "jobs/frame.hpp"

namespace pelt {

struct ConformanceCheck {
  std::string name;
  bool passed = true;
  std::string detail;  // why it failed, or what was seen
};

struct ConformanceReport {
  std::vector<ConformanceCheck> checks;
  bool hung = false;  // a check did not return: it is the last one

  bool Passed() const {
    return std::all_of(checks.begin(), checks.end(), [](const auto& c) { return c.passed; });
  }
  const ConformanceCheck* Find(std::string_view name) const {
    for (const ConformanceCheck& check : checks)
      if (check.name == name) return &check;
    return nullptr;
  }
  // One line a check and a verdict.
  std::string Text() const {
    std::string text;
    for (const ConformanceCheck& c : checks)
      text += (c.passed ? "ok    " : "FAIL  ") + c.name +
              std::string(c.name.size() < 15 ? 15 - c.name.size() : 1, ' ') + c.detail + "\n";
    return text + (Passed() ? "the door conforms\n"
                            : "the door does not conform: see the lines marked FAIL\n");
  }
};

// Runs some frames with this executor, always from the same start, and returns the digest of all
// they computed.
using ConformanceCourse = std::function<uint64_t(Executor&)>;

struct ConformanceOptions {
  double limit_s = 20.0;  // for one check
  // Calls a body where the engine's tasks can run, for engines in which that is not every thread
  // (an OpenMP team, an arena).
  std::function<void(const std::function<void()>&)> enter = [](const auto& body) { body(); };
};

namespace conformance {

struct RawTask {
  std::atomic<uint32_t> calls{0};
  uint32_t in = 0, out = 0;
};

// All that a check needs, and all that the engine was given: a check that hangs outlives the
// report, and a faulty engine may call a task when everything is over.
struct Context {
  EngineDoor door;
  ConformanceCourse course;
  ConformanceOptions options;
  uint64_t truth = 0;
  std::deque<RawTask> tasks = {};
  std::vector<std::shared_ptr<void>> kept = {};

  template <class T, class... Arguments>
  T& Keep(Arguments&&... arguments) {
    auto made = std::make_shared<T>(std::forward<Arguments>(arguments)...);
    kept.push_back(made);
    return *made;
  }
};

struct Finding {
  bool passed = true;
  std::string detail;
};

// The door's tasks by themselves: each called once, before finish returns, with its own context,
// seeing what was written before and showing what it wrote.
inline Finding CheckTasks(Context& check) {
  constexpr uint32_t kRounds = 200;
  const uint32_t count = std::clamp(check.door.worker_count, 2u, 65u) - 1;
  const auto run = [](void* context) {
    auto& task = *static_cast<RawTask*>(context);
    task.out = Mix(task.in, 5);
    task.calls.fetch_add(1);
  };
  std::deque<RawTask>& tasks = check.tasks;
  std::vector<void*> handles(count);
  for (uint32_t round = 0; round < kRounds; ++round) {
    const size_t first = tasks.size();
    for (uint32_t t = 0; t < count; ++t) {
      RawTask& task = tasks.emplace_back();
      task.in = round * count + t;
      handles[t] = check.door.enqueue(run, &task, check.door.user, "conformance_task");
      if (!handles[t] && task.calls.load() == 0)
        return {false, "enqueue returned null for a task that had not been called"};
    }
    for (uint32_t t = 0; t < count; ++t) {
      if (handles[t]) check.door.finish(handles[t], check.door.user);
      const RawTask& task = tasks[first + t];
      if (task.calls.load() == 0)
        return {false,
                "finish returned before its task had run (round " + std::to_string(round) + ")"};
      if (task.out != Mix(task.in, 5))
        return {false, "what a task wrote is not there after finish (round " +
                           std::to_string(round) + ")"};
    }
  }
  // A second call comes later than the first; give it a moment.
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  for (const RawTask& task : tasks)
    if (task.calls.load() != 1)
      return {false, "a task was called " + std::to_string(task.calls.load()) + " times"};
  return {true, std::to_string(tasks.size()) + " tasks, each called once"};
}

struct Meeting {
  std::thread::id caller = std::this_thread::get_id();
  std::chrono::steady_clock::time_point deadline =
      std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
  uint32_t wanted = 0;
  std::atomic<uint32_t> arrived{1}, together{0};

  void Wait() {
    while (arrived.load() < wanted && std::chrono::steady_clock::now() < deadline)
      std::this_thread::yield();
    uint32_t none = 0;
    together.compare_exchange_strong(none, arrived.load());
  }
};

// How many workers there really are. Fewer than stated is slow, not wrong.
inline Finding CheckWorkers(Context& check) {
  auto& meeting = check.Keep<Meeting>();
  meeting.wanted = check.door.worker_count;
  const auto meet = [](void* context) {
    auto& m = *static_cast<Meeting*>(context);
    if (std::this_thread::get_id() == m.caller) return;
    m.arrived.fetch_add(1);
    m.Wait();
  };
  std::vector<void*> handles;
  for (uint32_t w = 1; w < check.door.worker_count; ++w)
    handles.push_back(check.door.enqueue(meet, &meeting, check.door.user, "conformance_meeting"));
  meeting.Wait();
  for (void* handle : handles)
    if (handle) check.door.finish(handle, check.door.user);
  return {true, std::to_string(meeting.together.load()) + " of " +
                    std::to_string(check.door.worker_count) + " ran tasks at one time"};
}

inline std::string Hex(uint64_t digest) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(digest));
  return text;
}

inline Finding JudgeDigest(Context& check, uint64_t digest) {
  if (digest == check.truth) return {true, "digest " + Hex(digest)};
  return {false, "digest " + Hex(digest) + ", but " + Hex(check.truth) +
                     " when run serially: a task's writes are not seen, or memory is overwritten"};
}

// Counts frames and the tasks they may enqueue.
class Counted final : public Executor {
 public:
  explicit Counted(DoorExecutor& executor) : executor_(executor) {}
  uint64_t max_tasks = 0;

 private:
  void RunPasses(const Frame& frame) override {
    executor_.Run(frame);
    max_tasks += executor_.MaxTasks(*frame.plan, *frame.memory->shape);
  }

  DoorExecutor& executor_;
};

// The course through a schedule: the serial bits, no faults, not more tasks than stated.
template <class S>
Finding CheckSchedule(Context& check, uint32_t workers) {
  S& schedule = check.Keep<S>(check.door);
  schedule.SetWorkers(workers);
  if constexpr (requires { schedule.SetLimit(1.0); }) schedule.SetLimit(check.options.limit_s / 4);
  auto& executor = check.Keep<DoorExecutor>(schedule.door());
  Counted counted(executor);
  Finding finding = JudgeDigest(check, check.course(counted));
  if (schedule.enqueued() > counted.max_tasks)
    finding = {false, std::to_string(schedule.enqueued()) + " tasks, more than the " +
                          std::to_string(counted.max_tasks) + " stated"};
  if (schedule.Fault()) finding = {false, schedule.Fault()};
  if (executor.faults().Any())
    finding = {false, executor.faults().Text().substr(0, executor.faults().Text().find('\n'))};
  if (finding.passed) finding.detail += ", " + std::to_string(schedule.enqueued()) + " tasks";
  return finding;
}

// The course with a promise of the door broken on purpose: the executor must say so, and the bits
// must be right all the same.
template <class S>
Finding CheckBroken(Context& check, uint64_t DoorFaults::*fault) {
  S& schedule = check.Keep<S>(check.door);
  auto& executor = check.Keep<DoorExecutor>(schedule.door());
  Finding finding = JudgeDigest(check, check.course(executor));
  if (!finding.passed) return finding;
  if (schedule.enqueued() == 0) return {true, "no task was asked for in these frames"};
  if (executor.faults().*fault == 0) return {false, "the executor did not notice"};
  return {true, "noticed " + std::to_string(executor.faults().*fault) + " times"};
}

inline Finding CheckOneItemATask(Context& check) {
  auto& executor = check.Keep<OneItemATask>(check.door);
  return JudgeDigest(check, check.course(executor));
}

struct NamedCheck {
  const char* name;
  const char* if_it_hangs;
  Finding (*run)(Context&);
};

inline constexpr const char* kFinishHangs = "finish, or enqueue, does not return";
inline const NamedCheck kChecks[] = {
    {"tasks", "finish does not return after its task has, or the task is never started",
     CheckTasks},
    {"workers", kFinishHangs, CheckWorkers},
    {"as it is", kFinishHangs, [](Context& check) { return CheckSchedule<Schedule>(check, 0); }},
    {"one worker", kFinishHangs, [](Context& check) { return CheckSchedule<Schedule>(check, 1); }},
    {"many workers", "64 tasks do not fit in, or finish depends on the order",
     [](Context& check) { return CheckSchedule<Schedule>(check, 64); }},
    {"at once", "finish does not return while no other task is there",
     [](Context& check) { return CheckSchedule<FinishedAtOnce>(check, 0); }},
    {"newest first", "finish depends on the order of tasks",
     [](Context& check) { return CheckSchedule<NewestFirst>(check, 0); }},
    {"late start", kFinishHangs, [](Context& check) { return CheckSchedule<LateStart>(check, 0); }},
    {"starved", "with all workers busy something waits for one",
     [](Context& check) { return CheckSchedule<Starved>(check, 0); }},
    {"one item", "tasks are not started, or finish does not return", CheckOneItemATask},
    {"started twice", kFinishHangs,
     [](Context& check) { return CheckBroken<StartedTwice>(check, &DoorFaults::started_again); }},
    {"never run", kFinishHangs,
     [](Context& check) { return CheckBroken<NeverRun>(check, &DoorFaults::not_returned); }},
};

// Null: it did not return in time.
inline std::unique_ptr<Finding> RunWithin(const std::shared_ptr<Context>& context,
                                          const NamedCheck& check) {
  std::promise<Finding> promise;
  auto future = promise.get_future();
  std::thread thread([context, run = check.run, promise = std::move(promise)]() mutable {
    Finding finding;
    context->options.enter([&] {
#if defined(__cpp_exceptions)
      try {
        finding = run(*context);
      } catch (const std::exception& error) {
        finding = {false, error.what()};
      }
#else
      finding = run(*context);
#endif
    });
    promise.set_value(finding);
  });
  if (future.wait_for(std::chrono::duration<double>(context->options.limit_s)) !=
      std::future_status::ready) {
    thread.detach();
    return nullptr;
  }
  thread.join();
  return std::make_unique<Finding>(future.get());
}

}  // namespace conformance

// The names of the checks, in the order they run.
inline std::vector<std::string> ConformanceCheckNames() {
  std::vector<std::string> names;
  for (const conformance::NamedCheck& check : conformance::kChecks) names.emplace_back(check.name);
  return names;
}

// Runs every check on frames of the caller's own.
inline ConformanceReport CheckDoor(const EngineDoor& door, const ConformanceCourse& course,
                                   const ConformanceOptions& options = {}) {
  ConformanceReport report;
  if (const char* fault = FindDoorFault(door)) {
    report.checks.push_back({"door", false, fault});
    return report;
  }
  SerialExecutor serial;
  const auto context = std::make_shared<conformance::Context>(
      conformance::Context{door, course, options, course(serial)});
  for (const conformance::NamedCheck& check : conformance::kChecks) {
    const auto finding = conformance::RunWithin(context, check);
    if (finding) {
      report.checks.push_back({check.name, finding->passed, finding->detail});
    } else {
      report.checks.push_back(
          {check.name, false, "did not return in time: " + std::string(check.if_it_hangs)});
      report.hung = true;
      break;
    }
  }
  if (!report.Passed()) {
    static std::vector<std::shared_ptr<conformance::Context>> kept;
    kept.push_back(context);
  }
  return report;
}

// The same on a small plan made for it: seven passes of 130, 3 or 1 items.
inline ConformanceReport CheckDoor(const EngineDoor& door, const ConformanceOptions& options = {}) {
  return CheckDoor(door, &conformance::SyntheticFrames::Run, options);
}

}  // namespace pelt
