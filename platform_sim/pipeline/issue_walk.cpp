#include "platform_sim/pipeline/issue_walk.hpp"

#include <algorithm>
#include <bit>
#include <map>

#include "core/format.hpp"

namespace pelt {
namespace {

// What a walk may issue one by one: leaps cost nothing.
constexpr size_t kMaxIssues = 8'000'000;
// States kept to compare with: the period of a loop is one iteration, or two with two threads; more
// for the few whose iterations differ.
constexpr size_t kStatesKept = 16;

bool IsBackwardBranch(const Instruction& instruction, uint32_t index) {
  return (instruction.flow == Flow::kConditional || instruction.flow == Flow::kAlways) &&
         instruction.target <= index;
}

class Walk {
 public:
  Walk(Program program, IssueModel& model, IssueChart& chart)
      : program_(program), model_(model), chart_(chart) {}

  bool Run(std::span<const TripCount> trips, std::string& error) {
    if (!FindLoops(trips, error)) return false;
    seen_.resize(program_.size());
    chart_.first_pass.reserve(program_.size());
    uint32_t index = 0;
    while (index < program_.size()) {
      const Instruction& instruction = program_[index];
      if (instruction.flow == Flow::kCall)
        return Refuse(index, "calls are not followed: give the function with its calls inlined",
                      error);
      if (issues_++ >= kMaxIssues)
        return Refuse(index,
                      Format("no end after {} issues and no steady state to leap from: give "
                             "a smaller trip count, or one loop",
                             kMaxIssues),
                      error);
      bool taken = instruction.flow == Flow::kAlways;
      Loop* loop = nullptr;
      if (IsBackwardBranch(instruction, index)) {
        loop = &loops_.at(instruction.target);
        taken = loop->iterations_left > 1;
      }
      Issue(instruction, index, taken);
      if (loop && taken) EndIteration(*loop, index);
      if (loop && !taken) EndLoop(*loop, index);
      if (instruction.flow == Flow::kEnd) break;
      if (loop && !taken && instruction.flow == Flow::kAlways) break;  // nothing lies behind it
      index = taken ? std::min(instruction.target, uint32_t(program_.size())) : index + 1;
    }
    Finish();
    return true;
  }

 private:
  struct Snapshot {
    std::vector<int64_t> state;
    uint64_t iterations_left;
    IssueTotals totals;
  };
  struct Loop {
    uint64_t iterations, iterations_left;
    bool assumed;
    bool timed = false;          // its steady state is in the chart
    bool leapt = false;          // since it was entered
    size_t iteration_begin = 0;  // in log_
    std::vector<Snapshot> snapshots{};
  };

  static bool Refuse(uint32_t index, std::string_view what, std::string& error) {
    error = Format("instruction {}: {}", index, what);
    return false;
  }

  bool FindLoops(std::span<const TripCount> trips, std::string& error) {
    for (const uint32_t head : LoopHeads(program_)) loops_[head] = {kAssumedIterations, 0, true};
    for (const TripCount& trip : trips) {
      const auto loop = loops_.find(trip.head);
      if (loop == loops_.end())
        return Refuse(trip.head, "a trip count, but no branch goes back to here", error);
      if (trip.iterations == 0 || trip.iterations > kMaxIterations)
        return Refuse(
            trip.head,
            Format("a trip count of {}; expected 1 to {}", trip.iterations, kMaxIterations), error);
      loop->second.iterations = trip.iterations;
      loop->second.assumed = false;
    }
    for (auto& [head, loop] : loops_) loop.iterations_left = loop.iterations;
    return true;
  }

  void Issue(const Instruction& instruction, uint32_t index, bool taken) {
    const IssueSlot slot = model_.Issue(instruction, index, taken);
    for (uint32_t s = 0; s < slot.stall_count; ++s)
      totals_.stall_cycles[uint32_t(slot.stalls[s].cause)] += slot.stalls[s].cycles;
    ++totals_.instructions;
    totals_.dual_issues += slot.unpaired == Unpaired::kPaired;
    ++totals_.unpaired[uint32_t(slot.unpaired)];
    for (uint32_t p = 0; p < model_.PipeCount(); ++p)
      totals_.pipe_cycles[p] += model_.BusyCycles(instruction, p);
    totals_.cycles = slot.cycle + 1;
    if (!seen_twice_) NoteFirstPass(slot, index);
    if (!loops_.empty()) log_.push_back(slot);
  }

