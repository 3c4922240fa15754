#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "platform_sim/schedule/schedule.hpp"

namespace pelt {
namespace {

// Lets instructions of straight code go before their turn as long as the rest can still run in
// program order without a spill.
//
// Idea: how many registers each gap of the program would take if, from now on, all that is left ran
// in program order, is known:
//
//   gap (before instruction)   h .. . . . . . j .. . .        h: the first that has not issued
//   j issued now               +1 for what it writes: live in h .. j already
//                              -1 for what it was the last to read: its life ends at the reader
//                                 before j that has not issued, or now
//
// An instruction may issue when no gap then overflows. So the order that was fitted to the
// registers always remains as a way out, and no choice can end without a register.
//
// Invariant: Fits() is true for the first instruction that has not issued, regardless of what went before.

// Numbers in a row, changed by ranges; both ends of a range belong to it. Small numbers: the
// registers of a file (kMostSchedulingRegisters), so that a block's maximum is a few operations.
class PressureProfile {
 public:
  void Resize(size_t gaps);
  void Add(uint32_t first, uint32_t last, int32_t change);
  int32_t At(uint32_t gap) const { return whole_[gap / kBlock] + gap_[gap]; }
  // The first gap of the range with more than `limit`; `last` + 1: none.
  uint32_t FirstAbove(int32_t limit, uint32_t first, uint32_t last) const;

 private:
  static constexpr uint32_t kBlock = 32;

  std::vector<int16_t> gap_;          // without what its whole block has
  std::vector<int16_t> whole_, max_;  // of each block; max_ with whole_ in it
};

class RegisterGuard {
 public:
  // The code fits (FitRegisters).
  RegisterGuard(const StraightCode& code, const ValueUses& uses, const SchedulingCore& core);

  // The first instruction that has not issued; the program's size when all have.
  uint32_t head() const { return head_; }
  bool HasIssued(uint32_t instruction) const { return has_issued_[instruction]; }
  bool Fits(uint32_t instruction) const;
  void Issue(uint32_t instruction);

 private:
  // The last reader of `value` before `instruction`, its last one, that has not issued.
  uint32_t ReaderBefore(uint32_t value, uint32_t instruction) const;
  bool IsLastReader(uint32_t value, uint32_t instruction) const;

