#include "platform_sim/core/ppe_pair.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "core/format.hpp"
#include "platform_sim/core/issue_walk.hpp"
#include "platform_sim/core/ppe_thread.hpp"

namespace pelt {
namespace {

// Turns of the first thread, and instructions of both, within which the state must come back.
constexpr size_t kMostTurns = 2000;
constexpr uint64_t kMostIssues = 4'000'000;

struct LoopThread {
  Program program;
  uint32_t head, branch;
  PpeThread thread;
  uint32_t next;
  uint64_t turns = 0;
};

std::optional<LoopThread> MakeThread(Program program, const PpeParameters& ppe,
                                     std::string& error) {
  if (!CheckProgram(program, kPpeClassCount, error)) return std::nullopt;
  const std::vector<uint32_t> heads = LoopHeads(program);
  if (heads.size() != 1) {
    error = Format("{} loops; each thread of a pair runs one", heads.size());
    return std::nullopt;
  }
  uint32_t branch = heads[0];
  while (program[branch].target != heads[0]) ++branch;
  return LoopThread{program, heads[0], branch, PpeThread(RegisterEnd(program), ppe), heads[0]};
}

class Pair {
 public:
  explicit Pair(std::array<LoopThread, 2> threads) : threads_(std::move(threads)) {}

  std::optional<PpePairTiming> Run(std::string& error) {
    struct Moment {
      int64_t cycle;
      std::array<uint64_t, 2> turns;
    };
    std::map<std::vector<int64_t>, Moment> seen;
    for (uint64_t issues = 0; issues < kMostIssues && seen.size() < kMostTurns; ++issues) {
      if (Step() != 0 || threads_[0].next != threads_[0].head) continue;
      const Moment now = {threads_[0].thread.last_cycle(), {threads_[0].turns, threads_[1].turns}};
      const auto [before, is_new] = seen.emplace(State(now.cycle), now);
      const Moment& then = before->second;
      if (is_new || now.turns[1] == then.turns[1]) continue;
      return PpePairTiming{now.cycle - then.cycle,
                           {now.turns[0] - then.turns[0], now.turns[1] - then.turns[1]}};
    }
    error = "the two loops reach no steady state together";
    return std::nullopt;
  }

 private:
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
    const bool ends = thread.next == thread.branch;
    thread.thread.Commit(thread.program[thread.next], slots[second], ends, units_);
    thread.turns += ends;
    thread.next = ends ? thread.head : thread.next + 1;
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

std::optional<PpePairTiming> TryTimePpePair(const std::array<Program, 2>& programs,
                                            const PpeParameters& ppe, std::string& error) {
  if (ppe.smt_threads != 2) {
    error = Format("a core of {} hardware threads runs no pair", ppe.smt_threads);
    return std::nullopt;
  }
  auto first = MakeThread(programs[0], ppe, error);
  auto second = first ? MakeThread(programs[1], ppe, error) : std::nullopt;
  if (!second) return std::nullopt;
  return Pair({std::move(*first), std::move(*second)}).Run(error);
}

}  // namespace pelt
