// A small model checker: runs every interleaving of a few threads over code that is a template on
// its atomic type, and looks for broken promises in each.
//
// The threads are functions. A thread stops before each operation on a Model atomic; which thread
// goes on is a choice, and Explore takes all of them. What a thread is, between two operations, is
// the list of results that its operations have returned: to go on, it is run again from its start,
// is given those, performs one operation more, and is left by an exception at the next. So a state
// is plain data, and one that was seen before is not gone into again.
//
// Plain memory is checked with vector clocks: two accesses of a Cell, one of them a write, that no
// chain of acquire and release orders are reported as a race, by the rules of the C++ memory model.
// What is not explored: a relaxed or acquire load always sees the newest value, never an older one
// that the model would allow it.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <unordered_set>
#include <vector>

namespace pelt::testing {

class Model {
 public:
  static constexpr uint32_t kMaxThreads = 4;
  using Thread = std::function<void()>;

  // `threads[0]` must come to its end in every interleaving; the others may be left waiting.
  // Returns the first broken promise, or an empty text. `setup` makes the objects under test and
  // returns the threads over them.
  static std::string Explore(const std::function<std::vector<Thread>()>& setup,
                             uint64_t* states = nullptr) {
    Model model;
    current_model = &model;
    model.state_ = {};
    model.bodies_ = setup();
    model.state_.threads.resize(model.bodies_.size());
    for (uint32_t t = 0; t < model.bodies_.size(); ++t) {
      model.state_.threads[t].clock[t] = 1;
      model.Step(t, /*first=*/true);
    }
    const std::string fault = model.Search();
    if (states) *states = model.seen_.size();
    current_model = nullptr;
    return fault;
  }

  // ---- For the code of the threads --------------------------------------------------------------
  // The index of a new atomic, or cell, of this value; in setup only.
  static uint32_t NewAtomic(uint64_t value) {
    auto& atomics = current_model->state_.atomics;
    atomics.push_back({value, {}});
    return uint32_t(atomics.size() - 1);
  }
  static uint32_t NewCell() {
    auto& cells = current_model->state_.cells;
    cells.emplace_back();
    return uint32_t(cells.size() - 1);
  }

  static uint64_t Load(uint32_t at, std::memory_order order) {
    return current_model->Operation([&](State& s, ThreadState& self) {
      if (Acquires(order)) Join(self.clock, s.atomics[at].clock);
      return s.atomics[at].value;
    });
  }
  static void Store(uint32_t at, uint64_t value, std::memory_order order) {
    current_model->Operation([&](State& s, ThreadState& self) {
      s.atomics[at] = {value, Releases(order) ? self.clock : Clock{}};
      current_model->Wrote(order);
      return uint64_t{0};
    });
  }
  // Stores change(the value before); returns that one.
  template <class F>
  static uint64_t FetchModify(uint32_t at, F change, std::memory_order order) {
    return current_model->Operation([&](State& s, ThreadState& self) {
      const uint64_t before = s.atomics[at].value;
      current_model->Modify(s.atomics[at], self, change(before), order);
      return before;
    });
  }
  // Returns the value before: it was exchanged if that is `expected`.
  static uint64_t CompareExchange(uint32_t at, uint64_t expected, uint64_t desired,
                                  std::memory_order success, std::memory_order failure) {
    return current_model->Operation([&](State& s, ThreadState& self) {
      const uint64_t before = s.atomics[at].value;
      if (before == expected) {
        current_model->Modify(s.atomics[at], self, desired, success);
      } else if (Acquires(failure)) {
        Join(self.clock, s.atomics[at].clock);
      }
      return before;
    });
  }
  // A place where other threads may go on, and nothing else.
  static void Pause() {
    current_model->Operation([](State&, ThreadState&) { return uint64_t{0}; });
  }
  // Goes on when another thread has written an atomic since this thread waited last: stands for
  // polling in a loop.
  static void AwaitWrite() {
    Model& model = *current_model;
    if (!model.Replays() && model.performed_) model.self().waits = true;  // it is left here
    model.Operation([](State&, ThreadState&) { return uint64_t{0}; });
  }

