// The XDR memory behind the Cell's memory controller: one line after another, whoever asks.
//
// A line takes its share of the peak rate; refresh takes the memory away for a while at a fixed
// interval; going from reads to writes and back costs time, so several lines go one way before the
// other way has its turn. Requests of one direction are served in the order they came; because
// every MFC has the same few lines in flight, that shares the memory fairly among SPEs.
//
// Not modelled: banks and pages, writes below a line (they read first on the console).
#pragma once

#include <cstdint>
#include <deque>

#include "platform_sim/memory/event_queue.hpp"
#include "platform_sim/platforms/cell_memory.hpp"

namespace pelt {

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

}  // namespace pelt
