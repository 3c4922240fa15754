// Who runs which item of a frame: any thread may ask at any time, no thread waits for another.
//
// An open item is a bit of an atomic word, and one atomic operation takes it. Nothing but atomics of the
// scheduler's own is read before that has succeeded, and what the bit says is true at the moment it
// succeeds: a thread that slept since an earlier frame finds the bit gone, or set for an item that
// is open now, and is welcome to it. (So words carry no number of the frame: it would protect
// nothing.) Whoever ends the last item that a node waits for fires the node (jobs/frame_graph.hpp).
//
//   idle ──> taken ──> open: claim, run, finish ... ──> the last node fires ──> idle
//
// Invariants: between a successful claim and the end of its Finish the frame cannot end, so what
// belongs to the frame, its graph too, may be read then and only then; Finish reads nothing of it
// after the last bit it sets or count it takes. Memory that words were in is kept for late threads.
// No thread identity, no thread-local state, no lock; memory is allocated for a frame larger than
// all before alone. tests/thread/model_test.cpp runs small frames over this source on a
// simulated weak memory, which is why the atomic type is a parameter.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>
#include <memory>
#include <vector>

#include "jobs/frame_graph.hpp"

namespace pelt {

enum class PullResult : uint8_t {
  kRan,           // an item was run
  kNothingReady,  // a frame is open, and what is left of it waits for items that run elsewhere
  kIdle,          // no frame is open: the last one is done, or none was begun
};

template <template <class> class Atomic>
class FrameScheduler {
 public:
  // A bit of a word: what it stands for is in the frame's graph.
  struct Claim {
    uint32_t word, bit;
  };

  // For frames on `workers` threads. Has room for so many words and nodes without allocating.
  FrameScheduler(uint32_t workers, uint32_t words, uint32_t nodes) : workers_(workers) {
    Reserve(words, nodes);
  }

  // Takes the scheduler for a new frame; false if one is open. Between this and Start the caller
  // may change what belongs to the frame: no claim can succeed.
  [[nodiscard]] bool TakeForFrame() {
    uint64_t idle = kIdle;
    return phase_.compare_exchange_strong(idle, kTaken, std::memory_order_acquire,
                                          std::memory_order_relaxed);
  }
  // Opens what waits for nothing; only after TakeForFrame. `on_end` is called when all is done,
  // before any thread can see that the scheduler is idle.
  template <class OnEnd>
  void Start(const FrameGraph& graph, const OnEnd& on_end) {
    Reserve(uint32_t(graph.words.size()), uint32_t(graph.nodes.size()));
    Room& room = *room_.load(std::memory_order_relaxed);
    for (uint32_t n = 0; n <= graph.LastNode(); ++n)
      room.pending[n].store(graph.nodes[n].waits_for, std::memory_order_relaxed);
    phase_.store(graph.layout.Packed() << 1 | kOpen, std::memory_order_release);
    Fire(room, graph, 0, on_end);
  }

  // kRan: what `claim` stands for must be run, and then finished. `worker` says where to look
  // first: a wrong one costs time only.
  PullResult TryClaim(uint32_t worker, Claim& claim) {
    const uint64_t phase = phase_.load(std::memory_order_acquire);
    if (!(phase & kOpen)) return phase == kIdle ? PullResult::kIdle : PullResult::kNothingReady;
    // Of this frame or a later one: large enough for this one in any case.
    Room& room = *room_.load(std::memory_order_acquire);
    const auto layout = WordLayout::Unpack(phase >> 1);
    const auto home = [&](uint32_t w) { return uint32_t(uint64_t(w) * layout.places / workers_); };
    const uint32_t from = home(worker % workers_), to = home(worker % workers_ + 1);
    Atomic<uint32_t>& before = room.before[from].word;
    const bool claimed = ClaimCommon(room, layout, claim) ||
                         ClaimAsBefore(room, layout, from, to, claim) ||
                         ClaimFirst(room, layout, from, to, claim) ||
                         ClaimLast(room, layout, to, layout.places, claim) ||
                         ClaimLast(room, layout, 0, from, claim);
    if (claimed && claim.word != before.load(std::memory_order_relaxed))
      before.store(claim.word, std::memory_order_relaxed);
    return claimed ? PullResult::kRan : PullResult::kNothingReady;
  }

  // After what was claimed was run; `node` is what it counts for. The caller may not touch the
  // frame afterwards.
  template <class OnEnd>
  void Finish(const FrameGraph& graph, uint32_t node, const OnEnd& on_end) {
    Count(*room_.load(std::memory_order_relaxed), graph, node, on_end);
  }

  // Acquires what the frame wrote when it says true.
  bool IsIdle() const { return phase_.load(std::memory_order_acquire) == kIdle; }

 private:
  // Besides the layout of an open frame's words.
  static constexpr uint64_t kIdle = 0, kTaken = 2, kOpen = 1;

