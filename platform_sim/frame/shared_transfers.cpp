#include "platform_sim/frame/shared_transfers.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pelt {
namespace {

constexpr double kForever = 1e300;
constexpr double kInstantRate = 1e15;  // bytes per cycle
// Below a byte of any transfer: what sums of doubles are apart.
constexpr double kTinyBytes = 1e-3;

// Rates of reads and writes when both are wanted. Between the three rates that were measured (one
// way, the other way, half and half) lie straight lines; both ways get the same, unless one wants
// less. `both_wait`: the way that does not flow now is next in some unit's queue, whose last lines
// and first lines of the next transfer are in flight together.
struct TwoWays {
  double read, write;
};
TwoWays ShareWays(const SharedMemory& m, double read, double write, bool both_wait) {
  const auto one_way = [&](double rate, double wanted) {
    return std::min(wanted, both_wait ? std::min(rate, m.mixed_rate) : rate);
  };
  if (write <= 0.0) return {one_way(m.read_rate, read), 0.0};
  if (read <= 0.0) return {0.0, one_way(m.write_rate, write)};
  const double half = m.mixed_rate / 2;
  const auto beside = [half](double most, double wanted, double other) {
    return std::min(wanted, std::max(half, most - (most - half) * other / half));
  };
  if (read < half) return {read, beside(m.write_rate, write, read)};
  if (write < half) return {beside(m.read_rate, read, write), write};
  return {half, half};
}

}  // namespace

SharedMemory FreeMemory(uint32_t units_per_port) {
  SharedMemory m;
  m.read_rate = m.write_rate = m.mixed_rate = kInstantRate;
  m.port_read_rate = m.port_write_rate = kInstantRate;
  m.units_per_port = units_per_port;
  return m;
}

SharedTransfers::SharedTransfers(const SharedMemory& memory, uint32_t units)
    : memory_(memory),
      units_(units),
      ports_((units + memory.units_per_port - 1) / memory.units_per_port,
             Port{memory.burst_bytes}) {}

uint32_t SharedTransfers::Start(Cycles now, uint32_t unit, bool put, const TransferShape& shape,
                                uint32_t after) {
  assert(shape.bytes > 0);
  AdvanceTo(now);
  Transfer t;
  t.unit = unit;
  t.after = after;
  t.put = put;
  t.left = double(shape.bytes);
  const double issue = double(shape.commands) * double(memory_.command_cycles) +
                       double(shape.elements) * double(memory_.element_cycles) +
                       double(shape.lines) * double(memory_.line_cycles);
  t.issue_rate = issue > 0.0 ? t.left / issue : kInstantRate;
  transfers_.push_back(t);
  units_[unit].queue.push_back(uint32_t(transfers_.size() - 1));
  PickUp();
  ShareOut();
  return uint32_t(transfers_.size() - 1);
}

// Every unit without a current transfer takes the first that nothing holds back. Right behind
// another its command was taken up while that one's lines were in flight.
void SharedTransfers::PickUp() {
  for (Unit& unit : units_) {
    if (unit.current != kNone) continue;
    const auto next =
        std::find_if(unit.queue.begin(), unit.queue.end(), [&](uint32_t t) { return !IsHeld(t); });
    if (next == unit.queue.end()) continue;
    unit.current = *next;
    unit.queue.erase(next);
    const bool behind = time_ > 0.0 && unit.free_since >= time_;
    unit.ready = behind ? time_ : time_ + double(memory_.command_cycles);
    transfers_[unit.current].begin = WholeCycles(unit.ready);
  }
}

double SharedTransfers::Wanted(const Unit& unit) const {
  const Port& port = ports_[PortOf(unit)];
  const Transfer& t = transfers_[unit.current];
  if (port.burst > 0.0) return t.issue_rate;
  const double own = t.put ? memory_.port_write_rate : memory_.port_read_rate;
  return std::min(t.issue_rate, own / port.flowing);
}