  const StraightCode& code_;
  const ValueUses& uses_;
  const SchedulingCore& core_;
  std::array<PressureProfile, kValueFileCount> pressure_;
  // Where an instruction last did not fit: mostly the next one fails there too.
  mutable std::array<uint32_t, kValueFileCount> tight_gap_{};
  std::vector<uint32_t> readers_left_;  // of each value: those up to the last that has not issued
  std::vector<bool> has_issued_;
  uint32_t head_ = 0;
};

void PressureProfile::Resize(size_t gaps) {
  const size_t blocks = (gaps + kBlock - 1) / kBlock;
  gap_.assign(blocks * kBlock, 0);
  whole_.assign(blocks, 0);
  max_.assign(blocks, 0);
}

void PressureProfile::Add(uint32_t first, uint32_t last, int32_t change) {
  for (uint32_t block = first / kBlock; block <= last / kBlock; ++block) {
    const uint32_t begin = std::max(first, block * kBlock);
    const uint32_t end = std::min(last + 1, (block + 1) * kBlock);
    if (end - begin == kBlock) {
      whole_[block] = int16_t(whole_[block] + change);
      max_[block] = int16_t(max_[block] + change);
      continue;
    }
    for (uint32_t gap = begin; gap < end; ++gap) gap_[gap] = int16_t(gap_[gap] + change);
    const int16_t* of_block = &gap_[size_t{block} * kBlock];
    int16_t most = of_block[0];
    for (uint32_t i = 0; i < kBlock; ++i) most = std::max(most, of_block[i]);
    max_[block] = int16_t(whole_[block] + most);
  }
}

uint32_t PressureProfile::FirstAbove(int32_t limit, uint32_t first, uint32_t last) const {
  for (uint32_t block = first / kBlock; block <= last / kBlock; ++block) {
    if (max_[block] <= limit) continue;
    const uint32_t end = std::min(last + 1, (block + 1) * kBlock);
    for (uint32_t gap = std::max(first, block * kBlock); gap < end; ++gap)
      if (At(gap) > limit) return gap;
  }
  return last + 1;
}

RegisterGuard::RegisterGuard(const StraightCode& code, const ValueUses& uses,
                             const SchedulingCore& core)
    : code_(code),
      uses_(uses),
      core_(core),
      readers_left_(code.value_count()),
      has_issued_(code.program.size()) {
  for (uint32_t f = 0; f < kValueFileCount; ++f)
    pressure_[f].Resize(core.files[f].count ? code.program.size() + 1 : 0);
  for (uint32_t v = 0; v < code.value_count(); ++v) {
    const auto readers = uses.ReadersOf(v);
    const uint32_t writer = uses.WriterOf(v);
    readers_left_[v] = uint32_t(readers.size());
    if (writer == kNoTarget && readers.empty()) continue;
    const uint32_t first = writer == kNoTarget ? 0 : writer + 1;
    pressure_[uint32_t(code.file[v])].Add(first, readers.empty() ? first : readers.back(), 1);
  }
}

uint32_t RegisterGuard::ReaderBefore(uint32_t value, uint32_t instruction) const {
  const std::span<const uint32_t> readers = uses_.ReadersOf(value);
  for (uint32_t r = readers_left_[value]; r-- > 0;)
    if (readers[r] != instruction && !has_issued_[readers[r]]) return readers[r];
  return kNoInstruction;
}

bool RegisterGuard::IsLastReader(uint32_t value, uint32_t instruction) const {
  return uses_.ReadersOf(value)[readers_left_[value] - 1] == instruction;
}

// What it writes is live from the head on; what it frees makes up for that behind each freed
// value's new last reader, one for one.
bool RegisterGuard::Fits(uint32_t instruction) const {
  if (instruction == head_) return true;
  const Instruction& it = code_.program[instruction];
  for (uint32_t f = 0; f < kValueFileCount; ++f) {
    int32_t written = 0;
    for (const uint32_t value : it.writes) written += uint32_t(code_.file[value]) == f;
    if (written == 0) continue;
    // Of freed values: the first gap that each is no longer live in, ascending.
    std::array<uint32_t, 5> life_end;
    life_end.fill(instruction + 1);
    for (uint32_t r = 0; r < it.reads.count; ++r) {
      const uint32_t value = it.reads.number[r];
      if (uint32_t(code_.file[value]) != f || !IsLastReader(value, instruction)) continue;
      const auto earlier = std::span(it.reads.number).first(r);
      if (std::ranges::find(earlier, value) != earlier.end()) continue;
      const uint32_t reader = ReaderBefore(value, instruction);
      uint32_t end = reader == kNoInstruction ? head_ : reader + 1;
      for (uint32_t& later : life_end)
        if (end < later) std::swap(end, later);
    }
    const int32_t limit = int32_t(core_.files[f].count);
    const uint32_t tight = tight_gap_[f];
    uint32_t first = head_;
    for (int32_t more = written; more > 0; --more) {
      const uint32_t end = life_end[uint32_t(written - more)];  // of three at most
      if (end <= first) continue;
      if (first <= tight && tight < end && pressure_[f].At(tight) + more > limit) return false;
      const uint32_t above = pressure_[f].FirstAbove(limit - more, first, end - 1);
      if (above < end) {
        tight_gap_[f] = above;
        return false;
      }
      first = end;
    }
  }
  return true;
}

void RegisterGuard::Issue(uint32_t instruction) {
  const Instruction& it = code_.program[instruction];
  has_issued_[instruction] = true;
  for (const uint32_t value : it.reads) {
    uint32_t& left = readers_left_[value];
    // A second mention finds it done.
    if (left == 0 || !IsLastReader(value, instruction)) continue;
    const auto readers = uses_.ReadersOf(value);
    while (left > 0 && has_issued_[readers[left - 1]]) --left;
    const uint32_t life_end = left == 0 ? head_ : readers[left - 1] + 1;
    if (instruction != head_ && life_end <= instruction)
      pressure_[uint32_t(code_.file[value])].Add(life_end, instruction, -1);
  }
  for (const uint32_t value : it.writes) {
    if (instruction == head_) continue;
    PressureProfile& pressure = pressure_[uint32_t(code_.file[value])];
    if (readers_left_[value] == 0)
      pressure.Add(instruction + 1, instruction + 1, -1);  // nothing reads it: gone at once
    else
      pressure.Add(head_, instruction, 1);
  }
  while (head_ < code_.program.size() && has_issued_[head_]) ++head_;
}

constexpr uint32_t kIssueUnits = 8;
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
    for (uint32_t u = 0; u < kIssueUnits; ++u)
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
    // The oldest one always fits, regardless of its urgency.
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
    for (uint32_t u = 0; u < kIssueUnits; ++u)
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
  std::array<int64_t, kIssueUnits> unit_free_{};
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