  void NoteFirstPass(const IssueSlot& slot, uint32_t index) {
    seen_twice_ = seen_[index];
    if (seen_twice_) return;
    seen_[index] = true;
    chart_.first_pass.push_back(slot);
    // Without loops the whole run is the first pass.
    if (!loops_.empty()) chart_.first_pass_totals = totals_;
  }

  Snapshot Now(const Loop& loop) const {
    Snapshot now{{}, loop.iterations_left, totals_};
    model_.AppendState(now.state);
    for (const auto& [head, other] : loops_)
      if (&other != &loop) now.state.push_back(int64_t(other.iterations_left));
    return now;
  }

  // Its branch was just taken.
  void EndIteration(Loop& loop, uint32_t branch) {
    --loop.iterations_left;
    if (!loop.leapt) {
      Snapshot now = Now(loop);
      for (const Snapshot& before : loop.snapshots)
        if (before.state == now.state) {
          LeapAhead(loop, branch, before);
          break;
        }
      if (!loop.leapt) {
        if (loop.snapshots.size() == kStatesKept) loop.snapshots.erase(loop.snapshots.begin());
        loop.snapshots.push_back(std::move(now));
      }
    }
    loop.iteration_begin = log_.size();
  }

  void LeapAhead(Loop& loop, uint32_t branch, const Snapshot& before) {
    IssueTotals period = totals_;
    period -= before.totals;
    const uint64_t period_iterations = before.iterations_left - loop.iterations_left;
    if (!loop.timed) AddTiming(loop, branch, period_iterations, period);
    // The last iteration leaves the loop: it is always walked.
    const uint64_t times = (loop.iterations_left - 1) / period_iterations;
    model_.Leap(period.cycles * int64_t(times));
    totals_ += period * times;
    loop.iterations_left -= times * period_iterations;
    loop.leapt = true;
    loop.snapshots.clear();
  }

  void AddTiming(Loop& loop, uint32_t branch, uint64_t period_iterations,
                 const IssueTotals& period) {
    LoopTiming timing{
        .head = program_[branch].target, .branch = branch, .iterations = loop.iterations};
    timing.iterations_assumed = loop.assumed;
    timing.steady = true;
    timing.period_iterations = period_iterations;
    timing.period_cycles = period.cycles;
    timing.period = period;
    timing.slots.assign(log_.begin() + ptrdiff_t(loop.iteration_begin), log_.end());
    if (!timing.slots.empty()) {
      const int64_t first = timing.slots.front().cycle;
      for (IssueSlot& slot : timing.slots) slot.cycle -= first;
    }
    loop.timed = true;
    chart_.loops.push_back(std::move(timing));
  }

  // Its branch fell through; it may be entered again.
  void EndLoop(Loop& loop, uint32_t branch) {
    if (!loop.timed)
      chart_.loops.push_back({.head = program_[branch].target,
                              .branch = branch,
                              .iterations = loop.iterations,
                              .iterations_assumed = loop.assumed});
    loop.timed = true;
    loop.iterations_left = loop.iterations;
    loop.leapt = false;
    loop.snapshots.clear();
    loop.iteration_begin = log_.size();
  }

  void Finish() {
    chart_.totals = totals_;
    if (loops_.empty()) chart_.first_pass_totals = totals_;
    std::ranges::sort(chart_.loops, {}, &LoopTiming::head);
  }

  Program program_;
  IssueModel& model_;
  IssueChart& chart_;
  IssueTotals totals_;
  std::map<uint32_t, Loop> loops_;  // by head
  std::vector<IssueSlot> log_;      // for the iterations of loops
  size_t issues_ = 0;
  std::vector<bool> seen_;
  bool seen_twice_ = false;
};

// Registers that are live, and how many.
class LiveSet {
 public:
  explicit LiveSet(uint32_t registers) : words_((registers + 63) / 64) {}

