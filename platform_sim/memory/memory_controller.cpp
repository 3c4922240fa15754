#include "platform_sim/memory/memory_controller.hpp"

namespace pelt {

void MemoryController::Access(bool write, Action done) {
  waiting_[write].push_back(std::move(done));
  if (!busy_) Serve();
}

bool MemoryController::PickDirection() const {
  if (waiting_[writing_].empty()) return !writing_;
  if (waiting_[!writing_].empty()) return writing_;
  return in_a_row_ < p_.turnaround_lines ? writing_ : !writing_;
}

// A refresh begins every interval; a line that would meet one waits for its end.
Cycles MemoryController::AfterRefresh(Cycles time) const {
  const Cycles interval = p_.refresh_interval_cycles;
  const Cycles phase = time % interval;
  if (phase < p_.refresh_cycles) return time - phase + p_.refresh_cycles;
  if (phase + p_.memory_line_cycles > interval) return time - phase + interval + p_.refresh_cycles;
  return time;
}

void MemoryController::Serve() {
  if (waiting_[0].empty() && waiting_[1].empty()) return;
  const bool write = PickDirection();
  Cycles start = queue_.now();
  if (write != writing_) {
    start += p_.turnaround_cycles;
    writing_ = write;
    in_a_row_ = 0;
  }
  ++in_a_row_;
  ++lines_[write];
  const Cycles end = AfterRefresh(start) + p_.memory_line_cycles;
  queue_.At(end + p_.memory_access_cycles, std::move(waiting_[write].front()));
  waiting_[write].pop_front();
  busy_ = true;
  queue_.At(end, [this] {
    busy_ = false;
    Serve();
  });
}

}  // namespace pelt
