#include <algorithm>

#include "platform_sim/memory/cell_memory.hpp"

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

namespace {

// SPEs by their stops, upward round the ring.
constexpr std::array<uint32_t, 8> kSpeOfOrder = {1, 3, 5, 7, 6, 4, 2, 0};
constexpr std::array<uint32_t, 8> kStopOfOrder = {1, 2, 3, 4, 7, 8, 9, 10};
constexpr uint32_t kGameSpes = 6;

// Segment k of a way, named by the lower of its two stops.
uint32_t Segment(bool upward, uint32_t from, uint32_t k) {
  return upward ? (from + k) % kBusStops : (from + 2 * kBusStops - k - 1) % kBusStops;
}

}  // namespace

uint32_t BusStop(const CellMemoryParameters& p, uint32_t spu) {
  const uint32_t place = (spu + p.first_spu) % kGameSpes;
  for (uint32_t i = 0, seen = 0; i < kSpeOfOrder.size(); ++i) {
    if (kSpeOfOrder[i] == p.missing_spe[0] || kSpeOfOrder[i] == p.missing_spe[1]) continue;
    if (seen++ == place) return kStopOfOrder[i];
  }
  return kMemoryStop;  // unreachable: CheckCellMemory allows six
}

Bus::Bus(const CellMemoryParameters& p, EventQueue& queue)
    : p_(p), queue_(queue), line_cycles_(Cycles(p.line_bytes / p.ring_bytes) * p.bus_cycle_cycles) {
  for (uint32_t r = 0; r < p.rings; ++r) {
    rings_.push_back({r < p.rings / 2, 0, {}, {}});
    rings_.back().ends.assign(p.transfers_per_ring, 0);
  }
}

void Bus::Send(uint32_t from, uint32_t to, Action arrived) {
  waiting_[from].push_back({to, std::move(arrived)});
  const Cycles step = p_.bus_cycle_cycles;
  WakeAt((queue_.now() + step - 1) / step * step);
}

void Bus::WakeAt(Cycles time) {
  if (wake_ >= 0 && wake_ <= time) return;
  wake_ = time;
  queue_.At(time, [this, time] {
    if (wake_ != time) return;  // an earlier one came in between
    wake_ = -1;
    Arbitrate();
  });
}

void Bus::Arbitrate() {
  TryGrant(kMemoryStop);
  uint32_t last = turn_;
  for (uint32_t i = 0; i < kMemoryStop; ++i) {
    const uint32_t stop = (turn_ + i) % kMemoryStop;
    if (TryGrant(stop)) last = stop + 1;
  }
  turn_ = last % kMemoryStop;

  Cycles next = -1;
  for (uint32_t stop = 0; stop < kBusStops; ++stop) {
    if (waiting_[stop].empty()) continue;
    const Cycles time = std::max(Earliest(stop, waiting_[stop].front().to).time,
                                 queue_.now() + Cycles(p_.bus_cycle_cycles));
    if (next < 0 || time < next) next = time;
  }
  if (next >= 0) WakeAt(next);
}

Cycles Bus::RingFree(const Ring& ring, uint32_t from, uint32_t hops) const {
  Cycles time = std::max(ring.next_start, *std::min_element(ring.ends.begin(), ring.ends.end()));
  for (uint32_t k = 0; k < hops; ++k)
    time = std::max(time, ring.free_at[Segment(ring.upward, from, k)]);
  return time;
}

Bus::Grant Bus::Earliest(uint32_t from, uint32_t to) {
  Grant best;
  const uint32_t up = (to + kBusStops - from) % kBusStops;
  for (Ring& ring : rings_) {
    const uint32_t hops = ring.upward ? up : kBusStops - up;
    if (hops > kBusStops / 2) continue;
    const Cycles arrival = in_free_[to] - Cycles(hops) * p_.bus_cycle_cycles;
    const Cycles time = std::max({RingFree(ring, from, hops), out_free_[from], arrival});
    if (!best.ring || time < best.time) best = {&ring, time, hops};
  }
  return best;
}

bool Bus::TryGrant(uint32_t from) {
  if (waiting_[from].empty()) return false;
  const Cycles now = queue_.now();
  const uint32_t to = waiting_[from].front().to;
  const auto [ring, time, hops] = Earliest(from, to);
  if (time > now) return false;

  const Cycles end = now + line_cycles_ + Cycles(hops) * p_.bus_cycle_cycles;
  for (uint32_t k = 0; k < hops; ++k) ring->free_at[Segment(ring->upward, from, k)] = end;
  *std::min_element(ring->ends.begin(), ring->ends.end()) = end;
  ring->next_start = now + Cycles(p_.ring_start_bus_cycles) * p_.bus_cycle_cycles;
  out_free_[from] = now + line_cycles_;
  in_free_[to] = end;
  ++lines_;
  queue_.At(end, std::move(waiting_[from].front().arrived));
  waiting_[from].pop_front();
  return true;
}

}  // namespace pelt
