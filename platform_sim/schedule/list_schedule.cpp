#include "platform_sim/schedule/list_schedule.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "platform_sim/schedule/register_guard.hpp"

namespace pelt {
namespace {

constexpr uint32_t kUnits = 8;
// How many of a unit's most urgent instructions are looked at in a cycle in which none fits. More
// find hardly anything (measured: 48 the same schedules as 16) and cost time.
constexpr uint32_t kMostTries = 16;

// Ranks that are in, lowest first.
class RankSet {
 public:
  explicit RankSet(uint32_t size) : words_((size + 63) / 64), lowest_word_(words_.size()) {}

  void Insert(uint32_t rank) {
    words_[rank / 64] |= uint64_t{1} << rank % 64;
    lowest_word_ = std::min<size_t>(lowest_word_, rank / 64);
  }
  void Erase(uint32_t rank) {
    words_[rank / 64] &= ~(uint64_t{1} << rank % 64);
    while (lowest_word_ < words_.size() && words_[lowest_word_] == 0) ++lowest_word_;
  }
  // The first one for which `accept` is true, below `end`.
  template <class Accept>
  uint32_t First(uint32_t end, const Accept& accept) const {
    for (size_t w = lowest_word_; w < words_.size() && w * 64 < end; ++w)
      for (uint64_t bits = words_[w]; bits; bits &= bits - 1) {
        const uint32_t rank = uint32_t(w * 64) + uint32_t(std::countr_zero(bits));
        if (rank >= end) return kNoInstruction;
        if (accept(rank)) return rank;
      }
    return kNoInstruction;
  }

 private:
  std::vector<uint64_t> words_;
  size_t lowest_word_;
};

class Scheduling {
 public:
  Scheduling(uint32_t window, const ScheduleInput& input)
      : in_(input),
        size_(uint32_t(input.code.program.size())),
        window_(window),
        guard_(input.code, input.uses, input.core),
        rank_(size_),
        edges_left_(size_),
        earliest_(size_, 0),
        is_ready_(size_, false),
        is_waiting_for_window_(size_, false) {
    for (uint32_t r = 0; r < size_; ++r) rank_[in_.by_urgency[r]] = r;
    uint32_t latest = 1;
    for (uint32_t i = 0; i < size_; ++i) {
      edges_left_[i] = in_.graph.EdgesInto(i);
      for (const DependenceGraph::Edge& edge : in_.graph.After(i))
        latest = std::max(latest, edge.cycles);
      AddUnits(ClassOf(i).units);
    }
    due_.resize(std::bit_ceil(latest + 1));
  }

  IssueOrder Run() {
    out_.instruction.reserve(size_);
    out_.cycle.reserve(size_);
    for (uint32_t i = 0; i < size_; ++i)
      if (edges_left_[i] == 0) BecomeReady(i);
    for (now_ = 0; out_.instruction.size() < size_; ++now_) {
      std::vector<uint32_t>& due = due_[size_t(now_) & (due_.size() - 1)];
      for (const uint32_t i : due) BecomeReady(i);
      due.clear();
      IssueCycle();
    }
    return std::move(out_);
  }

 private:
  struct Unit {
    uint8_t units;
    RankSet ready;
  };

  const SchedulingCore::Class& ClassOf(uint32_t i) const {
    return in_.core.classes[in_.code.program[i].op_class];
  }

  void AddUnits(uint8_t units) {
    for (const Unit& unit : ready_)
      if (unit.units == units) return;
    ready_.push_back({units, RankSet(size_)});
  }

  RankSet& ReadyOf(uint32_t i) {
    const uint8_t units = ClassOf(i).units;
    return std::ranges::find(ready_, units, &Unit::units)->ready;
  }

  void BecomeReady(uint32_t i) {
    is_ready_[i] = true;
    if (i - guard_.head() < window_ || i < guard_.head())
      ReadyOf(i).Insert(rank_[i]);
    else
      is_waiting_for_window_[i] = true;
  }

  void MoveWindow(uint32_t head_before) {
    const uint64_t end = std::min<uint64_t>(uint64_t{guard_.head()} + window_, size_);
    for (uint64_t i = uint64_t{head_before} + window_; i < end; ++i)
      if (is_waiting_for_window_[i]) ReadyOf(uint32_t(i)).Insert(rank_[i]);
  }

