// Who runs which item, decided by one word: any thread may ask at any time, nobody waits for
// anybody.
//
//   ticket   pass (32 bits) | items of it not yet claimed (32 bits)
//
// A claim is one compare-exchange that takes one from the lower half. Nothing but the ticket is
// read before it succeeds, and what it says is true at the moment it succeeds: a thread that slept
// since an earlier frame holds a stale ticket and fails, or holds one that happens to be true again
// and is welcome. (So there is no frame number in the ticket: it would protect nothing.)
//
//   open ──> claim ... claim ──> last item of the pass done ──> next pass opened ──> ... ──> idle
//
// Whoever finishes the last item of a pass opens the next one that has items; after the last pass
// the scheduler is idle. `unfinished_` is set before the ticket is published, because the first
// claim may be finished before the publisher's next instruction.
//
// Invariants: between a successful claim and its Finish the frame cannot end, so what the passes
// point to may be read then and only then. No thread identity, no thread-local state, no lock, no
// allocation. tests/jobs/pull_model_test.cpp runs all interleavings of small frames over this
// source, which is why the atomic type is a parameter.
#pragma once

#include <atomic>
#include <cstdint>

namespace pelt {

enum class PullResult : uint8_t {
  kRan,           // an item was run
  kNothingReady,  // a frame is open, and all items of its present pass are running elsewhere
  kIdle,          // no frame is open: the last one is done, or none was begun
};

// Passes: what a frame looks like from here.
//   uint32_t Count() const;                 passes
//   uint32_t Items(uint32_t pass) const;    may be 0
//   void OnBegin(uint32_t pass), OnEnd(uint32_t pass);  called once each, in order, for every pass
template <template <class> class Atomic>
class PullScheduler {
 public:
  struct Item {
    uint32_t pass;
    uint32_t unclaimed;  // items of the pass not claimed before this one, itself included: >= 1
  };

  // Takes the scheduler for a new frame; false if one is open. Between this and Open the caller may
  // change what the passes point to: no claim can succeed.
  [[nodiscard]] bool TakeForFrame() {
    uint64_t idle = kIdleTicket;
    return ticket_.compare_exchange_strong(idle, kTakenTicket, std::memory_order_acq_rel,
                                           std::memory_order_acquire);
  }
  // Opens the first pass; only after TakeForFrame.
  template <class Passes>
  void Open(Passes&& passes) {
    OpenFrom(0, passes);
  }

  // Claims an item. kRan: `item` must be run, and then finished.
  PullResult TryClaim(Item& item) {
    uint64_t ticket = ticket_.load(std::memory_order_acquire);
    while (uint32_t(ticket) != 0) {
      if (ticket_.compare_exchange_weak(ticket, ticket - 1, std::memory_order_acquire,
                                        std::memory_order_acquire)) {
        item = {uint32_t(ticket >> 32), uint32_t(ticket)};
        return PullResult::kRan;
      }
    }
    return ticket == kIdleTicket ? PullResult::kIdle : PullResult::kNothingReady;
  }

  // After a claimed item was run. The caller may not touch the frame afterwards.
  template <class Passes>
  void Finish(uint32_t pass, Passes&& passes) {
    if (unfinished_.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    passes.OnEnd(pass);
    OpenFrom(pass + 1, passes);
  }

  // Acquires what the frame wrote when it says true.
  bool IsIdle() const { return ticket_.load(std::memory_order_acquire) == kIdleTicket; }

  // The pass that is open and its unclaimed items, as they were a moment ago; 0 items between
  // passes and between frames.
  Item Peek() const {
    const uint64_t ticket = ticket_.load(std::memory_order_relaxed);
    return {uint32_t(ticket >> 32), uint32_t(ticket)};
  }

 private:
  static constexpr uint64_t kIdleTicket = uint64_t{0xffffffffu} << 32;
  static constexpr uint64_t kTakenTicket = uint64_t{0xfffffffeu} << 32;

  template <class Passes>
  void OpenFrom(uint32_t pass, Passes& passes) {
    for (const uint32_t count = passes.Count(); pass < count; ++pass) {
      passes.OnBegin(pass);
      if (const uint32_t items = passes.Items(pass)) {
        unfinished_.store(items, std::memory_order_relaxed);
        ticket_.store(uint64_t(pass) << 32 | items, std::memory_order_release);
        return;
      }
      passes.OnEnd(pass);
    }
    ticket_.store(kIdleTicket, std::memory_order_release);
  }

  Atomic<uint64_t> ticket_{kIdleTicket};
  Atomic<uint32_t> unfinished_{0};
};

}  // namespace pelt