  // A loop that remembers nothing from one round to the next:
  //   for (const size_t start = Model::LoopStart();;) { ...; Model::Repeat(start, after_write); }
  // Forgets the round's results, so that any number of fruitless rounds is one state. The next
  // round begins at once, or after another thread has written an atomic since this one began.
  static size_t LoopStart() { return current_model->replayed_; }
  [[noreturn]] static void Repeat(size_t start, bool after_write) {
    ThreadState& self = current_model->self();
    self.results.resize(start);
    self.waits = after_write && !self.changed;
    self.changed = false;
    throw Repeated{};
  }

  // Plain memory.
  static uint64_t Read(uint32_t cell) {
    return current_model->Local([&](State& s, ThreadState& self) {
      Cell& c = s.cells[cell];
      if (c.written > self.clock[c.writer]) current_model->Fail("a race: a read beside a write");
      c.read[current_model->running_] = self.clock[current_model->running_];
      return c.value;
    });
  }
  static void Write(uint32_t cell, uint64_t value) {
    current_model->Local([&](State& s, ThreadState& self) {
      Cell& c = s.cells[cell];
      if (c.written > self.clock[c.writer]) current_model->Fail("a race: two writes");
      for (uint32_t t = 0; t < kMaxThreads; ++t)
        if (c.read[t] > self.clock[t]) current_model->Fail("a race: a write beside a read");
      c.writer = current_model->running_;
      c.written = self.clock[c.writer];
      c.value = value;
      return uint64_t{0};
    });
  }
  static void Check(bool holds, const char* otherwise) {
    current_model->Local([&](State&, ThreadState&) {
      if (!holds) current_model->Fail(otherwise);
      return uint64_t{0};
    });
  }

 private:
  using Clock = std::array<uint16_t, kMaxThreads>;
  struct Atomic {
    uint64_t value;
    Clock clock;  // what an acquiring reader comes to know
  };
  struct Cell {
    uint64_t value = 0;
    uint32_t writer = 0;
    uint16_t written = 0;
    Clock read{};
  };
  struct ThreadState {
    std::vector<uint64_t> results;
    Clock clock{};
    bool waits = false;    // its next operation comes after another thread's write
    bool changed = false;  // somebody wrote since it waited last, or began its present round
    bool ended = false;
  };
  struct State {
    std::vector<Atomic> atomics;
    std::vector<Cell> cells;
    std::vector<ThreadState> threads;
  };
  struct Left {};      // thrown to leave a thread at its next operation
  struct Repeated {};  // thrown at the end of a round

  static bool Acquires(std::memory_order o) {
    return o != std::memory_order_relaxed && o != std::memory_order_release;
  }
  static bool Releases(std::memory_order o) {
    return o == std::memory_order_release || o == std::memory_order_acq_rel ||
           o == std::memory_order_seq_cst;
  }
  static void Join(Clock& clock, const Clock& other) {
    for (uint32_t t = 0; t < kMaxThreads; ++t) clock[t] = std::max(clock[t], other[t]);
  }
  void Modify(Atomic& atomic, ThreadState& self, uint64_t value, std::memory_order order) {
    if (Acquires(order)) Join(self.clock, atomic.clock);
    if (Releases(order)) Join(atomic.clock, self.clock);  // a release sequence goes on
    atomic.value = value;
    Wrote(order);
  }
  void Wrote(std::memory_order order) {
    if (Releases(order)) ++self().clock[running_];  // what comes now is not yet released
    for (uint32_t t = 0; t < state_.threads.size(); ++t)
      if (t != running_) state_.threads[t].changed = true;
  }
  void Fail(const char* what) {
    if (fault_.empty()) fault_ = what;
  }
  ThreadState& self() { return state_.threads[running_]; }

