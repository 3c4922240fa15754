// Schedules that a game meets rarely, put in front of any engine's door; two of them break the
// door's promises on purpose.
//
// Invariant: a schedule outlives every task it let through, and so do the handles it gave.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <thread>
#include <vector>

#include "jobs/engine_door.hpp"
#include "jobs/frame.hpp"
#include "jobs/pull_executor.hpp"

namespace pelt::conformance {

// Stands in front of the engine's door and changes when, where or whether its tasks run. Only the
// thread that runs the frame calls it. As it is: passes everything on.
class Schedule {
 public:
  explicit Schedule(const EngineDoor& engine) : engine_(engine) {}
  virtual ~Schedule() = default;
  Schedule(const Schedule&) = delete;

  EngineDoor door() {
    const auto enqueue = [](PeltTask task, void* context, void* user, const char* name) {
      auto& schedule = *static_cast<Schedule*>(user);
      ++schedule.enqueued_;
      return schedule.Enqueue({task, context, name});
    };
    const auto finish = [](void* handle, void* user) {
      static_cast<Schedule*>(user)->Finish(handle);
    };
    // With one worker nothing would be enqueued, and nothing checked.
    return {enqueue, finish, this, workers_ ? workers_ : std::max(2u, engine_.worker_count)};
  }
  uint64_t enqueued() const { return enqueued_; }
  // What went wrong in front of the engine; null: nothing.
  virtual const char* Fault() const { return nullptr; }
  void SetWorkers(uint32_t workers) { workers_ = workers; }

 protected:
  struct Held {
    PeltTask task;
    void* context;
    const char* name;
    void* handle = nullptr;
    bool passed_on = false;
  };
  virtual void* Enqueue(const Held& task) { return PassOn(task); }
  virtual void Finish(void* handle) { engine_.finish(handle, engine_.user); }

  void* PassOn(const Held& held) {
    return engine_.enqueue(held.task, held.context, engine_.user, held.name);
  }
  void FinishInEngine(void* handle) {
    if (handle) engine_.finish(handle, engine_.user);
  }
  // Keeps a task back; what is returned may be given as its handle.
  Held* Hold(const Held& task) { return &held_.emplace_back(task); }
  void PassOnHeld(Held& held) {
    if (held.passed_on) return;
    held.passed_on = true;
    held.handle = PassOn(held);
  }

  EngineDoor engine_;

 private:
  std::deque<Held> held_;  // handles point into it
  uint32_t workers_ = 0;
  uint64_t enqueued_ = 0;
};

struct FinishedAtOnce final : Schedule {
  using Schedule::Schedule;
  void* Enqueue(const Held& task) override {
    FinishInEngine(PassOn(task));
    return nullptr;
  }
};

// Of every two tasks the newer goes first.
struct NewestFirst final : Schedule {
  using Schedule::Schedule;
  void* Enqueue(const Held& task) override {
    Held* held = Hold(task);
    if (!kept_) return kept_ = held;
    PassOnHeld(*held);
    PassOnHeld(*kept_);
    kept_ = nullptr;
    return held;
  }
  void Finish(void* handle) override {
    auto& held = *static_cast<Held*>(handle);
    if (&held == kept_) kept_ = nullptr;
    PassOnHeld(held);
    FinishInEngine(held.handle);
  }
  Held* kept_ = nullptr;
};

struct LateStart final : Schedule {
  using Schedule::Schedule;
  void* Enqueue(const Held& task) override { return Hold(task); }
  void Finish(void* handle) override {
    auto& held = *static_cast<Held*>(handle);
    PassOnHeld(held);
    FinishInEngine(held.handle);
  }
};

struct StartedTwice final : Schedule {
  using Schedule::Schedule;
  void* Enqueue(const Held& task) override {
    Held* held = Hold(task);
    FinishInEngine(PassOn(task));
    PassOnHeld(*held);
    return held;
  }
  void Finish(void* handle) override { FinishInEngine(static_cast<Held*>(handle)->handle); }
};

struct NeverRun final : Schedule {
  using Schedule::Schedule;
  void* Enqueue(const Held& task) override { return Hold(task); }
  void Finish(void*) override {}
};

// Other work occupies the engine's workers until the caller has done the frame.
class Starved final : public Schedule {
 public:
  using Schedule::Schedule;
  // Blockers end by themselves after this long; then the caller has waited for them.
  void SetLimit(double limit_s) { limit_ = std::chrono::duration<double>(limit_s); }
  const char* Fault() const override {
    for (const Blockade& blockade : blockades_)
      if (blockade.gave_up.load())
        return "with all workers busy the caller waited for one: does enqueue wait for a worker?";
    return nullptr;
  }

 private:
  struct Blockade {
    std::thread::id caller = std::this_thread::get_id();
    std::chrono::steady_clock::time_point deadline{};
    std::atomic<bool> lifted{false}, gave_up{false};
    std::atomic<uint32_t> inside{0};

    void Block() {
      inside.fetch_add(1);
      // If the caller's own thread waited here, no thread would be left to lift it.
      while (!lifted.load() && std::this_thread::get_id() != caller) {
        if (std::chrono::steady_clock::now() > deadline) gave_up = lifted = true;
        std::this_thread::yield();
      }
    }
  };
  void* Enqueue(const Held& task) override {
    if (!blocked_ && !Fault()) SetUpBlockade();
    return PassOn(task);
  }
  void Finish(void* handle) override {
    if (blocked_) Lift();
    Schedule::Finish(handle);
  }
  void SetUpBlockade() {
    blocked_ = true;
    Blockade& blockade = blockades_.emplace_back();
    blockade.deadline = std::chrono::steady_clock::now() +
                        std::chrono::duration_cast<std::chrono::nanoseconds>(limit_);
    const auto block = [](void* context) { static_cast<Blockade*>(context)->Block(); };
    const uint32_t count = std::max(2u, engine_.worker_count) - 1;
    for (uint32_t b = 0; b < count; ++b)
      blockers_.push_back(
          engine_.enqueue(block, &blockade, engine_.user, "conformance_other_work"));
    const auto enough = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
    while (blockade.inside.load() < count && std::chrono::steady_clock::now() < enough)
      std::this_thread::yield();
  }
  void Lift() {
    blocked_ = false;
    blockades_.back().lifted = true;
    for (void* blocker : blockers_) FinishInEngine(blocker);
    blockers_.clear();
  }

  std::chrono::duration<double> limit_{1.0};
  bool blocked_ = false;
  std::deque<Blockade> blockades_;  // kept: a faulty engine may still be in one
  std::vector<void*> blockers_;
};

// Runs every item as a task of its own: a worker changes its thread with every item, as a fibre
// may.
class OneItemATask final : public Executor {
 public:
  explicit OneItemATask(const EngineDoor& engine) : engine_(engine) {}

 private:
  void RunPasses(const Frame& frame) override {
    if (!pull_.Begin(frame)) return;  // the digest will show it
    const auto run_one = [](void* pull) { static_cast<PullExecutor*>(pull)->TryRun(1); };
    while (!pull_.IsIdle()) {
      for (uint32_t w = 1; w < std::max(2u, engine_.worker_count); ++w)
        handles_.push_back(engine_.enqueue(run_one, &pull_, engine_.user, "conformance_one_item"));
      for (void* handle : handles_)
        if (handle) engine_.finish(handle, engine_.user);
      handles_.clear();
    }
  }

  EngineDoor engine_;
  PullExecutor pull_;
  std::vector<void*> handles_;
};

}  // namespace pelt::conformance
