// The Cell's memory as its SPUs see it: one MFC per SPU, the bus and the memory behind them.
//
//   SPU --channels--> queue (16) --take up, in order--> lines (16 in flight) --snoop--> EIB, memory
//
// A command waits in its MFC's queue; the MFC takes commands up one after another (a fenced one
// lets others pass until its turn), cuts each into lines and keeps at most so many in flight. A
// line's command is snooped, its data crosses the bus, memory serves it. Latency, Little's law,
// waste of small and of badly aligned commands, sharing and contention come out of that; none is a
// rule.
//
// Invariant: every submitted command completes, once, and the lines counted at the bus are the sum
// of the commands' lines. Everything happens on the caller's EventQueue, so a frame model can put
// its own events beside these.
//
// Not modelled: TLB misses, the proxy queue of the PPE, the SPU's own loads and stores delaying DMA
// in the local store (at most one cycle in sixteen), data: only addresses and sizes move here.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "platform_sim/memory/event_queue.hpp"
#include "platform_sim/platforms/cell.hpp"

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

// A DMA command as a program gives it to the MFC, and what the hardware demands of it.
//
// 1, 2, 4, 8 bytes at their own alignment, or a multiple of 16 bytes up to 16 KiB at 16; both
// addresses agree in their low four bits. A command that is refused here raises an alignment interrupt on
// the console and stops the game: an error here says which rule it was. Memory and the bus move
// whole 128-byte lines, so a command whose addresses are not at 128 costs the lines it touches.
//
// Not modelled: that a list lies in local store and its elements may not cross 4 GiB.

enum class DmaKind : uint8_t { kGet, kPut };
enum class DmaFar : uint8_t { kMemory, kL2, kLocalStore };
// A fence: after the earlier commands of its tag. A barrier: later ones of its tag after it, too.
enum class DmaOrder : uint8_t { kNone, kFence, kBarrier };

struct DmaElement {
  uint64_t address;  // main memory, or the far local store's
  uint32_t bytes;
};

struct DmaCommand {
  DmaKind kind = DmaKind::kGet;
  DmaFar far = DmaFar::kMemory;
  uint32_t far_spu = 0;  // of kLocalStore
  uint32_t tag = 0;
  DmaOrder order = DmaOrder::kNone;
  uint32_t local_address = 0;
  bool list = false;
  std::vector<DmaElement> elements;  // one, unless it is a list
};

DmaCommand MakeDma(DmaKind kind, uint32_t local_address, uint64_t address, uint32_t bytes,
                   uint32_t tag);

// False, and in `error` what the hardware demands and what to do.
bool CheckDma(const CellMemoryParameters& p, const DmaCommand& command, std::string& error);

// A block of any size and 128-byte, 16-byte or natural alignment as the fewest legal commands.
// Empty, and why in `error`, when no command sequence can move it. Zero bytes are no commands.
bool SplitDma(const CellMemoryParameters& p, const DmaCommand& block, std::vector<DmaCommand>& out,
              std::string& error);

// Lines that an element moves: those that either side touches, whichever are more.
uint32_t DmaLines(const CellMemoryParameters& p, uint32_t local_address, const DmaElement& element);

// Where the next list element goes in local store.
constexpr uint32_t NextListAddress(uint32_t local_address, uint32_t bytes) {
  return (local_address + bytes + 15) & ~15u;
}

struct DmaCounts {
  uint64_t commands = 0;
  uint64_t list_elements = 0;
  uint64_t get_bytes = 0, put_bytes = 0;  // as asked for
  uint64_t lines = 0;                     // moved for them
  uint32_t most_queued = 0;               // commands at one time
};

class CellMemory {
 public:
  // A platform that cannot be is refused. `queue` must outlive it.
  static Result<std::unique_ptr<CellMemory>> Make(const CellMemoryParameters& p, EventQueue& queue);

  // Gives a command to the SPU's MFC now. `accepted` runs when it has a place in the queue (at once
  // unless 16 are in it: until then the SPU stands at its channel), `done` when it has completed.
  // False, and why in `error`, for an illegal command; then neither runs.
  bool Submit(uint32_t spu, const DmaCommand& command, Action accepted, Action done,
              std::string& error);

  // Runs `done` as soon as no accepted command of these tags is left (at once if there is none).
  void WaitTags(uint32_t spu, uint32_t tag_mask, Action done);

  const CellMemoryParameters& parameters() const { return p_; }
  EventQueue& queue() { return queue_; }
  const DmaCounts& counts(uint32_t spu) const { return mfcs_[spu].counts; }
  uint64_t bus_lines() const { return bus_.lines(); }
  uint64_t memory_lines(bool write) const { return memory_.lines(write); }

 private:
  struct Entry {
    DmaCommand command;
    Action done;
    size_t element = 0;       // next to cut
    uint32_t lines_left = 0;  // of the element being cut
    uint32_t local_address = 0;
    uint32_t in_flight = 0;
    bool started = false;

    bool AllCut() const { return element == command.elements.size() && lines_left == 0; }
  };
  struct Waiting {
    DmaCommand command;
    Action accepted, done;
  };
  struct TagWait {
    uint32_t mask;
    Action done;
  };
  struct Mfc {
    std::deque<std::unique_ptr<Entry>> queue;  // in the order given
    std::deque<Waiting> stalled;               // at the channel
    std::vector<TagWait> waits;
    Entry* current = nullptr;  // being cut into lines
    uint32_t lines_in_flight = 0;
    bool busy = false;  // taking up a command, or between two lines
    DmaCounts counts;
  };

  CellMemory(const CellMemoryParameters& p, EventQueue& queue);

  void Accept(uint32_t spu, DmaCommand command, Action done);
  void Pump(uint32_t spu);
  void PumpAfter(uint32_t spu, Cycles cycles);
  Entry* NextToStart(Mfc& mfc) const;
  void StartLine(uint32_t spu, Entry& entry);
  void MoveLine(uint32_t spu, Entry& entry);
  void LineDone(uint32_t spu, Entry& entry);
  void Complete(uint32_t spu, Entry& entry);

  const CellMemoryParameters p_;
  EventQueue& queue_;
  Bus bus_;
  MemoryController memory_;
  std::vector<Mfc> mfcs_;
  Cycles next_snoop_ = 0;
  Cycles l2_free_ = 0;
};

}  // namespace pelt