  struct alignas(64) Line {
    Atomic<uint64_t> word[WordLayout::kPerLine];
  };
  struct alignas(64) Hint {
    Atomic<uint32_t> word{0};
  };
  // What any thread may read at any time.
  struct Room {
    Room(uint32_t word_count, uint32_t node_count)
        : words(word_count),
          nodes(node_count),
          lines(std::make_unique<Line[]>(word_count / WordLayout::kPerLine + 1)),
          pending(std::make_unique<Atomic<uint32_t>[]>(node_count)),
          before(std::make_unique<Hint[]>(FrameGraph::kMostPlaces)) {}
    Atomic<uint64_t>& Word(uint32_t word) {
      return lines[word / WordLayout::kPerLine].word[word % WordLayout::kPerLine];
    }
    const uint32_t words, nodes;
    const std::unique_ptr<Line[]> lines;
    const std::unique_ptr<Atomic<uint32_t>[]> pending;  // of nodes: what each still waits for
    const std::unique_ptr<Hint[]> before;  // of homes' first places: where the last item was
  };

  void Reserve(uint32_t words, uint32_t nodes) {
    const Room* room = room_.load(std::memory_order_relaxed);
    if (room && room->words >= words && room->nodes >= nodes) return;
    // Late threads may be looking at the old one.
    rooms_.push_back(std::make_unique<Room>(std::max(words, room ? 2 * room->words : 0),
                                            std::max(nodes, room ? 2 * room->nodes : 0)));
    room_.store(rooms_.back().get(), std::memory_order_release);
  }

  // Takes `bit` of a word that was `bits` a moment ago, if it is still there.
  static bool Take(Room& room, uint32_t word, uint64_t& bits, uint32_t bit, Claim& claim) {
    const uint64_t mask = uint64_t{1} << bit;
    bits = room.Word(word).fetch_and(~mask, std::memory_order_acquire);
    const bool taken = bits & mask;
    if (taken) claim = {word, bit};
    bits &= ~mask;
    return taken;
  }
  static bool TakeFirst(Room& room, uint32_t word, Claim& claim) {
    for (uint64_t bits = room.Word(word).load(std::memory_order_relaxed); bits;)
      if (Take(room, word, bits, uint32_t(std::countr_zero(bits)), claim)) return true;
    return false;
  }
  static bool ClaimCommon(Room& room, const WordLayout& layout, Claim& claim) {
    for (uint32_t w = 0; w < layout.common; ++w)
      if (TakeFirst(room, w, claim)) return true;
    return false;
  }
  static bool TakeLast(Room& room, uint32_t word, Claim& claim) {
    for (uint64_t bits = room.Word(word).load(std::memory_order_relaxed); bits;)
      if (Take(room, word, bits, 63 - uint32_t(std::countl_zero(bits)), claim)) return true;
    return false;
  }
  // Most often there is more where the last one was; in places [from, to) its owner begins at the front.
  static bool ClaimAsBefore(Room& room, const WordLayout& layout, uint32_t from, uint32_t to,
                            Claim& claim) {
    const uint32_t word = room.before[from].word.load(std::memory_order_relaxed);
    const bool own = word >= layout.Word(from, 0) && word < layout.Word(to, 0);
    return own ? TakeFirst(room, word, claim) : TakeLast(room, word, claim);
  }
  // Of places [from, to): word by word, in each place after place.
  static bool ClaimFirst(Room& room, const WordLayout& layout, uint32_t from, uint32_t to,
                         Claim& claim) {
    for (uint32_t w = 0; w < layout.in_place; ++w)
      for (uint32_t place = from; place < to; ++place)
        if (TakeFirst(room, layout.Word(place, w), claim)) return true;
    return false;
  }
  // Of places [from, to) what the first that has any would come to last.
  static bool ClaimLast(Room& room, const WordLayout& layout, uint32_t from, uint32_t to,
                        Claim& claim) {
    for (uint32_t place = from; place < to; ++place)
      for (uint32_t w = 0; w < layout.in_place; ++w)
        if (TakeLast(room, layout.Word(place, w), claim)) return true;
    return false;
  }

  template <class OnEnd>
  void Count(Room& room, const FrameGraph& graph, uint32_t node, const OnEnd& on_end) {
    if (graph.nodes[node].waits_for == 1 ||
        room.pending[node].fetch_sub(1, std::memory_order_acq_rel) == 1)
      Fire(room, graph, node, on_end);
  }
  template <class OnEnd>
  void Fire(Room& room, const FrameGraph& graph, uint32_t node, const OnEnd& on_end) {
    if (node == graph.LastNode()) {
      on_end();
      phase_.store(kIdle, std::memory_order_release);
      return;
    }
    // What is read of the graph is read before the last bit or count: the frame may end with it.
    const FrameGraph::Node &at = graph.nodes[node], &after = graph.nodes[node + 1];
    const FrameGraph::Open *open = graph.opens.data() + at.first_open, *const opens_end =
                                                                           graph.opens.data() +
                                                                           after.first_open;
    const uint32_t *next = graph.next.data() + at.first_next, *const next_end = graph.next.data() +
                                                                                after.first_next;
    while (open != opens_end) {
      const FrameGraph::Open now = *open++;
      room.Word(now.word).fetch_or(now.bits, std::memory_order_release);
    }
    while (next != next_end) Count(room, graph, *next++, on_end);
  }

  const uint32_t workers_;
  Atomic<uint64_t> phase_{kIdle};
  Atomic<Room*> room_{nullptr};
  std::vector<std::unique_ptr<Room>> rooms_;
};

}  // namespace pelt
