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
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace pelt {

// Something to do later, once: a callable that is moved, not copied.
//
// Idea: what a memory model asks for are closures of a few words, millions of them. They lie inside
// the action itself; only larger ones, or ones that may throw when moved, are put on the heap.

class Action {
 public:
  Action() = default;
  template <class F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, Action> &&
           std::is_invocable_v<std::remove_cvref_t<F>&>)
      Action(F&& f) {  // NOLINT: a closure is an action
    using Callable = std::remove_cvref_t<F>;
    if constexpr (kLiesInside<Callable>) {
      new (place_) Callable(std::forward<F>(f));
      kind_ = &kInside<Callable>;
    } else {
      new (place_) Callable*(new Callable(std::forward<F>(f)));
      kind_ = &kOnHeap<Callable>;
    }
  }
  Action(Action&& other) noexcept { Take(other); }
  Action& operator=(Action&& other) noexcept {
    if (this == &other) return *this;
    Clear();
    Take(other);
    return *this;
  }
  ~Action() { Clear(); }

  explicit operator bool() const { return kind_ != nullptr; }
  void operator()() { kind_->run(place_); }

 private:
  struct Kind {
    void (*run)(std::byte* place);
    void (*move)(std::byte* from, std::byte* to);  // and end what is at `from`
    void (*end)(std::byte* place);
  };
  static constexpr size_t kPlaceBytes = 48;

  template <class F>
  static constexpr bool kLiesInside =
      sizeof(F) <= kPlaceBytes &&
      alignof(F) <= alignof(std::max_align_t) && std::is_nothrow_move_constructible_v<F>;
  template <class F>
  static F& At(std::byte* place) {
    return *std::launder(reinterpret_cast<F*>(place));
  }
  template <class F>
  static constexpr Kind kInside = {[](std::byte* place) { At<F>(place)(); },
                                   [](std::byte* from, std::byte* to) {
                                     new (to) F(std::move(At<F>(from)));
                                     At<F>(from).~F();
                                   },
                                   [](std::byte* place) { At<F>(place).~F(); }};
  template <class F>
  static constexpr Kind kOnHeap = {
      [](std::byte* place) { (*At<F*>(place))(); },
      [](std::byte* from, std::byte* to) { new (to) F*(At<F*>(from)); },
      [](std::byte* place) { delete At<F*>(place); }};

  void Take(Action& other) {
    kind_ = std::exchange(other.kind_, nullptr);
    if (kind_) kind_->move(other.place_, place_);
  }
  void Clear() {
    if (kind_) std::exchange(kind_, nullptr)->end(place_);
  }

  const Kind* kind_ = nullptr;
  alignas(std::max_align_t) std::byte place_[kPlaceBytes];
};

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
