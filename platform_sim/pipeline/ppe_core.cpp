#include "platform_sim/pipeline/ppe_core.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "core/format.hpp"
#include "platform_sim/pipeline/instruction_set.hpp"
#include "platform_sim/pipeline/issue_walk.hpp"
#include "platform_sim/pipeline/ppe_thread.hpp"

namespace pelt {
namespace {

class PpeDispatch final : public IssueModel {
 public:
  PpeDispatch(Program program, const PpeRules& rules, const PpeParameters& ppe)
      : rules_(rules), ppe_(ppe), thread_(RegisterEnd(program), ppe) {}

  IssueSlot Issue(const Instruction& instruction, uint32_t index, bool taken) override {
    const IssueSlot slot =
        thread_.Propose(instruction, index, units_, [&](int64_t cycle) { return OwnCycle(cycle); });
    thread_.Commit(instruction, slot, taken, units_);
    return slot;
  }

  uint32_t BusyCycles(const Instruction& instruction, uint32_t unit) const override {
    const PpeClassParameters& op = ppe_.classes[instruction.op_class];
    if (op.blocks_units >> unit & 1) return op.latency_cycles;
    return op.units >> unit & 1;
  }

  void AppendState(std::vector<int64_t>& state) const override {
    const int64_t now = thread_.last_cycle();
    thread_.AppendState(now, state);
    for (const int64_t cycle : units_.free_at) state.push_back(std::max<int64_t>(cycle - now, 0));
    if (rules_.smt) state.push_back(now % ppe_.smt_threads);
  }

  void Leap(int64_t cycles) override {
    thread_.Leap(cycles);
    for (int64_t& cycle : units_.free_at) cycle += cycles;
  }

  uint32_t PipeCount() const override { return kPpeUnitCount; }

 private:
  int64_t OwnCycle(int64_t cycle) const {
    const int64_t threads = rules_.smt ? ppe_.smt_threads : 1;
    return (cycle + threads - 1) / threads * threads;
  }

  const PpeRules rules_;
  const PpeParameters& ppe_;
  PpeThread thread_;
  PpeUnits units_;
};

// How many iterations of the first thread are remembered to see the state come back, and how many
// instructions of both are walked.
constexpr size_t kMostIterations = 2000;
constexpr uint64_t kMostIssues = 1'000'000;

struct LoopThread {
  Program program;
  uint32_t head, branch;
  PpeThread thread;
  uint32_t next;
  uint64_t iterations = 0;
};

Result<LoopThread> MakeThread(Program program, const PpeParameters& ppe) {
  std::string error;
  if (!CheckProgram(program, kPpeClassCount, error)) return Failure{error};
  const std::vector<uint32_t> heads = LoopHeads(program);
  if (heads.size() != 1)
    return Failure{Format("{} loops; each thread of a pair runs one", heads.size())};
  uint32_t branch = heads[0];
  while (program[branch].target != heads[0]) ++branch;
  for (uint32_t i = heads[0]; i < program.size(); ++i) {
    const Instruction& instruction = program[i];
    const bool leaves =
        i < branch && (instruction.flow == Flow::kCall || instruction.flow == Flow::kEnd ||
                       (instruction.flow == Flow::kAlways && instruction.target > branch));
    const bool again = i > branch && instruction.target == heads[0];
    if (!leaves && !again) continue;
    return Failure{
        Format("instruction {}: {}", i,
               leaves ? "the loop leaves for what is not in it: give it with its calls inlined"
                      : "a second branch to the loop's head; a loop of a pair has one")};
  }
  return LoopThread{program, heads[0], branch, PpeThread(RegisterEnd(program), ppe), heads[0]};
}

class Pair {
 public:
  explicit Pair(std::array<LoopThread, 2> threads) : threads_(std::move(threads)) {}

