// Transfers of several units that share one memory: what a frame needs of the memory model, at a
// thousandth of its price.
//
//   unit 0  [ transfer 3 | transfer 7 | ... ] --.            .--------.
//   unit 1  [ transfer 4 | ...              ] --+-- reads ---| memory |
//   unit 2  [ ...                           ] --'   writes --'--------'
//             one flows, in order
//
// A fluid. Of each unit's queue one transfer flows; those that flow share the memory: reads and
// writes alike as long as both wait (the controller turns its direction after so many lines), and
// pay for the turning as long as some unit has either in its queue; transfers of one direction
// alike, each below what its unit has lines in flight for and what its commands and list elements
// take to issue. The last byte is there a latency after it has flowed. A unit that was idle has all
// its lines in flight free: its first bytes flow at the memory's rate.
//
// Invariant: every transfer flows all its bytes, once. All numbers of SharedMemory are measured on
// the line-level models (console_machine.cpp); what they lose is documented in
// tests/platform_sim/shared_transfers_test.cpp: both run the same streams.
//
// Not modelled: the 16 places of an MFC's queue (blocks of an item go as one list, which takes one
// place), addresses: banks, alignment and rings do not matter here.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "platform_sim/memory/event_queue.hpp"

namespace pelt {

// What sums of doubles are apart.
inline constexpr double kTinyCycles = 1e-6;
inline Cycles WholeCycles(double cycles) { return Cycles(std::ceil(cycles - kTinyCycles)); }

// Bytes a cycle, cycles, bytes; a port is what one unit, or the units of one core, reach memory by.
struct SharedMemory {
  double read_rate = 0.0, write_rate = 0.0;  // all ports one way
  double mixed_rate = 0.0;                   // half of it each way, both ways together
  double port_read_rate = 0.0, port_write_rate = 0.0;
  double burst_bytes = 0.0;  // that a port which was idle is ahead of its rate
  Cycles read_latency_cycles = 0, write_latency_cycles = 0;
  // Of the port, for each; a command is also what the first bytes of an idle port wait for.
  Cycles command_cycles = 0, element_cycles = 0, line_cycles = 0;
  uint32_t units_per_port = 1;
};
// Moves anything in no time.
SharedMemory FreeMemory(uint32_t units_per_port);

struct TransferShape {
  uint64_t bytes = 0;  // of whole lines
  uint32_t commands = 0, elements = 0, lines = 0;
};

class SharedTransfers {
 public:
  static constexpr uint32_t kNone = ~0u;

  SharedTransfers(const SharedMemory& memory, uint32_t units);

  // Gives a transfer to the unit's queue; `after`: it does not begin before that one is done, and
  // lets later ones of its unit pass. `now`: not before AdvanceTo's. Returns its number.
  uint32_t Start(Cycles now, uint32_t unit, bool put, const TransferShape& shape,
                 uint32_t after = kNone);

  // When to look again: nothing is done between now and then. kNever: nothing is on its way.
  static constexpr Cycles kNever = INT64_MAX;
  Cycles NextEvent() const;
  void AdvanceTo(Cycles now);

  // Known once its bytes have flowed; kNever until then.
  Cycles DoneAt(uint32_t transfer) const { return transfers_[transfer].done; }
  // When its bytes began to flow; kNever while they have not.
  Cycles BegunAt(uint32_t transfer) const { return transfers_[transfer].begin; }

 private:
  struct Transfer {
    uint32_t unit, after;
    bool put;
    double left;        // bytes
    double issue_rate;  // that its commands, elements and lines allow
    Cycles begin = kNever, done = kNever;
  };
  struct Unit {
    std::vector<uint32_t> queue;  // in the order given, without the current one
    uint32_t current = kNone;     // being taken up, or flowing
    double ready = 0.0;           // when it is taken up
    double free_since = 0.0;      // of a unit without
    double rate = 0.0;
  };
  struct Port {
    double burst;  // bytes it may still be ahead of its rate
    double idle_since = 0.0;
    uint32_t flowing = 0;
    double rate = 0.0, own_rate = 0.0;  // what flows, and what it has lines in flight for
  };

  void PickUp();
  void ShareOut();
  void ShareWay(bool put, double total);
  double Wanted(const Unit& unit) const;
  double NextChange() const;
  void Flow(double until);
  void Finish(Unit& unit);
  bool IsHeld(uint32_t transfer) const {
    const uint32_t after = transfers_[transfer].after;
    return after != kNone && double(transfers_[after].done) > time_;
  }
  bool Flows(const Unit& unit) const { return unit.current != kNone && unit.ready <= time_; }
  uint32_t PortOf(const Unit& unit) const {
    return uint32_t(&unit - units_.data()) / memory_.units_per_port;
  }

  SharedMemory memory_;
  std::vector<Transfer> transfers_;
  std::vector<Unit> units_;
  std::vector<Port> ports_;
  double time_ = 0.0;  // up to which bytes have flowed
};

}  // namespace pelt
