// Tasks in the order they came, for adapters to things that have threads but no tasks of their own
// (thread_pool_door.hpp, bullet_door.hpp). Places for tasks are fixed: with none left a task runs
// where it is enqueued, so nothing allocates and nothing is lost.
//
// Invariant: a task is either in the queue, or taken by exactly one thread; Finish takes it out
// itself if no thread has, so waiting never depends on a thread being free.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>

#include "jobs/engine_door.hpp"

namespace pelt {

class TaskQueue {
 public:
  TaskQueue() {
    for (uint32_t p = 0; p < kPlaces; ++p)
      places_[p].next = p + 1 < kPlaces ? &places_[p + 1] : nullptr;
    free_ = &places_[0];
  }
  TaskQueue(const TaskQueue&) = delete;
  TaskQueue& operator=(const TaskQueue&) = delete;

  // EngineDoor::enqueue and finish, with a TaskQueue as `user`.
  static void* Enqueue(PeltTask task, void* context, void* user, const char*) {
    return static_cast<TaskQueue*>(user)->Add(task, context);
  }
  static void Finish(void* handle, void* user) {
    static_cast<TaskQueue*>(user)->Wait(*static_cast<Place*>(handle));
  }

  // Runs the oldest task; false if there is none.
  bool RunOne() {
    std::unique_lock lock(mutex_);
    if (!first_) return false;
    RunFirst(lock);
    return true;
  }

  // Runs tasks as they come, until Close.
  void Serve() {
    std::unique_lock lock(mutex_);
    for (;;) {
      came_.wait(lock, [&] { return first_ || closed_; });
      if (!first_) return;
      RunFirst(lock);
    }
  }
  void Open() { SetClosed(false); }
  void Close() { SetClosed(true); }

 private:
  static constexpr uint32_t kPlaces = 4096;
  struct Place {
    PeltTask task = nullptr;
    void* context = nullptr;
    Place* next = nullptr;
    bool returned = false;
  };

  void* Add(PeltTask task, void* context) {
    {
      const std::lock_guard lock(mutex_);
      if (Place* place = free_) {
        free_ = place->next;
        *place = {task, context, nullptr, false};
        (first_ ? last_->next : first_) = place;
        last_ = place;
        came_.notify_one();
        return place;
      }
    }
    task(context);
    return nullptr;
  }

  void RunFirst(std::unique_lock<std::mutex>& lock) {
    Place* place = first_;
    first_ = place->next;
    lock.unlock();
    place->task(place->context);
    lock.lock();
    place->returned = true;
    if (waiting_) returned_.notify_all();
  }

  void Wait(Place& place) {
    std::unique_lock lock(mutex_);
    while (!place.returned) {
      if (first_) {
        RunFirst(lock);
      } else {
        ++waiting_;
        returned_.wait(lock);
        --waiting_;
      }
    }
    place.next = free_;
    free_ = &place;
  }

  void SetClosed(bool closed) {
    const std::lock_guard lock(mutex_);
    closed_ = closed;
    came_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable came_, returned_;
  std::unique_ptr<Place[]> places_ = std::make_unique<Place[]>(kPlaces);
  Place *free_ = nullptr, *first_ = nullptr, *last_ = nullptr;
  uint32_t waiting_ = 0;
  bool closed_ = false;
};

}  // namespace pelt