  Result<PpePairTiming> Run() {
    struct Moment {
      int64_t cycle;
      std::array<uint64_t, 2> iterations;
    };
    std::map<std::vector<int64_t>, Moment> seen;
    Moment first{}, now{};
    for (uint64_t issues = 0; issues < kMostIssues; ++issues) {
      if (Step() != 0 || threads_[0].next != threads_[0].head) continue;
      now = {threads_[0].thread.last_cycle(), {threads_[0].iterations, threads_[1].iterations}};
      if (first.iterations[1] == 0) first = now;  // both have begun
      if (seen.size() == kMostIterations) continue;
      const auto [before, is_new] = seen.emplace(State(now.cycle), now);
      const Moment& then = before->second;
      if (!is_new && now.iterations[1] > then.iterations[1])
        return Between(then.cycle, now.cycle, then.iterations, now.iterations, true);
    }
    if (now.iterations[0] > first.iterations[0] && now.iterations[1] > first.iterations[1])
      return Between(first.cycle, now.cycle, first.iterations, now.iterations, false);
    return Failure{"the two loops are too long to be timed together"};
  }

 private:
  using Iterations = std::array<uint64_t, 2>;
  static PpePairTiming Between(int64_t from, int64_t to, const Iterations& before,
                               const Iterations& after, bool steady) {
    return {steady, to - from, {after[0] - before[0], after[1] - before[1]}};
  }

  IssueSlot Propose(uint32_t t) const {
    const LoopThread& own = threads_[t];
    const PpeThread& other = threads_[1 - t].thread;
    return own.thread.Propose(own.program[own.next], own.next, units_, [&](int64_t cycle) {
      const bool taken = other.started() && cycle <= other.last_cycle();
      return taken ? other.last_cycle() + 1 : cycle;
    });
  }

  // One instruction of the thread that may dispatch first; which one that was.
  uint32_t Step() {
    const std::array<IssueSlot, 2> slots = {Propose(0), Propose(1)};
    const auto last = [&](uint32_t t) {
      return threads_[t].thread.started() ? threads_[t].thread.last_cycle() : -1;
    };
    const bool second =
        slots[1].cycle < slots[0].cycle || (slots[1].cycle == slots[0].cycle && last(1) < last(0));
    LoopThread& thread = threads_[second];
    const Instruction& instruction = thread.program[thread.next];
    const bool ends = thread.next == thread.branch;
    thread.thread.Commit(instruction, slots[second], ends, units_);
    thread.iterations += ends;
    const bool jumps = ends || instruction.flow == Flow::kAlways;
    thread.next = jumps ? instruction.target : thread.next + 1;
    return second;
  }

  std::vector<int64_t> State(int64_t now) const {
    std::vector<int64_t> state;
    for (const LoopThread& thread : threads_) {
      state.push_back(thread.next);
      thread.thread.AppendState(now, state);
    }
    for (const int64_t cycle : units_.free_at) state.push_back(std::max<int64_t>(cycle - now, 0));
    return state;
  }

  std::array<LoopThread, 2> threads_;
  PpeUnits units_;
};

}  // namespace

Result<IssueChart> TimeOnPpe(Program program, std::span<const TripCount> trips,
                             const PpeRules& rules, const PpeParameters& ppe) {
  std::string error;
  if (!CheckProgram(program, kPpeClassCount, error)) return Failure{error};
  IssueChart chart;
  chart.pipes = {"fixed point", "load/store", "branch unit", "VSU1", "VSU2"};
  PpeDispatch model(program, rules, ppe);
  if (!RunWalk(program, trips, model, chart, error)) return Failure{error};
  chart.live = {{"general", MostLiveRegisters(program, kPpeGeneral, kPpeFloat - kPpeGeneral),
                 ppe.general_register_count},
                {"FP", MostLiveRegisters(program, kPpeFloat, kPpeVector - kPpeFloat),
                 ppe.float_register_count},
                {"vector", MostLiveRegisters(program, kPpeVector, kPpeCr - kPpeVector),
                 ppe.vector_register_count}};
  return chart;
}

Result<PpePairTiming> TimePpePair(const std::array<Program, 2>& programs,
                                  const PpeParameters& ppe) {
  if (ppe.smt_threads != 2)
    return Failure{Format("a core of {} hardware threads runs no pair", ppe.smt_threads)};
  auto first = MakeThread(programs[0], ppe);
  if (!first) return Failure{first.error()};
  auto second = MakeThread(programs[1], ppe);
  if (!second) return Failure{second.error()};
  return Pair({*std::move(first), *std::move(second)}).Run();
}

}  // namespace pelt
