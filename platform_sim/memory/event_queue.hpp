// What happens when, in whole cycles: the clock of the memory and frame models.
//
// Actions of one time run in the order in which they were asked for, so a run has one result. An
// action may ask for more; none may ask for the past.
#pragma once

#include <cassert>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace pelt {

using Cycles = int64_t;
using Action = std::function<void()>;

class EventQueue {
 public:
  Cycles now() const { return now_; }

  void At(Cycles time, Action action) {
    assert(time >= now_);
    events_.push({time, asked_++, std::move(action)});
  }
  void After(Cycles cycles, Action action) { At(now_ + cycles, std::move(action)); }

  // Until nothing is left to happen.
  void Run() {
    while (!events_.empty()) {
      Event event = std::move(const_cast<Event&>(events_.top()));
      events_.pop();
      now_ = event.time;
      event.action();
    }
  }

 private:
  struct Event {
    Cycles time;
    uint64_t order;
    Action action;
    bool operator<(const Event& other) const {
      return time != other.time ? time > other.time : order > other.order;
    }
  };

  std::priority_queue<Event> events_;
  Cycles now_ = 0;
  uint64_t asked_ = 0;
};

}  // namespace pelt