void SharedTransfers::ShareOut() {
  for (Port& port : ports_) {
    port.flowing = 0;
    port.rate = port.own_rate = 0.0;
  }
  for (Unit& unit : units_) {
    unit.rate = 0.0;
    if (!Flows(unit)) continue;
    Port& port = ports_[PortOf(unit)];
    ++port.flowing;
    if (port.idle_since >= 0.0) {
      port.burst = std::min(memory_.burst_bytes,
                            port.burst + (time_ - port.idle_since) * memory_.port_read_rate);
      port.idle_since = -1.0;
    }
  }
  for (Port& port : ports_)
    if (port.flowing == 0 && port.idle_since < 0.0) port.idle_since = time_;

  double wanted[2] = {0.0, 0.0};
  for (const Unit& unit : units_)
    if (Flows(unit)) wanted[transfers_[unit.current].put] += Wanted(unit);
  bool waits[2] = {wanted[0] > 0.0, wanted[1] > 0.0};
  for (const Unit& unit : units_)
    for (const uint32_t t : unit.queue) waits[transfers_[t].put] |= !IsHeld(t);
  const TwoWays ways = ShareWays(memory_, wanted[0], wanted[1], waits[0] && waits[1]);
  ShareWay(false, ways.read);
  ShareWay(true, ways.write);
  for (const Unit& unit : units_) {
    if (!Flows(unit)) continue;
    Port& port = ports_[PortOf(unit)];
    const bool put = transfers_[unit.current].put;
    port.rate += unit.rate;
    port.own_rate += (put ? memory_.port_write_rate : memory_.port_read_rate) / port.flowing;
  }
}

// `total` among the transfers of one direction: the same for all, but none more than it wants.
void SharedTransfers::ShareWay(bool put, double total) {
  const auto is_of_way = [&](const Unit& unit) {
    return Flows(unit) && transfers_[unit.current].put == put;
  };
  uint32_t open = 0;
  for (Unit& unit : units_) open += is_of_way(unit);
  for (bool again = true; again && open > 0;) {
    again = false;
    const double share = total / open;
    for (Unit& unit : units_) {
      if (!is_of_way(unit) || unit.rate > 0.0) continue;
      const double wanted = Wanted(unit);
      if (wanted > share) continue;
      unit.rate = wanted;
      total = std::max(0.0, total - wanted);
      --open;
      again = true;
      break;  // the others' share has grown
    }
  }
  for (Unit& unit : units_)
    if (is_of_way(unit) && unit.rate == 0.0) unit.rate = total / open;
}

double SharedTransfers::NextChange() const {
  double next = kForever;
  for (const Unit& unit : units_) {
    if (unit.current == kNone) {
      for (const uint32_t t : unit.queue) {
        const Cycles held = transfers_[transfers_[t].after].done;
        if (held != kNever) next = std::min(next, double(held));
      }
    } else {
      next = std::min(next, unit.ready > time_ ? unit.ready
                                               : time_ + transfers_[unit.current].left / unit.rate);
    }
  }
  for (const Port& port : ports_)
    if (port.flowing > 0 && port.burst > 0.0 && port.rate > port.own_rate)
      next = std::min(next, time_ + port.burst / (port.rate - port.own_rate));
  return next;
}

Cycles SharedTransfers::NextEvent() const {
  const double next = NextChange();
  return next == kForever ? kNever : WholeCycles(next);
}

void SharedTransfers::Flow(double until) {
  const double cycles = until - time_;
  time_ = until;
  for (Unit& unit : units_)
    if (unit.rate > 0.0) transfers_[unit.current].left -= unit.rate * cycles;
  for (Port& port : ports_) {
    if (port.flowing == 0 || port.burst <= 0.0 || port.rate <= port.own_rate) continue;
    const double ahead = port.rate - port.own_rate;
    port.burst -= ahead * cycles;
    if (port.burst <= std::max(kTinyBytes, ahead * kTinyCycles)) port.burst = 0.0;
  }
}

void SharedTransfers::Finish(Unit& unit) {
  Transfer& t = transfers_[unit.current];
  t.done = WholeCycles(time_ +
                       double(t.put ? memory_.write_latency_cycles : memory_.read_latency_cycles));
  unit.current = kNone;
  unit.free_since = time_;
  unit.rate = 0.0;
}

void SharedTransfers::AdvanceTo(Cycles now) {
  for (;;) {
    const double next = NextChange();
    if (next > double(now) + kTinyCycles) break;
    Flow(std::max(next, time_));
    for (Unit& unit : units_)
      if (unit.rate > 0.0 &&
          transfers_[unit.current].left <= std::max(kTinyBytes, unit.rate * kTinyCycles))
        Finish(unit);
    PickUp();
    ShareOut();
  }
  Flow(std::max(double(now), time_));
}

}  // namespace pelt
