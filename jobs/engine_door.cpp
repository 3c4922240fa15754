#include "jobs/engine_door.hpp"

#include <algorithm>

#include "core/format.hpp"
#include "jobs/spin_wait.hpp"

namespace pelt {
namespace {

constexpr uint32_t kMostWorkers = 4096;

// Says whether the engine's function returned. An exception out of it would leave the frame half
// run and its tasks with the engine. (Where Pelt is built without exceptions, none may come.)
bool Returns(auto&& call) {
#if defined(__cpp_exceptions)
  try {
    call();
  } catch (...) {
    return false;
  }
#else
  call();
#endif
  return true;
}

}  // namespace

const char* FindDoorFault(const EngineDoor& door) {
  if (!door.enqueue || !door.finish) return "enqueue and finish must both be given";
  if (door.worker_count == 0 || door.worker_count > kMostWorkers)
    return "worker_count is the number of threads that run tasks, the caller's included (1 to "
           "4096)";
  return nullptr;
}

bool DoorFaults::Any() const {
  return unusable || started_again || not_returned || threw || run_while_running;
}

std::string DoorFaults::Text() const {
  std::string text;
  const auto add = [&](uint64_t count, const char* what) {
    if (count) text += Format("{} times {}\n", count, what);
  };
  if (unusable) text += Format("the door is not used: {}\n", unusable);
  add(started_again, "a task was called again: each must be called exactly once");
  add(not_returned,
      "finish returned, or enqueue returned null, though the task had not returned: is it still "
      "queued or running, or was it dropped?");
  add(threw, "enqueue or finish threw an exception: none may leave them");
  add(run_while_running, "a frame was run before the last one was done: one at a time");
  return text;
}

// What the engine gets as context. Written by the caller before enqueue and after finish; `started`
// and `returned` by whichever thread runs it.
struct alignas(64) DoorExecutor::Task {
  DoorExecutor* executor = nullptr;
  void* handle = nullptr;
  bool retired = false;  // the engine may still call it: never lent again
  // Atomic because a second call of the task may come while it is lent again.
  std::atomic<uint32_t> worker{0};  // 1 for the first helper: the caller is worker 0
  std::atomic<bool> started{false};
  std::atomic<bool> returned{true};
};

DoorExecutor::DoorExecutor(const EngineDoor& door, uint32_t spare_frames)
    : door_(door),
      pull_(FindDoorFault(door) ? 1 : door.worker_count),
      helper_count_(FindDoorFault(door) ? 0 : door.worker_count - 1),
      task_capacity_(helper_count_ * std::max(1u, spare_frames)) {
  faults_.unusable = FindDoorFault(door);
  tasks_ = std::make_unique<Task[]>(task_capacity_);
  for (uint32_t t = 0; t < task_capacity_; ++t) tasks_[t].executor = this;
}

DoorExecutor::~DoorExecutor() = default;

uint32_t DoorExecutor::MaxTasks(const Plan& plan, const SceneShape& shape) const {
  uint32_t most = 1;  // one item is the caller's
  for (const Pass& pass : plan.passes) most = std::max(most, shape.ItemCount(pass.domain));
  return std::min(helper_count_, most - 1);
}

DoorFaults DoorExecutor::faults() const {
  DoorFaults faults = faults_;
  faults.run_while_running = run_while_running_.load(std::memory_order_relaxed);
  faults.started_again = started_again_.load(std::memory_order_relaxed);
  return faults;
}

void DoorExecutor::RunPasses(const Frame& frame) {
  if (running_.exchange(true, std::memory_order_acquire) || !pull_.Begin(frame)) {
    run_while_running_.fetch_add(1, std::memory_order_relaxed);
    SerialExecutor().Run(frame);
    return;
  }
  const uint32_t helpers = MaxTasks(*frame.plan, *frame.memory->shape);
  // A task that ran in Enqueue may have done all of it.
  for (uint32_t h = 1; h <= helpers && !pull_.IsIdle() && Enqueue(h); ++h) {
  }
  SpinWait wait;
  while (!pull_.IsIdle()) wait.After(pull_.TryRun() == PullResult::kRan);
  FinishTasks();
  running_.store(false, std::memory_order_release);
}

bool DoorExecutor::Enqueue(uint32_t worker) {
  while (tasks_lent_ < task_capacity_ && tasks_[tasks_lent_].retired) ++tasks_lent_;
  if (tasks_lent_ == task_capacity_) return false;
  Task& task = tasks_[tasks_lent_];
  task.started.store(false, std::memory_order_relaxed);
  task.returned.store(false, std::memory_order_relaxed);
  task.worker.store(worker, std::memory_order_relaxed);
  ++tasks_enqueued_;
  task.handle = nullptr;
  if (!Returns([&] { task.handle = door_.enqueue(&RunTask, &task, door_.user, "pelt"); })) {
    ++faults_.threw;
    // Most likely the engine does not have the task. Should it come all the same, it helps, or is called again.
    task.returned.store(true, std::memory_order_relaxed);
    return false;
  }
  if (task.handle) {
    ++tasks_lent_;
  } else {
    CheckReturned(task);
  }
  return true;
}

void DoorExecutor::FinishTasks() {
  for (uint32_t t = 0; t < tasks_lent_; ++t) {
    Task& task = tasks_[t];
    if (!task.handle) continue;
    if (!Returns([&] { door_.finish(task.handle, door_.user); })) ++faults_.threw;
    task.handle = nullptr;
    CheckReturned(task);
  }
  tasks_lent_ = 0;
}

void DoorExecutor::CheckReturned(Task& task) {
  if (task.returned.load(std::memory_order_acquire)) return;
  ++faults_.not_returned;
  task.retired = true;
}

void DoorExecutor::RunTask(void* context) {
  auto& task = *static_cast<Task*>(context);
  if (task.started.exchange(true, std::memory_order_relaxed)) {
    task.executor->started_again_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  task.executor->Help(task.worker.load(std::memory_order_relaxed));
  task.returned.store(true, std::memory_order_release);  // from here on it may be lent again
}

void DoorExecutor::Help(uint32_t worker) {
  SpinWait wait;
  for (PullResult result; (result = pull_.TryRun(worker)) != PullResult::kIdle;)
    wait.After(result == PullResult::kRan);
}

}  // namespace pelt
