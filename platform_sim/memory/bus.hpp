// The EIB: rings that carry lines between twelve stops, and the arbiter that grants them.
//
//        PPE  SPE1 SPE3 SPE5 SPE7 IOIF1        two rings run one way, two the other;
//      +--o----o----o----o----o----o--+        a line is eight beats of 16 bytes, one a bus cycle
//      +--o----o----o----o----o----o--+
//        MIC  SPE0 SPE2 SPE4 SPE6 IOIF0
//
// A line is granted a ring when its whole way, at most half round, is free of other lines, the ring
// carries fewer than three and has not just started one, and both stops' ports are free; the memory
// controller goes first, the others in turn. So lines that cross share a ring badly, and what pairs
// of SPEs reach depends on where they sit. Source: consoles.md (EIB), Krolak as quoted; that the
// way is held until the line's last beat has left it is how this model reads "does not disturb a
// transfer that is under way" (class L).
//
// Not modelled: the command bus's tree, credits, the second chip's stops, transfers below a line.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "platform_sim/memory/event_queue.hpp"
#include "platform_sim/platforms/cell_memory.hpp"

namespace pelt {

// The XDR memory behind the Cell's memory controller: one line after another, whoever asks.
//
// A line takes its share of the peak rate; refresh takes the memory away for a while at a fixed
// interval; going from reads to writes and back costs time, so several lines go one way before the
// other way has its turn. Requests of one direction are served in the order they came; because
// every MFC has the same few lines in flight, that shares the memory fairly among SPEs.
//
// Not modelled: banks and pages, writes below a line (they read first on the console).

class MemoryController {
 public:
  MemoryController(const CellMemoryParameters& p, EventQueue& queue) : p_(p), queue_(queue) {}

  // `done` runs when the line's access is over: a read's data is there, a write is acknowledged.
  void Access(bool write, Action done);

  uint64_t lines(bool write) const { return lines_[write]; }

 private:
  void Serve();
  bool PickDirection() const;
  Cycles AfterRefresh(Cycles time) const;

  const CellMemoryParameters& p_;
  EventQueue& queue_;
  std::deque<Action> waiting_[2];  // reads, writes
  bool busy_ = false, writing_ = false;
  uint32_t in_a_row_ = 0;
  uint64_t lines_[2] = {0, 0};
};

inline constexpr uint32_t kBusStops = 12;
inline constexpr uint32_t kPpeStop = 0;
inline constexpr uint32_t kMemoryStop = 11;

// Where the game's SPU `spu` sits, on a console that lacks the SPEs that `p` says: SPUs follow each
// other upward round the ring.
uint32_t BusStop(const CellMemoryParameters& p, uint32_t spu);

class Bus {
 public:
  Bus(const CellMemoryParameters& p, EventQueue& queue);

  // Moves a line; `arrived` runs when its last beat has. Lines leave a stop in the order they came.
  void Send(uint32_t from, uint32_t to, Action arrived);

  uint64_t lines() const { return lines_; }

 private:
  struct Line {
    uint32_t to;
    Action arrived;
  };
  struct Ring {
    bool upward;
    Cycles next_start = 0;
    std::array<Cycles, kBusStops> free_at{};  // of the segment from a stop to the next one up
    std::vector<Cycles> ends;                 // of the last lines, as many as it may carry
  };
  struct Grant {
    Ring* ring = nullptr;
    Cycles time = 0;
    uint32_t hops = 0;
  };

  void Arbitrate();
  bool TryGrant(uint32_t from);
  Grant Earliest(uint32_t from, uint32_t to);
  Cycles RingFree(const Ring& ring, uint32_t from, uint32_t hops) const;
  void WakeAt(Cycles time);

  const CellMemoryParameters& p_;
  EventQueue& queue_;
  Cycles line_cycles_;
  std::vector<Ring> rings_;
  std::array<std::deque<Line>, kBusStops> waiting_;
  std::array<Cycles, kBusStops> out_free_{}, in_free_{};
  uint32_t turn_ = 0;
  Cycles wake_ = -1;  // when an Arbitrate is already asked for
  uint64_t lines_ = 0;
};

}  // namespace pelt
