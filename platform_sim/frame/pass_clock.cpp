#include "platform_sim/frame/pass_clock.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "jobs/frame.hpp"

namespace pelt {
namespace {

constexpr uint32_t kNone = SharedTransfers::kNone;

}  // namespace

PassClock::PassClock(const ConsoleMachine& machine)
    : machine_(machine), transfers_(machine.memory, machine.units), units_(machine.units) {}

void PassClock::BeginFrame(const FrameWork& work, bool timelines, ModelledFrame& frame) {
  transfers_ = SharedTransfers(machine_.memory, machine_.units);
  for (Unit& unit : units_) unit.puts.clear();
  now_ = line_free_ = dispatcher_free_ = 0;
  timelines_ = timelines;
  moved_.clear();
  frame.cycles = 0;
  frame.passes.clear();
  frame.stage_cycles.assign(work.stage_count, 0);
  frame.stage_items.assign(work.stage_count, 0);
  frame.stream_get_bytes.assign(work.stream_count, 0);
  frame.stream_put_bytes.assign(work.stream_count, 0);
  frame.units.assign(timelines ? units_.size() : 0, {});
}

void PassClock::Run(const PassWork& work, uint32_t items, WorkSource& source,
                    ModelledFrame& frame) {
  work_ = &work;
  source_ = &source;
  frame_ = &frame;
  pass_ = &frame.passes.emplace_back();
  pass_->begin = frame.cycles;
  items_ = items;
  next_item_ = 0;
  for (Unit& unit : units_) {
    unit.phase = Phase::kFree;
    unit.wake = unit.since = now_;
    unit.waits_for = kNone;
    unit.exhausted = unit.has_parameters = false;
    unit.spent = {};
    unit.items.clear();
  }
  for (uint32_t place = 0; place < Places(); ++place)
    for (Unit& unit : units_) Request(unit);

  const auto all_finished = [&] {
    return std::all_of(units_.begin(), units_.end(),
                       [](const Unit& unit) { return unit.phase == Phase::kFinished; });
  };
  while (!all_finished()) {
    // One step each in turn, so that in one cycle nobody takes two items before another has one.
    for (bool again = true; again;) {
      again = false;
      for (uint32_t u = 0; u < units_.size(); ++u)
        if (IsDue(units_[u])) {
          Step(u);
          again = true;
        }
    }
    if (all_finished()) break;
    now_ = NextWake();
    transfers_.AdvanceTo(now_);
  }
  Meet();
}

bool PassClock::IsDue(const Unit& unit) const {
  if (unit.phase == Phase::kFinished) return false;
  return unit.waits_for == kNone ? unit.wake <= now_ : transfers_.DoneAt(unit.waits_for) <= now_;
}

Cycles PassClock::NextWake() const {
  Cycles next = transfers_.NextEvent();
  for (const Unit& unit : units_)
    if (unit.phase != Phase::kFinished)
      next =
          std::min(next, unit.waits_for == kNone ? unit.wake : transfers_.DoneAt(unit.waits_for));
  assert(next != SharedTransfers::kNever);
  return std::max(next, now_);
}

void PassClock::Step(uint32_t u) {
  switch (units_[u].phase) {
    case Phase::kFree:
      return Decide(u);
    case Phase::kDrawing:
      return EndDraw(u);
    case Phase::kGivingGet:
      return StartGet(u);
    case Phase::kAsking:
      EndSlice(units_[u], UnitWork::kCommands, units_[u].current.item);
      return Stand(u);
    case Phase::kStanding:
      return Stand(u);
    case Phase::kComputing:
      return EndCompute(u);
    case Phase::kGivingPut:
      return StartPut(u);
    case Phase::kDraining:
      return Drain(units_[u]);
    case Phase::kFinished:
      return;
  }
}

void PassClock::Decide(uint32_t u) {
  Unit& unit = units_[u];
  Request(unit);
  const bool has_room = !unit.current.any() || (Places() == 2 && !unit.next.any());
  if (has_room && StartDraw(unit)) return;
  if (!unit.current.any()) return Drain(unit);
  const bool asks = unit.current.get != kNone || unit.code != kNone;
  Spend(unit, Phase::kAsking, asks ? machine_.wait_cycles : 0);
}

// ---- Handing out --------------------------------------------------------------------------------

// A place that is free, told to the dispatcher.
void PassClock::Request(Unit& unit) {
  if (machine_.dispatcher_cycles == 0 || next_item_ == items_) return;
  const size_t held = unit.grants.size() + unit.current.any() + unit.next.any();
  if (held >= Places()) return;
  dispatcher_free_ = std::max(dispatcher_free_, now_) + machine_.dispatcher_cycles;
  unit.grants.push_back({next_item_++, dispatcher_free_});
}

// False: there is none, or none yet and other work to do.
bool PassClock::StartDraw(Unit& unit) {
  if (machine_.dispatcher_cycles > 0) {
    if (unit.grants.empty()) return false;
    const Cycles ready = unit.grants.front().ready;
    if (ready > now_ && unit.current.any()) return false;
    Spend(unit, Phase::kDrawing, std::max(ready - now_, Cycles{0}) + machine_.draw_cycles);
    return true;
  }
  if (unit.exhausted) return false;
  line_free_ = std::max(line_free_, now_) + machine_.draw_cycles;
  Spend(unit, Phase::kDrawing, line_free_ - now_);
  return true;
}

void PassClock::EndDraw(uint32_t u) {
  Unit& unit = units_[u];
  uint32_t item = items_;
  if (machine_.dispatcher_cycles > 0) {
    item = unit.grants.front().item;
    unit.grants.pop_front();
  } else if (next_item_ < items_) {
    item = next_item_++;
  }
  EndSlice(unit, UnitWork::kDispatch, item < items_ ? item : kNoBlock);
  if (item == items_) {
    unit.exhausted = true;
    return Spend(unit, Phase::kFree, 0);
  }
  unit.drawn = {item, &source_->Take(u, item), kNone, kNone};
  unit.items.push_back(item);
  Count(*unit.drawn.work);
  const bool brings_code = !unit.has_parameters && machine_.local_store_bytes > 0;
  Spend(unit, Phase::kGivingGet,
        machine_.command_cycles * Cycles(unit.drawn.work->get.commands + (brings_code ? 1 : 0)));
}

void PassClock::Count(const ItemWork& work) {
  pass_->items += !work.stages.empty();
  for (const ItemWork::StageTime& stage : work.stages) ++frame_->stage_items[stage.stage];
  uint64_t bytes = 0;
  for (const ItemWork::StreamBytes& s : work.streams) {
    frame_->stream_get_bytes[size_t(s.stream)] += s.get_bytes;
    frame_->stream_put_bytes[size_t(s.stream)] += s.put_bytes;
    pass_->get_bytes += s.get_bytes;
    pass_->put_bytes += s.put_bytes;
    bytes += s.get_bytes + s.put_bytes;
  }
  pass_->wasted_bytes += work.get.bytes + work.put.bytes - bytes;
}

// ---- Blocks in and out --------------------------------------------------------------------------

uint32_t PassClock::Move(uint32_t u, bool put, const TransferShape& shape, uint32_t item,
                         uint32_t after) {
  if (shape.bytes == 0) return kNone;
  const uint32_t transfer = transfers_.Start(now_, u, put, shape, after);
  if (timelines_) {
    auto& slices = frame_->units[u].transfers;
    moved_.push_back({u, uint32_t(slices.size()), transfer});
    slices.push_back({put, work_->pass, item, 0, 0, shape.bytes});
  }
  return transfer;
}

void PassClock::StartGet(uint32_t u) {
  Unit& unit = units_[u];
  EndSlice(unit, UnitWork::kCommands, unit.drawn.item);
  if (!unit.has_parameters && machine_.local_store_bytes > 0) {
    const uint64_t bytes =
        work_->parameter_bytes + (unit.code_pass == work_->pass ? 0 : work_->code_bytes);
    const uint64_t line = machine_.line_bytes;
    const auto lines = uint32_t((bytes + line - 1) / line);
    unit.code = Move(u, false, {lines * line, 1, 0, lines}, kNoBlock, kNone);
    unit.code_pass = work_->pass;
    pass_->code_bytes += bytes;
  }
  unit.has_parameters = true;

  // The buffer it comes into is free when the item before last (or the last) is put.
  Held& held = unit.current.any() ? unit.next : unit.current;
  held = unit.drawn;
  unit.drawn = {};
  const size_t back = unit.current.work == held.work ? Places() : Places() - 1;
  if (machine_.local_store_bytes > 0 && unit.puts.size() >= back)
    held.buffer_put = unit.puts[unit.puts.size() - back];
  held.get = Move(u, false, held.work->get, held.item, held.buffer_put);
  Spend(unit, Phase::kFree, 0);
}

// Stands for one thing after another: code, a free buffer, blocks. Each is a cause of its own.
void PassClock::Stand(uint32_t u) {
  Unit& unit = units_[u];
  struct Cause {
    uint32_t transfer;
    UnitWork work;
  };
  const Cause causes[] = {{unit.code, UnitWork::kCode},
                          {unit.current.buffer_put, UnitWork::kPutStall},
                          {unit.current.get, UnitWork::kGetStall}};
  for (const Cause& cause : causes) {
    if (cause.transfer == kNone) continue;
    if (transfers_.DoneAt(cause.transfer) > now_) {
      unit.phase = Phase::kStanding;
      unit.waits_for = cause.transfer;
      return;
    }
    if (unit.waits_for == cause.transfer) EndSlice(unit, cause.work, unit.current.item);
  }
  unit.code = kNone;
  StartCompute(u);
}

void PassClock::StartPut(uint32_t u) {
  Unit& unit = units_[u];
  EndSlice(unit, UnitWork::kCommands, unit.current.item);
  unit.puts.push_back(Move(u, true, unit.current.work->put, unit.current.item, kNone));
  if (unit.puts.size() > 2) unit.puts.erase(unit.puts.begin());
  unit.current = unit.next;
  unit.next = {};
  Spend(unit, Phase::kFree, 0);
}

// Lines leave a cache by themselves; what an SPU has put must be there before others read it.
void PassClock::Drain(Unit& unit) {
  if (machine_.local_store_bytes > 0)
    for (const uint32_t put : unit.puts)
      if (put != kNone && transfers_.DoneAt(put) > now_) {
        unit.phase = Phase::kDraining;
        unit.waits_for = put;
        return;
      }
  EndSlice(unit, UnitWork::kPutStall, kNoBlock);
  unit.phase = Phase::kFinished;
}

// ---- Computing ----------------------------------------------------------------------------------

bool PassClock::SharesCore(uint32_t u) const {
  const uint32_t first = u / machine_.threads_per_core * machine_.threads_per_core;
  for (uint32_t v = first; v < std::min(first + machine_.threads_per_core, machine_.units); ++v)
    if (v != u && units_[v].phase == Phase::kComputing) return true;
  return false;
}

// Of the machine's code.
ItemWork::CodeTime PassClock::TimeOf(const ItemWork::StageTime& stage) const {
  const auto between = [&](double scheduled, double as_written) {
    return scheduled + machine_.code_order * (as_written - scheduled);
  };
  return {between(stage.scheduled.cycles, stage.as_written.cycles),
          between(stage.scheduled.shared_cycles, stage.as_written.shared_cycles)};
}

void PassClock::StartCompute(uint32_t u) {
  Unit& unit = units_[u];
  unit.cycles = unit.shared_cycles = 0.0;
  for (const ItemWork::StageTime& stage : unit.current.work->stages) {
    const ItemWork::CodeTime time = TimeOf(stage);
    unit.cycles += time.cycles;
    unit.shared_cycles += time.shared_cycles;
  }
  if (machine_.compute_is_free) unit.cycles = unit.shared_cycles = 0.0;
  unit.left = 1.0;
  unit.pace = 0.0;
  unit.compute_begin = unit.clocked = now_;
  unit.phase = Phase::kComputing;
  unit.waits_for = kNone;
  ReclockCore(u);
}

void PassClock::ReclockCore(uint32_t u) {
  const uint32_t first = u / machine_.threads_per_core * machine_.threads_per_core;
  for (uint32_t v = first; v < std::min(first + machine_.threads_per_core, machine_.units); ++v)
    if (units_[v].phase == Phase::kComputing) Reclock(v);
}

void PassClock::Reclock(uint32_t u) {
  Unit& unit = units_[u];
  if (unit.pace > 0.0) unit.left -= double(now_ - unit.clocked) / unit.pace;
  unit.pace = SharesCore(u) ? unit.shared_cycles : unit.cycles;
  unit.clocked = now_;
  unit.wake = now_ + std::max(WholeCycles(unit.left * unit.pace), Cycles{0});
}

void PassClock::EndCompute(uint32_t u) {
  Unit& unit = units_[u];
  // Stages take their shares of the whole; rounded so that they add up to it.
  const Cycles length = now_ - unit.compute_begin;
  double done = 0.0;
  Cycles told = 0;
  for (const ItemWork::StageTime& stage : unit.current.work->stages) {
    done += TimeOf(stage).cycles;
    const Cycles until =
        unit.cycles > 0.0 ? Cycles(std::llround(double(length) * done / unit.cycles)) : 0;
    frame_->stage_cycles[stage.stage] += until - told;
    told = until;
  }
  EndSlice(unit, UnitWork::kCompute, unit.current.item);
  Spend(unit, Phase::kGivingPut, machine_.command_cycles * Cycles(unit.current.work->put.commands));
  ReclockCore(u);
}

// ---- The end of a pass --------------------------------------------------------------------------

void PassClock::Meet() {
  Cycles last = pass_->begin;
  for (uint32_t u = 0; u < units_.size(); ++u)
    if (units_[u].since > last) {
      last = units_[u].since;
      pass_->last_unit = u;
    }
  now_ = last;
  for (Unit& unit : units_) EndSlice(unit, UnitWork::kImbalance, kNoBlock);
  now_ += machine_.barrier_cycles;
  for (Unit& unit : units_) {
    EndSlice(unit, UnitWork::kBarrier, kNoBlock);
    for (uint32_t w = 0; w < kUnitWorkCount; ++w) pass_->unit_cycles[w] += unit.spent[w];
  }
  pass_->last_unit_cycles = units_[pass_->last_unit].spent;
  pass_->last_unit_items = units_[pass_->last_unit].items;
  pass_->end = frame_->cycles = now_;
  transfers_.AdvanceTo(now_);
  // Lines that leave a cache flow on beside the next pass; what the frame does not wait for ends
  // with it.
  for (const Moved& moved : moved_) {
    TransferSlice& slice = frame_->units[moved.unit].transfers[moved.slice];
    slice.begin = std::min(transfers_.BegunAt(moved.transfer), now_);
    slice.end = std::min(transfers_.DoneAt(moved.transfer), now_);
  }
  std::erase_if(moved_, [&](const Moved& m) { return transfers_.DoneAt(m.transfer) <= now_; });
}

void PassClock::EndSlice(Unit& unit, UnitWork work, uint32_t item) {
  if (now_ == unit.since) return;
  unit.spent[size_t(work)] += now_ - unit.since;
  if (timelines_)
    frame_->units[size_t(&unit - units_.data())].slices.push_back(
        {work, work_->pass, item, unit.since, now_});
  unit.since = now_;
}

void PassClock::Spend(Unit& unit, Phase phase, Cycles cycles) {
  unit.phase = phase;
  unit.wake = now_ + cycles;
  unit.waits_for = kNone;
}

// ---- Again --------------------------------------------------------------------------------------

ModelledFrame TimeFrame(const FrameWork& work, const ConsoleMachine& machine) {
  struct Recorded final : WorkSource {
    const PassWork* pass = nullptr;
    const ItemWork& Take(uint32_t, uint32_t item) override { return pass->items[item]; }
  };
  Recorded source;
  PassClock clock(machine);
  ModelledFrame frame;
  clock.BeginFrame(work, false, frame);
  for (const PassWork& pass : work.passes) {
    source.pass = &pass;
    clock.Run(pass, uint32_t(pass.items.size()), source, frame);
  }
  return frame;
}

}  // namespace pelt
