// The pull interface on threads of its own: every thread polls TryRun while a frame is open and
// sleeps between frames. Shows what a polling engine does, and is an executor for tests.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/pull_executor.hpp"
#include "jobs/spin_wait.hpp"

namespace pelt {

class PullPool final : public Executor {
 public:
  // `workers` counts the thread that calls Run: workers - 1 threads are started.
  explicit PullPool(uint32_t workers) : pull_(workers) {
    for (uint32_t w = 1; w < workers; ++w) threads_.emplace_back([this, w] { Poll(w); });
  }
  ~PullPool() override {
    stop_.store(true);
    Wake();
    for (std::thread& thread : threads_) thread.join();
  }

  // Threads that were awake at one time, the caller's included.
  uint32_t ObservedWorkers() {
    Rendezvous rendezvous(uint32_t(threads_.size()) + 1);
    meeting_.store(&rendezvous);
    meeting_round_.store(round_.load() + 1);
    Wake();
    rendezvous.Arrive();
    // No thread may still be looking at it when it goes.
    while (met_.load() != threads_.size()) std::this_thread::yield();
    met_.store(0);
    return rendezvous.Together();
  }

 private:
  void RunPasses(const Frame& frame) override {
    // Threads that wake before the frame is open poll in vain until it is.
    frame_open_.store(true, std::memory_order_relaxed);
    Wake();
    pull_.Run(frame);
    frame_open_.store(false, std::memory_order_relaxed);
  }

  void Wake() {
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
  }
  void Poll(uint32_t worker) {
    for (uint32_t seen = 0; !stop_.load(std::memory_order_relaxed);) {
      round_.wait(seen, std::memory_order_acquire);
      seen = round_.load(std::memory_order_acquire);
      if (seen == meeting_round_.load()) {
        meeting_.load()->Arrive();
        met_.fetch_add(1);
      }
      SpinWait wait;
      while (frame_open_.load(std::memory_order_relaxed))
        wait.After(pull_.TryRun(worker) == PullResult::kRan);
    }
  }

  PullExecutor pull_;
  std::atomic<uint32_t> round_{0};
  std::atomic<bool> frame_open_{false}, stop_{false};
  std::atomic<Rendezvous*> meeting_{nullptr};
  std::atomic<uint32_t> meeting_round_{0}, met_{0};
  std::vector<std::thread> threads_;
};

}  // namespace pelt