  uint32_t count() const { return count_; }
  void Add(uint32_t reg) {
    uint64_t& word = words_[reg / 64];
    count_ += !(word >> reg % 64 & 1);
    word |= uint64_t{1} << reg % 64;
  }
  void Remove(uint32_t reg) {
    uint64_t& word = words_[reg / 64];
    count_ -= word >> reg % 64 & 1;
    word &= ~(uint64_t{1} << reg % 64);
  }
  void Clear() {
    if (count_ > 0) std::ranges::fill(words_, 0);
    count_ = 0;
  }
  // False: nothing new.
  bool AddAll(const LiveSet& more) {
    const uint32_t before = count_;
    if (more.count_ == 0) return false;
    count_ = 0;
    for (size_t w = 0; w < words_.size(); ++w)
      count_ += uint32_t(std::popcount(words_[w] |= more.words_[w]));
    return count_ != before;
  }

 private:
  std::vector<uint64_t> words_;
  uint32_t count_ = 0;
};

}  // namespace

bool CheckProgram(Program program, uint32_t class_count, std::string& error) {
  for (size_t i = 0; i < program.size(); ++i) {
    const Instruction& instruction = program[i];
    const auto registers_are_good = [](const auto& list) {
      return std::ranges::all_of(list, [](uint32_t reg) { return reg < kMaxRegisters; });
    };
    const char* wrong = nullptr;
    if (instruction.op_class >= class_count) wrong = "a class that this core does not have";
    if (!registers_are_good(instruction.reads) || !registers_are_good(instruction.writes))
      wrong = "a register number beyond 4194303";
    if (instruction.target != kNoTarget && instruction.target > program.size())
      wrong = "a target outside of the program";
    if (!wrong) continue;
    error = Format("instruction {}: {}", i, wrong);
    return false;
  }
  return true;
}

uint32_t RegisterEnd(Program program) {
  uint32_t end = 0;
  for (const Instruction& instruction : program) {
    for (const uint32_t reg : instruction.reads) end = std::max(end, reg + 1);
    for (const uint32_t reg : instruction.writes) end = std::max(end, reg + 1);
  }
  return end;
}

std::vector<uint32_t> LoopHeads(Program program) {
  std::vector<uint32_t> heads;
  for (uint32_t i = 0; i < program.size(); ++i)
    if (IsBackwardBranch(program[i], i)) heads.push_back(program[i].target);
  std::ranges::sort(heads);
  heads.erase(std::unique(heads.begin(), heads.end()), heads.end());
  return heads;
}

// Backwards over the program; live sets are kept only where branches go, and the passes repeat
// until those stand still.
uint32_t MostLiveRegisters(Program program, uint32_t first, uint32_t count) {
  const LiveSet none(count);
  std::map<uint32_t, LiveSet> at_target;
  for (const Instruction& instruction : program)
    if (instruction.flow != Flow::kHint && instruction.target != kNoTarget)
      at_target.try_emplace(instruction.target, none);
  const auto inside = [&](uint32_t reg) { return reg >= first && reg - first < count; };
  uint32_t most = 0;
  for (bool changed = true; changed;) {
    changed = false;
    LiveSet live(count);
    for (uint32_t i = uint32_t(program.size()); i-- > 0;) {
      const Instruction& instruction = program[i];
      const bool ends = instruction.flow == Flow::kEnd || instruction.flow == Flow::kAlways;
      if (ends) live.Clear();
      const bool jumps =
          instruction.flow == Flow::kAlways || instruction.flow == Flow::kConditional;
      if (jumps && instruction.target != kNoTarget) live.AddAll(at_target.at(instruction.target));
      for (const uint32_t reg : instruction.writes)
        if (inside(reg)) live.Add(reg - first);
      most = std::max(most, live.count());
      for (const uint32_t reg : instruction.writes)
        if (inside(reg)) live.Remove(reg - first);
      for (const uint32_t reg : instruction.reads)
        if (inside(reg)) live.Add(reg - first);
      most = std::max(most, live.count());
      if (const auto at = at_target.find(i); at != at_target.end())
        changed |= at->second.AddAll(live);
    }
  }
  return most;
}

bool RunWalk(Program program, std::span<const TripCount> trips, IssueModel& model,
             IssueChart& chart, std::string& error) {
  return Walk(program, model, chart).Run(trips, error);
}

}  // namespace pelt