  // The even pipe's instruction is chosen first where it comes first in the fetch group too: what
  // it writes cannot take a register that only its partner frees.
  void IssueCycle() {
    uint8_t used = 0;
    for (uint32_t u = 0; u < kUnits; ++u)
      if (unit_free_[u] > now_) used |= uint8_t(1u << u);
    if (in_.core.fetch_groups) {
      const uint8_t first = in_.core.fetch_groups->first_units;
      used |= IssueOne(used, [&](uint8_t units) { return (units & first) != 0; });
      IssueOne(used, [&](uint8_t units) { return (units & first) == 0; });
      return;
    }
    for (uint32_t n = 0; n < in_.core.width; ++n) {
      const uint8_t taken = IssueOne(used, [](uint8_t) { return true; });
      if (taken == 0 || ClassOf(out_.instruction.back()).ends_cycle) return;
      used |= taken;
    }
  }

  // The units it takes; 0: none issued.
  template <class Suits>
  uint8_t IssueOne(uint8_t used, const Suits& suits) {
    uint32_t best = kNoInstruction;
    for (const Unit& unit : ready_) {
      if ((unit.units & used) || !suits(unit.units)) continue;
      uint32_t tries = kMostTries;
      const uint32_t found = unit.ready.First(best, [&](uint32_t rank) {
        const uint32_t i = in_.by_urgency[rank];
        return tries-- == 0 || (!IsHeld(i) && guard_.Fits(i));
      });
      if (tries > kMostTries) continue;  // wrapped: gave up
      if (found != kNoInstruction) best = found;
    }
    // The oldest one always fits, whatever its urgency.
    const uint32_t head = guard_.head();
    if (best == kNoInstruction && head < size_ && is_ready_[head] &&
        !(ClassOf(head).units & used) && suits(ClassOf(head).units) && !IsHeld(head))
      best = rank_[head];
    if (best == kNoInstruction) return 0;
    const uint32_t i = in_.by_urgency[best];
    ReadyOf(i).Erase(best);
    Issue(i);
    return ClassOf(i).units;
  }

  bool IsHeld(uint32_t i) const {
    const SchedulingCore::Hold& hold = in_.core.hold;
    return in_.code.program[i].op_class == hold.held_class && now_ > last_holding_ &&
           now_ <= last_holding_ + hold.cycles;
  }

  void Issue(uint32_t i) {
    const uint32_t head = guard_.head();
    guard_.Issue(i);
    out_.instruction.push_back(i);
    out_.cycle.push_back(now_);
    const SchedulingCore::Class& op = ClassOf(i);
    for (uint32_t u = 0; u < kUnits; ++u)
      if (op.blocks_units >> u & 1) unit_free_[u] = now_ + op.blocked_cycles;
    if (in_.code.program[i].op_class == in_.core.hold.behind_class) last_holding_ = now_;
    for (const DependenceGraph::Edge& edge : in_.graph.After(i)) {
      earliest_[edge.to] = std::max(earliest_[edge.to], now_ + edge.cycles);
      if (--edges_left_[edge.to] == 0) Wait(edge.to);
    }
    MoveWindow(head);
  }

  void Wait(uint32_t i) {
    const int64_t cycle = std::max(earliest_[i], now_ + 1);
    due_[size_t(cycle) & (due_.size() - 1)].push_back(i);
  }

  const ScheduleInput& in_;
  const uint32_t size_, window_;
  RegisterGuard guard_;
  std::vector<uint32_t> rank_;  // of each instruction, in by_urgency
  std::vector<uint32_t> edges_left_;
  std::vector<int64_t> earliest_;
  std::vector<bool> is_ready_, is_waiting_for_window_;
  std::vector<Unit> ready_;                 // by units
  std::vector<std::vector<uint32_t>> due_;  // by cycle, around
  std::array<int64_t, kUnits> unit_free_{};
  int64_t now_ = 0, last_holding_ = -1'000'000;
  IssueOrder out_;
};

std::vector<uint32_t> OrderByUrgency(const StraightCode& code, const DependenceGraph& graph,
                                     const SchedulingCore& core) {
  const int64_t size = int64_t(code.program.size());
  const int64_t pace_cycles = ResourceBoundCycles(code.program, core);
  std::vector<int64_t> urgency;
  for (int64_t i = 0; i < size; ++i)
    urgency.push_back(i * pace_cycles / size - int64_t{graph.Height(uint32_t(i))});
  std::vector<uint32_t> out(code.program.size());
  std::iota(out.begin(), out.end(), 0u);
  std::ranges::stable_sort(out, {}, [&](uint32_t i) { return urgency[i]; });
  return out;
}

}  // namespace

ScheduleInput::ScheduleInput(const StraightCode& fitted_code, const SchedulingCore& for_core)
    : code(fitted_code),
      core(for_core),
      uses(code),
      graph(code, uses, core),
      by_urgency(OrderByUrgency(code, graph, core)) {}

IssueOrder ScheduleWithin(uint32_t window, const ScheduleInput& input) {
  return Scheduling(window, input).Run();
}

}  // namespace pelt
