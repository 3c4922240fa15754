#include "platform_sim/frame/frame_clock.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

#include "jobs/frame.hpp"

namespace pelt {

FrameClock::FrameClock(const ConsoleMachine& machine)
    : machine_(machine), transfers_(machine.memory, machine.units), units_(machine.units) {}

void FrameClock::Run(const FrameWork& work, WorkSource& source, bool timelines,
                     ModelledFrame& frame) {
  Begin(work, source, frame);
  frame.units.assign(timelines ? units_.size() : 0, {});
  Fire(0, kNone);
  for (;;) {
    OpenDue();
    // One step each in turn, so that in one cycle no unit takes two items before another has one.
    for (bool again = true; again;) {
      again = false;
      for (uint32_t u = 0; u < units_.size(); ++u)
        if (IsDue(units_[u])) {
          Step(u);
          OpenDue();
          again = true;
        }
    }
    if (now_ >= over_at_) break;
    now_ = NextWake();
    transfers_.AdvanceTo(now_);
    FinishPuts();
  }
  End(timelines);
}

void FrameClock::Begin(const FrameWork& work, WorkSource& source, ModelledFrame& frame) {
  work_ = &work;
  source_ = &source;
  frame_ = &frame;
  transfers_ = SharedTransfers(machine_.memory, machine_.units);
  now_ = line_free_ = dispatcher_free_ = 0;
  over_at_ = SharedTransfers::kNever;
  pending_.clear();
  for (const FrameGraph::Node& node : work.graph.nodes) pending_.push_back(node.waits_for);
  ready_.assign(work.passes.size(), {});
  ready_count_ = 0;
  openings_.clear();
  flying_.clear();
  ends_.clear();
  moved_.clear();
  frame.BeginWith(work);
  for (Unit& unit : units_) {
    const uint32_t code_pass = unit.code_pass;
    unit = {};
    unit.code_pass = code_pass;  // from the frame before
  }
}

// ---- What is open -------------------------------------------------------------------------------

// What the end opens is seen by others a while later.
void FrameClock::Fire(uint32_t node, uint32_t by) {
  const FrameGraph& graph = work_->graph;
  const Cycles at = by == kNone ? now_ : now_ + machine_.barrier_cycles;
  if (node == graph.LastNode()) {
    last_end_ = by;
    over_at_ = at;
    return;
  }
  graph.ForEachOpened(node, [&](uint32_t pass, uint32_t item, uint32_t) {
    openings_.push_back({at, {pass, item, by}});
  });
  for (uint32_t n = graph.nodes[node].first_next; n < graph.nodes[node + 1].first_next; ++n)
    Count(graph.next[n], by);
}

void FrameClock::Count(uint32_t node, uint32_t by) {
  if (--pending_[node] == 0) Fire(node, by);
}

void FrameClock::Finish(const ItemEnd& end) {
  ends_.push_back(end);
  ends_.back().done = now_;
  ModelledPass& pass = frame_->passes[end.pass];
  pass.end = std::max(pass.end, now_);
  Count(end.node, uint32_t(ends_.size()) - 1);
}

void FrameClock::FinishPuts() {
  for (size_t i = 0; i < flying_.size();)
    if (transfers_.DoneAt(flying_[i].put) <= now_) {
      const ItemEnd end = flying_[i];
      flying_.erase(flying_.begin() + std::ptrdiff_t(i));
      Finish(end);
    } else {
      ++i;
    }
}

void FrameClock::OpenDue() {
  while (!openings_.empty() && openings_.front().at <= now_) {
    const Ready ready = openings_.front().ready;
    openings_.pop_front();
    auto& heap = ready_[ready.pass];
    heap.push_back(ready);
    std::ranges::push_heap(heap, std::greater{}, RankIn(ready.pass));
    ++ready_count_;
  }
  for (uint32_t place = 0; place < 2; ++place)
    for (Unit& unit : units_) Request(unit);
}

FrameClock::Ready FrameClock::TakeReady(const Unit& unit) {
  uint32_t pass = uint32_t(ready_.size()) - 1;
  while (ready_[pass].empty()) --pass;
  const bool is_last = units_.size() > 1 && &unit == &units_.back();
  if (!is_last && !ready_[unit.pass].empty()) pass = unit.pass;
  auto& heap = ready_[pass];
  std::ranges::pop_heap(heap, std::greater{}, RankIn(pass));
  const Ready ready = heap.back();
  heap.pop_back();
  --ready_count_;
  return ready;
}

// ---- Units --------------------------------------------------------------------------------------

bool FrameClock::IsDue(const Unit& unit) const {
  if (unit.phase == Phase::kIdle)
    return machine_.dispatcher_cycles > 0 ? !unit.grants.empty() : HasReady();
  return WakeOf(unit) <= now_;
}

Cycles FrameClock::NextWake() const {
  Cycles next = std::min(transfers_.NextEvent(), over_at_);
  if (!openings_.empty()) next = std::min(next, openings_.front().at);
  for (const ItemEnd& end : flying_) next = std::min(next, transfers_.DoneAt(end.put));
  for (const Unit& unit : units_)
    if (unit.phase != Phase::kIdle) next = std::min(next, WakeOf(unit));
  assert(next != SharedTransfers::kNever);
  return std::max(next, now_);
}

void FrameClock::Step(uint32_t u) {
  Unit& unit = units_[u];
  switch (unit.phase) {
    case Phase::kFree:
    case Phase::kIdle:
      return Decide(u);
    case Phase::kDrawing:
      return EndDraw(u);
    case Phase::kGivingGet:
      return StartGet(u);
    case Phase::kAsking:
      EndSlice(unit, UnitWork::kCommands, unit.current.pass, unit.current.item);
      return Stand(u);
    case Phase::kStanding:
      return Stand(u);
    case Phase::kComputing:
      return EndCompute(u);
    case Phase::kGivingPut:
      return StartPut(u);
    case Phase::kDraining:
      EndSlice(unit, UnitWork::kPutStall, unit.pass, kNoBlock);
      return Spend(unit, Phase::kFree, 0);
    case Phase::kLooking:
      EndSlice(unit, UnitWork::kDispatch, unit.pass, kNoBlock);
      unit.phase = Phase::kIdle;
      return;
  }
}

void FrameClock::Decide(uint32_t u) {
  Unit& unit = units_[u];
  if (unit.drawn.any() && !Waits(unit, unit.drawn.pass)) {  // it was drawn while another was held
    if (!Drains(unit)) GiveGet(unit);
    return;
  }
  Request(unit);
  const bool has_room = !unit.current.any() || (Places(unit.pass) == 2 && !unit.next.any());
  if (has_room && !unit.drawn.any() && StartDraw(unit)) return;
  if (unit.current.any()) {
    const bool asks =
        unit.current.get != SharedTransfers::kNone || unit.code != SharedTransfers::kNone;
    return Spend(unit, Phase::kAsking, asks ? machine_.wait_cycles : 0);
  }
  if (unit.phase == Phase::kIdle || Drains(unit)) return;
  Spend(unit, Phase::kLooking, machine_.dispatcher_cycles > 0 ? 0 : machine_.draw_cycles);
}

// Lines leave a cache by themselves; a store's buffers are free when all is put.
bool FrameClock::Drains(Unit& unit) {
  if (!HasStores()) return false;
  for (const uint32_t put : unit.puts)
    if (put != SharedTransfers::kNone && transfers_.DoneAt(put) > now_) {
      unit.phase = Phase::kDraining;
      unit.waits_for = put;
      return true;
    }
  unit.puts.clear();
  return false;
}

// ---- Handing out --------------------------------------------------------------------------------

// Reports a free place to the dispatcher.
void FrameClock::Request(Unit& unit) {
  if (machine_.dispatcher_cycles == 0 || !HasReady()) return;
  const size_t held = unit.grants.size() + unit.current.any() + unit.next.any() + unit.drawn.any();
  if (held >= Places(unit.pass)) return;
  dispatcher_free_ = std::max(dispatcher_free_, now_) + machine_.dispatcher_cycles;
  unit.grants.push_back({TakeReady(unit), dispatcher_free_});
}

// False: there is none, or none yet and other work to do.
bool FrameClock::StartDraw(Unit& unit) {
  Cycles from = now_;
  if (machine_.dispatcher_cycles > 0) {
    if (unit.grants.empty()) return false;
    const Grant grant = unit.grants.front();
    if (grant.at > now_ && unit.current.any()) return false;
    unit.grants.pop_front();
    unit.drawing = grant.ready;
    from = std::max(grant.at, now_);
  } else {
    if (!HasReady()) return false;
    unit.drawing = TakeReady(unit);
    from = std::max(line_free_, now_);
    line_free_ = from + machine_.draw_cycles;
  }
  if (unit.phase == Phase::kIdle) EndIdle(unit, unit.drawing);
  Spend(unit, Phase::kDrawing, from - now_ + machine_.draw_cycles);
  return true;
}

// It stood without work until an end was seen.
void FrameClock::EndIdle(Unit& unit, const Ready& called_for) {
  if (called_for.opened_by != kNone) {
    const Cycles now = now_;
    now_ = std::clamp(ends_[called_for.opened_by].done, unit.since, now);
    EndSlice(unit, UnitWork::kImbalance, called_for.pass, kNoBlock, called_for.opened_by);
    now_ = now;
  }
  EndSlice(unit, UnitWork::kBarrier, called_for.pass, kNoBlock, called_for.opened_by);
}

void FrameClock::EndDraw(uint32_t u) {
  Unit& unit = units_[u];
  const auto [pass, item, by] = unit.drawing;
  EndSlice(unit, UnitWork::kDispatch, pass, item);
  unit.drawn = {pass, item, &source_->Take(u, pass, item)};
  frame_->Count(*unit.drawn.work, pass);
  if (Waits(unit, pass)) return Spend(unit, Phase::kFree, 0);
  if (pass != unit.pass && Drains(unit)) return;
  GiveGet(unit);
}

void FrameClock::GiveGet(Unit& unit) {
  const uint32_t code = BringsCode(unit) || BringsParameters(unit) ? 1 : 0;
  Spend(unit, Phase::kGivingGet,
        machine_.command_cycles * Cycles(unit.drawn.work->get.commands + code));
}

// ---- Blocks in and out --------------------------------------------------------------------------

uint32_t FrameClock::Move(uint32_t u, bool put, const TransferShape& shape, uint32_t pass,
                          uint32_t item, uint32_t after) {
  if (shape.bytes == 0) return SharedTransfers::kNone;
  const uint32_t transfer = transfers_.Start(now_, u, put, shape, after);
  if (!frame_->units.empty()) {
    auto& slices = frame_->units[u].transfers;
    moved_.push_back({u, uint32_t(slices.size()), transfer});
    slices.push_back({put, pass, item, 0, 0, shape.bytes});
  }
  return transfer;
}

void FrameClock::StartGet(uint32_t u) {
  Unit& unit = units_[u];
  const uint32_t pass = unit.drawn.pass;
  const PassWork& work = work_->passes[pass];
  EndSlice(unit, UnitWork::kCommands, pass, unit.drawn.item);
  if (BringsCode(unit) || BringsParameters(unit)) {
    const uint64_t bytes = work.parameter_bytes + (BringsCode(unit) ? work.code_bytes : 0);
    const uint64_t line = machine_.line_bytes;
    const auto lines = uint32_t((bytes + line - 1) / line);
    unit.code = Move(u, false, {lines * line, 1, 0, lines}, pass, kNoBlock, SharedTransfers::kNone);
    frame_->passes[pass].code_bytes += bytes;
  }
  unit.code_pass = work.pass;
  unit.parameters_pass = pass;
  unit.pass = pass;

  // The buffer it comes into is free when the item before last (or the last) is put.
  Held& held = unit.current.any() ? unit.next : unit.current;
  held = unit.drawn;
  unit.drawn = {};
  const size_t back = unit.current.work == held.work ? Places(pass) : Places(pass) - 1;
  if (HasStores() && unit.puts.size() >= back) held.buffer_put = unit.puts[unit.puts.size() - back];
  held.get = Move(u, false, held.work->get, pass, held.item, held.buffer_put);
  Spend(unit, Phase::kFree, 0);
}

// Stands for one thing after another: code, a free buffer, blocks. Each is a cause of its own.
void FrameClock::Stand(uint32_t u) {
  Unit& unit = units_[u];
  struct Cause {
    uint32_t transfer;
    UnitWork work;
  };
  const Cause causes[] = {{unit.code, UnitWork::kCode},
                          {unit.current.buffer_put, UnitWork::kPutStall},
                          {unit.current.get, UnitWork::kGetStall}};
  for (const Cause& cause : causes) {
    if (cause.transfer == SharedTransfers::kNone) continue;
    if (transfers_.DoneAt(cause.transfer) > now_) {
      unit.phase = Phase::kStanding;
      unit.waits_for = cause.transfer;
      return;
    }
    if (unit.waits_for == cause.transfer)
      EndSlice(unit, cause.work, unit.current.pass, unit.current.item);
  }
  unit.code = SharedTransfers::kNone;
  StartCompute(u);
}

void FrameClock::StartPut(uint32_t u) {
  Unit& unit = units_[u];
  const Held done = unit.current;
  EndSlice(unit, UnitWork::kCommands, done.pass, done.item);
  const uint32_t put = Move(u, true, done.work->put, done.pass, done.item, SharedTransfers::kNone);
  unit.puts.push_back(put);
  if (unit.puts.size() > 2) unit.puts.erase(unit.puts.begin());
  unit.current = unit.next;
  unit.next = {};
  if (unit.current.any()) unit.pass = unit.current.pass;
  Spend(unit, Phase::kFree, 0);

  const FrameGraph& graph = work_->graph;
  const ItemEnd end{u,    done.pass, graph.item_node[graph.pass_first[done.pass] + done.item],
                    now_, put,       0};
  if (HasStores() && put != SharedTransfers::kNone)
    flying_.push_back(end);
  else
    Finish(end);
}

// ---- Computing ----------------------------------------------------------------------------------

bool FrameClock::SharesCore(uint32_t u) const {
  const uint32_t first = u / machine_.threads_per_core * machine_.threads_per_core;
  for (uint32_t v = first; v < std::min(first + machine_.threads_per_core, machine_.units); ++v)
    if (v != u && units_[v].phase == Phase::kComputing) return true;
  return false;
}

// Of the machine's code.
ItemWork::CodeTime FrameClock::TimeOf(const ItemWork::StageTime& stage) const {
  const auto between = [&](double scheduled, double as_written) {
    return scheduled + machine_.code_order * (as_written - scheduled);
  };
  return {between(stage.scheduled.cycles, stage.as_written.cycles),
          between(stage.scheduled.shared_cycles, stage.as_written.shared_cycles)};
}

void FrameClock::StartCompute(uint32_t u) {
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
  unit.waits_for = SharedTransfers::kNone;
  ReclockCore(u);
}

void FrameClock::ReclockCore(uint32_t u) {
  const uint32_t first = u / machine_.threads_per_core * machine_.threads_per_core;
  for (uint32_t v = first; v < std::min(first + machine_.threads_per_core, machine_.units); ++v)
    if (units_[v].phase == Phase::kComputing) Reclock(v);
}

void FrameClock::Reclock(uint32_t u) {
  Unit& unit = units_[u];
  if (unit.pace > 0.0) unit.left -= double(now_ - unit.clocked) / unit.pace;
  unit.pace = SharesCore(u) ? unit.shared_cycles : unit.cycles;
  unit.clocked = now_;
  unit.wake = now_ + std::max(WholeCycles(unit.left * unit.pace), Cycles{0});
}

void FrameClock::EndCompute(uint32_t u) {
  Unit& unit = units_[u];
  const Held& held = unit.current;
  // Stages take their shares of the whole; rounded so that they add up to it.
  const Cycles length = now_ - unit.compute_begin;
  double done = 0.0;
  Cycles counted = 0;
  for (const ItemWork::StageTime& stage : held.work->stages) {
    done += TimeOf(stage).cycles;
    const Cycles until =
        unit.cycles > 0.0 ? Cycles(std::llround(double(length) * done / unit.cycles)) : 0;
    frame_->stage_cycles[stage.stage] += until - counted;
    counted = until;
  }
  EndSlice(unit, UnitWork::kCompute, held.pass, held.item);
  const Cycles says_so = HasStores() ? machine_.command_cycles : machine_.draw_cycles;
  Spend(unit, Phase::kGivingPut,
        machine_.command_cycles * Cycles(held.work->put.commands) + says_so);
  ReclockCore(u);
}

// ---- What is reported of it ---------------------------------------------------------------------

void FrameClock::EndSlice(Unit& unit, UnitWork work, uint32_t pass, uint32_t item, uint32_t cause) {
  if (now_ == unit.since) return;
  ModelledPass& of = frame_->passes[pass];
  of.unit_cycles[size_t(work)] += now_ - unit.since;
  if (item != kNoBlock) {
    if (of.end == 0) of.begin = unit.since;
    of.begin = std::min(of.begin, unit.since);
    of.end = std::max(of.end, now_);
  }
  unit.past.push_back({{work, pass, item, unit.since, now_}, cause});
  unit.since = now_;
}

void FrameClock::Spend(Unit& unit, Phase phase, Cycles cycles) {
  unit.phase = phase;
  unit.wake = now_ + cycles;
  unit.waits_for = SharedTransfers::kNone;
}

void FrameClock::End(bool timelines) {
  frame_->cycles = now_;
  if (last_end_ != kNone)
    for (Unit& unit : units_) EndIdle(unit, {ends_[last_end_].pass, kNoBlock, last_end_});
  if (now_ > 0) FindCriticalPath();
  if (!timelines) return;
  // Lines leave a cache beside what comes next; what the frame does not wait for ends with it.
  for (const Moved& moved : moved_) {
    TransferSlice& slice = frame_->units[moved.unit].transfers[moved.slice];
    slice.begin = std::min(transfers_.BegunAt(moved.transfer), now_);
    slice.end = std::min(transfers_.DoneAt(moved.transfer), now_);
  }
  for (uint32_t u = 0; u < units_.size(); ++u)
    for (const Past& past : units_[u].past) frame_->units[u].slices.push_back(past.slice);
}

// From the frame's end back to its beginning: what a unit did, until it stood without work; then
// what the unit did whose item it was called for.
void FrameClock::FindCriticalPath() {
  Cycles left = now_;  // what is before
  const auto spend = [&](uint32_t pass, UnitWork work, Cycles from) {
    frame_->passes[pass].critical_cycles[size_t(work)] += left - from;
    left = from;
  };
  uint32_t cause = last_end_;
  while (cause != kNone) {
    const ItemEnd& end = ends_[cause];
    cause = kNone;
    spend(end.pass, UnitWork::kBarrier, end.done);
    spend(end.pass, UnitWork::kPutStall, end.given);
    const std::vector<Past>& past = units_[end.unit].past;
    auto at = std::ranges::upper_bound(past, left, {}, [](const Past& p) { return p.slice.end; });
    while (at != past.begin() && cause == kNone) {
      --at;
      cause = at->cause;
      if (cause == kNone) spend(at->slice.pass, at->slice.work, at->slice.begin);
    }
  }
}

// ---- Again --------------------------------------------------------------------------------------

ModelledFrame TimeFrame(const FrameWork& work, const ConsoleMachine& machine) {
  struct Recorded final : WorkSource {
    const FrameWork& work;
    explicit Recorded(const FrameWork& w) : work(w) {}
    const ItemWork& Take(uint32_t, uint32_t pass, uint32_t item) override {
      return work.passes[pass].items[item];
    }
  };
  Recorded source(work);
  ModelledFrame frame;
  FrameClock(machine).Run(work, source, false, frame);
  return frame;
}

}  // namespace pelt