  bool Replays() const { return replayed_ < state_.threads[running_].results.size(); }

  // An operation other threads may see: the one that this step is for, or one that was already.
  template <class F>
  uint64_t Operation(F perform) {
    if (Replays()) return self().results[replayed_++];
    if (performed_) throw Left{};
    performed_ = true;
    ThreadState& thread = self();
    if (thread.waits) thread.waits = thread.changed = false;
    return Record(perform(state_, thread));
  }
  // Something only this thread notices now: goes along with the operation before it.
  template <class F>
  uint64_t Local(F perform) {
    if (Replays()) return self().results[replayed_++];
    return Record(perform(state_, self()));
  }
  uint64_t Record(uint64_t result) {
    self().results.push_back(result);
    ++replayed_;
    return result;
  }

  void Step(uint32_t thread, bool first = false) {
    running_ = thread;
    performed_ = first;
    for (bool again = true; again;) {
      again = false;
      replayed_ = 0;
      try {
        bodies_[thread]();
        self().ended = true;
      } catch (Left) {
      } catch (Repeated) {
        again = true;
      }
    }
  }

  bool IsReady(const ThreadState& t) const { return !t.ended && (!t.waits || t.changed); }

  std::string Search() {
    std::vector<State> open{state_};
    while (!open.empty() && fault_.empty()) {
      const State from = std::move(open.back());
      open.pop_back();
      bool any = false;
      for (uint32_t t = 0; t < from.threads.size(); ++t) {
        if (!IsReady(from.threads[t])) continue;
        any = true;
        state_ = from;
        Step(t);
        if (!fault_.empty()) return fault_;
        if (seen_.insert(Key(state_)).second) open.push_back(state_);
      }
      if (!any && !from.threads[0].ended) return "it never ends: every thread waits";
    }
    return fault_;
  }

  static std::string Key(const State& s) {
    std::string key;
    const auto add = [&](const auto& value) {
      key.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (const Atomic& a : s.atomics) add(a.value), add(a.clock);
    for (const Cell& c : s.cells) add(c.value), add(c.writer), add(c.written), add(c.read);
    for (const ThreadState& t : s.threads) {
      add(uint32_t(t.results.size()));
      for (const uint64_t r : t.results) add(r);
      add(t.clock), add(t.waits), add(t.changed), add(t.ended);
    }
    return key;
  }

  static inline Model* current_model = nullptr;

  State state_;
  std::vector<Thread> bodies_;
  std::unordered_set<std::string> seen_;
  std::string fault_;
  uint32_t running_ = 0;
  size_t replayed_ = 0;
  bool performed_ = false;
};

// Stands in for std::atomic.
template <class T>
class ModelAtomic {
 public:
  explicit ModelAtomic(T value = {}) : at_(Model::NewAtomic(uint64_t(value))) {}
  T load(std::memory_order order) const { return T(Model::Load(at_, order)); }
  void store(T value, std::memory_order order) { Model::Store(at_, uint64_t(value), order); }
  T fetch_sub(T value, std::memory_order order) {
    return T(Model::FetchModify(
        at_, [&](uint64_t v) { return uint64_t(T(v) - value); }, order));
  }
  T fetch_and(T value, std::memory_order order) {
    return T(Model::FetchModify(
        at_, [&](uint64_t v) { return v & value; }, order));
  }
  T fetch_or(T value, std::memory_order order) {
    return T(Model::FetchModify(
        at_, [&](uint64_t v) { return v | value; }, order));
  }
  bool compare_exchange_strong(T& expected, T desired, std::memory_order success,
                               std::memory_order failure) {
    const T before =
        T(Model::CompareExchange(at_, uint64_t(expected), uint64_t(desired), success, failure));
    const bool exchanged = before == expected;
    expected = before;
    return exchanged;
  }

 private:
  uint32_t at_;
};

}  // namespace pelt::testing
