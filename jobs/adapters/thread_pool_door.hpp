// The door on threads of its own: what a program without a job system uses, and the plainest
// example of a door.
//
//   ThreadPoolDoor pool(4);                 // this thread and three more
//   DoorExecutor executor(pool.door());
#pragma once

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "jobs/adapters/task_queue.hpp"
#include "jobs/spin_wait.hpp"

namespace pelt {

// Whether `worker_count` threads are really there: every one of them has to arrive while the others
// wait. Each calls Arrive once.
class Rendezvous {
 public:
  explicit Rendezvous(uint32_t worker_count,
                      std::chrono::milliseconds limit = std::chrono::seconds(10))
      : worker_count_(worker_count), deadline_(std::chrono::steady_clock::now() + limit) {}

  void Arrive() {
    arrived_.fetch_add(1);
    while (arrived_.load() < worker_count_ && std::chrono::steady_clock::now() < deadline_)
      std::this_thread::yield();
    // The first to leave knows how many were inside; later arrivals came alone.
    uint32_t none = 0;
    together_.compare_exchange_strong(none, arrived_.load());
  }
  uint32_t Together() const { return together_.load(); }

 private:
  uint32_t worker_count_;
  std::chrono::steady_clock::time_point deadline_;
  std::atomic<uint32_t> arrived_{0}, together_{0};
};

class ThreadPoolDoor {
 public:
  // `workers` counts the thread that runs frames: workers - 1 threads are started.
  explicit ThreadPoolDoor(uint32_t workers) {
    for (uint32_t w = 1; w < workers; ++w) threads_.emplace_back([this] { queue_.Serve(); });
  }
  ~ThreadPoolDoor() {
    queue_.Close();
    for (std::thread& thread : threads_) thread.join();
  }

  EngineDoor door() {
    return {&TaskQueue::Enqueue, &TaskQueue::Finish, &queue_, uint32_t(threads_.size()) + 1};
  }

  // Threads that ran tasks at one time, the caller's included.
  uint32_t ObservedWorkers() {
    Rendezvous rendezvous(uint32_t(threads_.size()) + 1);
    const auto arrive = [](void* context) { static_cast<Rendezvous*>(context)->Arrive(); };
    std::vector<void*> handles;
    for (size_t t = 0; t < threads_.size(); ++t)
      handles.push_back(TaskQueue::Enqueue(arrive, &rendezvous, &queue_, "rendezvous"));
    rendezvous.Arrive();
    for (void* handle : handles) TaskQueue::Finish(handle, &queue_);
    return rendezvous.Together();
  }

 private:
  TaskQueue queue_;
  std::vector<std::thread> threads_;
};

}  // namespace pelt
