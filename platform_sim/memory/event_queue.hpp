// What happens when, in whole cycles: the clock of the memory and frame models.
//
// Actions of one time run in the order in which they were asked for, so a run has one result. An
// action may ask for more; none may ask for the past.
//
// Invariant: an action lies in one place from the time it is asked for until it runs; the heap
// orders only times and places.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <utility>
#include <vector>

#include "platform_sim/memory/action.hpp"

namespace pelt {

using Cycles = int64_t;

class EventQueue {
 public:
  Cycles now() const { return now_; }

  void At(Cycles time, Action action) {
    assert(time >= now_);
    events_.push_back({time, asked_++, Keep(std::move(action))});
    std::push_heap(events_.begin(), events_.end(), RunsLater{});
  }
  void After(Cycles cycles, Action action) { At(now_ + cycles, std::move(action)); }

  // Until nothing is left to happen.
  void Run() {
    while (!events_.empty()) {
      std::pop_heap(events_.begin(), events_.end(), RunsLater{});
      const Event event = events_.back();
      events_.pop_back();
      Action action = std::move(actions_[event.place]);
      free_places_.push_back(event.place);
      now_ = event.time;
      action();
    }
  }

 private:
  struct Event {
    Cycles time;
    uint64_t order;
    uint32_t place;  // of its action
  };
  struct RunsLater {
    bool operator()(const Event& a, const Event& b) const {
      return a.time != b.time ? a.time > b.time : a.order > b.order;
    }
  };

  uint32_t Keep(Action action) {
    if (free_places_.empty()) {
      actions_.push_back(std::move(action));
      return uint32_t(actions_.size() - 1);
    }
    const uint32_t place = free_places_.back();
    free_places_.pop_back();
    actions_[place] = std::move(action);
    return place;
  }

  std::vector<Event> events_;  // a heap, the next one first
  std::vector<Action> actions_;
  std::vector<uint32_t> free_places_;
  Cycles now_ = 0;
  uint64_t asked_ = 0;
};

}  // namespace pelt
