#include "platform_sim/schedule/schedule.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <numeric>
#include <queue>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace pelt {
namespace {

// Dual-issue alignment: puts code that was scheduled by cycles where a core that pairs by address
// finds its pairs.
//
//   cycle   8   9  10  10  11        fetch groups   | 8    9   |      two alone
//                                                   | 10   10  |      a pair
//                                                   | 11   ..
//
// Instructions that go alone fill groups among themselves, which costs nothing: each would take a
// cycle anyway. Only when a pair comes in the middle of a group, the one before it gets a nop or
// lnop beside it, in its own cycle.
void Pad(uint8_t op_class, FinishedCode& out) {
  Instruction padding;
  padding.op_class = op_class;
  out.program.push_back(padding);
  out.origin.push_back(kPadding);
  ++out.padding;
}

// `code`: as AssignRegisters made it in the order of `order`. Adds padding and sets locations.
void LayOutPairs(const IssueOrder& order, const SchedulingCore& core, FinishedCode& code) {
  if (!core.fetch_groups) return;
  const SchedulingCore::FetchGroups& groups = *core.fetch_groups;
  FinishedCode out = code;
  out.program.clear();
  out.origin.clear();
  const auto add = [&](size_t i) {
    out.program.push_back(code.program[i]);
    out.origin.push_back(code.origin[i]);
  };
  const size_t size = code.program.size();
  for (size_t i = 0; i < size;) {
    const bool is_pair = i + 1 < size && order.cycle[i] == order.cycle[i + 1];
    if (is_pair) {
      add(i++);
      add(i++);
      continue;
    }
    // Alone, at the beginning of a group: is it followed by a pair?
    const bool at_group_begin = out.program.size() * core.instruction_bytes % groups.bytes == 0;
    const bool pair_follows = i + 2 < size && order.cycle[i + 1] == order.cycle[i + 2];
    const bool is_first_kind = core.classes[code.program[i].op_class].units & groups.first_units;
    if (at_group_begin && pair_follows && !is_first_kind) Pad(groups.first_padding_class, out);
    add(i++);
    if (at_group_begin && pair_follows && is_first_kind) Pad(groups.second_padding_class, out);
  }
  for (size_t i = 0; i < out.program.size(); ++i) {
    out.program[i].location_bytes = i * core.instruction_bytes;
    if (out.program[i].target != kNoTarget) out.program[i].target = uint32_t(out.program.size());
  }
  code = std::move(out);
}

// Puts iterations of a loop side by side: what a hand does that unrolls a loop of long chains twice
// and writes the two copies as one, instruction by instruction.
//
// Idea: a scheduler that goes through iteration after iteration has to run far ahead to find work
// of another one, and what it finds there first are loads, which fill the registers long before
// anything reads them. Code in which the iterations lie beside each other has its work near by, and
// the register allocator sees what that takes.
//
//   key of an instruction = (group of its iteration, how far into it the instruction is, iteration)
//
// The order is topological in the dependences: the least key of what is ready goes next. What waits
// for nothing in a register that another instruction writes (a load of a row, a constant) goes just
// before its first reader.
//
// An iteration ends where the fewest values are alive near the place where it should, were all of
// one length. A wrong end makes code slower, never wrong.

struct InterleavedCode {
  StraightCode code;             // the same values
  std::vector<uint32_t> origin;  // of each instruction, in the code it was made from
};

// Ahead of its first reader, of both iterations' instructions: enough for a load.
constexpr int64_t kLeadInstructions = 8;

// Values alive before each instruction.
std::vector<int32_t> CountAlive(const StraightCode& code, const ValueUses& uses) {
  std::vector<int32_t> alive(code.program.size() + 1);
  for (uint32_t v = 0; v < code.value_count(); ++v) {
    const auto readers = uses.ReadersOf(v);
    const uint32_t writer = uses.WriterOf(v);
    if (writer == kNoTarget || readers.empty()) continue;
    ++alive[writer + 1];
    if (readers.back() + 1 < alive.size()) --alive[readers.back() + 1];
  }
  for (size_t p = 1; p < alive.size(); ++p) alive[p] += alive[p - 1];
  return alive;
}

// Where each iteration begins, and the end.
std::vector<uint32_t> IterationBegins(const StraightCode& code, const ValueUses& uses,
                                      uint32_t iterations) {
  const std::vector<int32_t> alive = CountAlive(code, uses);
  const auto size = uint32_t(code.program.size());
  std::vector<uint32_t> begins = {0};
  for (uint32_t t = 1; t < iterations; ++t) {
    const auto due = uint32_t(uint64_t{size} * t / iterations), reach = size / iterations / 3;
    const uint32_t first = std::max(due - std::min(due, reach), begins.back());
    const uint32_t last = std::min(due + reach, size);
    begins.push_back(uint32_t(std::min_element(alive.begin() + first, alive.begin() + last + 1) -
                              alive.begin()));
  }
  begins.push_back(size);
  return begins;
}

struct OrderKey {
  uint32_t group = 0;
  int64_t progress = 0;  // into its iteration, in parts of kWhole
  uint32_t iteration = 0;
  auto operator<=>(const OrderKey&) const = default;
};
constexpr int64_t kWhole = int64_t{1} << 32;

// Of each value: whether it is made of more than constants and memory.
std::vector<bool> FindWaiting(const StraightCode& code) {
  std::vector<bool> waits(code.value_count());
  std::vector<bool> is_plain(code.value_count(), true);
  for (const Instruction& instruction : code.program) {
    const bool any =
        std::ranges::any_of(instruction.reads, [&](uint32_t value) { return waits[value]; });
    // One step behind a load at most: a splat of a word.
    const bool deep =
        std::ranges::any_of(instruction.reads, [&](uint32_t value) { return !is_plain[value]; });
    for (const uint32_t value : instruction.writes) {
      waits[value] = any || deep;
      is_plain[value] = instruction.reads.count == 0;
    }
  }
  return waits;
}

std::vector<OrderKey> KeysOf(const StraightCode& code, const ValueUses& uses, uint32_t iterations,
                             uint32_t together) {
  const std::vector<uint32_t> begins = IterationBegins(code, uses, iterations);
  std::vector<OrderKey> keys(code.program.size());
  for (uint32_t t = 0; t < iterations; ++t)
    for (uint32_t i = begins[t]; i < begins[t + 1]; ++i)
      keys[i] = {t / together, (i - begins[t]) * kWhole / (begins[t + 1] - begins[t]), t};
  const int64_t lead =
      kLeadInstructions * kWhole * iterations / int64_t(std::max<size_t>(code.program.size(), 1));
  const std::vector<bool> waits = FindWaiting(code);
  // Branches keep their order, so one of a younger iteration comes behind those of older ones; and
  // what decides it comes just before it: conditions are few, and nothing spills them.
  OrderKey last_branch;
  for (size_t i = 0; i < keys.size(); ++i)
    if (code.program[i].flow == Flow::kConditional)
      last_branch = keys[i] = std::max(last_branch, keys[i]);
  // Readers first: what makes their operands moves with them.
  for (size_t i = keys.size(); i-- > 0;) {
    const Instruction& instruction = code.program[i];
    if (instruction.writes.count != 1) continue;
    const uint32_t value = instruction.writes.number[0];
    const bool decides = code.file[value] == ValueFile::kCondition;
    const auto readers = uses.ReadersOf(value);
    if ((waits[value] && !decides) || readers.empty()) continue;
    OrderKey first = keys[readers[0]];
    for (const uint32_t reader : readers) first = std::min(first, keys[reader]);
    if (!decides) first.progress -= lead;
    keys[i] = std::max(keys[i], first);
  }
  return keys;
}

// `code` has `iterations` iterations; `together` of them are put side by side, 1 or more.
InterleavedCode InterleaveIterations(const StraightCode& code, uint32_t iterations,
                                     uint32_t together, const SchedulingCore& core) {
  const ValueUses uses(code);
  const DependenceGraph graph(code, uses, core);
  const std::vector<OrderKey> keys = KeysOf(code, uses, std::max(iterations, 1u), together);
  using Waiting = std::pair<OrderKey, uint32_t>;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> ready;
  std::vector<uint32_t> edges_left(graph.size());
  for (uint32_t i = 0; i < graph.size(); ++i) {
    edges_left[i] = graph.EdgesInto(i);
    if (edges_left[i] == 0) ready.push({keys[i], i});
  }
  InterleavedCode out{.code = {.program = {}, .file = code.file}, .origin = {}};
  while (!ready.empty()) {
    const uint32_t i = ready.top().second;
    ready.pop();
    out.code.program.push_back(code.program[i]);
    out.origin.push_back(i);
    for (const DependenceGraph::Edge& edge : graph.After(i))
      if (--edges_left[edge.to] == 0) ready.push({keys[edge.to], edge.to});
  }
  return out;
}

// Gives the values of straight code registers, in the order that it is to run in.
//
// Idea: in straight code the lives of values are intervals, so whenever no more of them overlap
// than there are registers, handing out a free one at each write never fails. Free registers wait
// in a queue: the one that was free for longest goes first, so that a reused register's last result
// is long out of the pipeline.
class Assignment {
 public:
  Assignment(const FittedCode& fitted, const SchedulingCore& core, FinishedCode& out)
      : code_(fitted.code),
        fitted_(fitted),
        out_(out),
        uses_(code_),
        readers_left_(code_.value_count()),
        reg_(code_.value_count(), kNoRegister) {
    for (uint32_t v = 0; v < code_.value_count(); ++v)
      readers_left_[v] = uint32_t(uses_.ReadersOf(v).size());
    for (uint32_t f = 0; f < kValueFileCount; ++f)
      for (uint32_t r = 0; r < core.files[f].count; ++r)
        free_[f].push_back(core.files[f].first + r);
  }

  bool Run(std::span<const uint32_t> order, uint32_t instruction_bytes) {
    out_.entry = fitted_.in_memory;
    std::vector<bool> in_memory(code_.value_count());
    for (const EntryValue& value : fitted_.in_memory) in_memory[value.value] = true;
    bool fits = true;
    for (uint32_t v = 0; v < code_.value_count() && fits; ++v) {
      if (uses_.WriterOf(v) != kNoTarget || readers_left_[v] == 0 || in_memory[v]) continue;
      fits = Take(v);
      out_.entry.push_back({.value = v, .reg = reg_[v]});
    }
    for (size_t n = 0; n < order.size() && fits; ++n) fits = Place(order[n]);
    if (!fits) return false;
    for (size_t i = 0; i < out_.program.size(); ++i) {
      out_.program[i].location_bytes = i * instruction_bytes;
      if (out_.program[i].target != kNoTarget)
        out_.program[i].target = uint32_t(out_.program.size());
    }
    out_.spill_stores = fitted_.spill_stores;
    out_.spill_loads = fitted_.spill_loads;
    out_.made_again = fitted_.made_again;
    return true;
  }

 private:
  uint32_t File(uint32_t value) const { return uint32_t(code_.file[value]); }

  bool Take(uint32_t value) {
    std::deque<uint32_t>& free = free_[File(value)];
    if (free.empty()) return false;
    reg_[value] = free.front();
    free.pop_front();
    if (code_.file[value] == ValueFile::kVector)
      out_.most_live_vectors = std::max(out_.most_live_vectors, ++live_vectors_);
    return true;
  }

  void GiveBack(uint32_t value) {
    free_[File(value)].push_back(reg_[value]);
    live_vectors_ -= code_.file[value] == ValueFile::kVector;
  }

  bool Place(uint32_t index) {
    const Instruction& before = code_.program[index];
    Instruction now = before;
    for (uint32_t r = 0; r < before.reads.count; ++r)
      now.reads.number[r] = reg_[before.reads.number[r]];
    for (uint32_t r = 0; r < before.reads.count; ++r) {
      const uint32_t value = before.reads.number[r];
      const auto earlier = std::span(before.reads.number).first(r);
      if (std::ranges::find(earlier, value) != earlier.end()) continue;
      if (--readers_left_[value] == 0) GiveBack(value);
    }
    for (uint32_t w = 0; w < before.writes.count; ++w) {
      if (!Take(before.writes.number[w])) return false;
      now.writes.number[w] = reg_[before.writes.number[w]];
    }
    for (const uint32_t value : before.writes)
      if (readers_left_[value] == 0) GiveBack(value);
    out_.program.push_back(now);
    out_.origin.push_back(fitted_.origin[index]);
    return true;
  }

  const StraightCode& code_;
  const FittedCode& fitted_;
  FinishedCode& out_;
  const ValueUses uses_;
  std::vector<uint32_t> readers_left_;
  std::vector<uint32_t> reg_;  // of each value
  std::array<std::deque<uint32_t>, kValueFileCount> free_;
  uint32_t live_vectors_ = 0;
};

// One instruction behind the other, without padding. `order`: every instruction of `fitted` once;
// one that does not fit the registers is refused.
Result<FinishedCode> AssignRegisters(const FittedCode& fitted, std::span<const uint32_t> order,
                                     const SchedulingCore& core) {
  FinishedCode out;
  out.program.reserve(order.size());
  out.origin.reserve(order.size());
  if (!Assignment(fitted, core, out).Run(order, core.instruction_bytes))
    return Failure{"an order that needs more registers than the core has"};
  return out;
}

constexpr uint32_t kFirstWindow = 256;
// What is scheduled to see how good a window is: some lane groups of a kernel.
constexpr uint32_t kSampleInstructions = 4096;
constexpr uint32_t kWindowsInSample = 8;

// Of the vector registers, in eighths, that fitting interleaved iterations leaves to the scheduler:
// what is made again near its reader instead of kept leaves room to run ahead. (Measured: one or
// three eighths are 3 % worse at most.)
constexpr uint32_t kKeptFreeEighths = 2;

SchedulingCore WithRoomToRunAhead(SchedulingCore core) {
  uint32_t& count = core.files[uint32_t(ValueFile::kVector)].count;
  count -= count * kKeptFreeEighths / 8;
  return core;
}

Result<FinishedCode> KeepOrder(const FittedCode& fitted, const SchedulingCore& core) {
  std::vector<uint32_t> order(fitted.code.program.size());
  std::iota(order.begin(), order.end(), 0u);
  return AssignRegisters(fitted, order, core);
}

// The beginning of `code`; it fits the registers if all of it does.
StraightCode Sample(const StraightCode& code) {
  const size_t size = std::min<size_t>(code.program.size(), kSampleInstructions);
  return {{code.program.begin(), code.program.begin() + ptrdiff_t(size)}, code.file};
}

// The window that is best for `sample`: doubled or halved until that does not help, then
// looked for between.
class WindowSearch {
 public:
  WindowSearch(const StraightCode& sample, const SchedulingCore& core) : input_(sample, core) {}

  uint32_t Run() {
    const uint32_t size = uint32_t(input_.code.program.size());
    uint32_t window = std::min(kFirstWindow, size);
    Try(window);
    while (window < size && Try(window * 2)) window *= 2;
    if (best_ == window && window <= kFirstWindow)
      while (window > 1 && Try(window / 2)) window /= 2;
    const uint32_t power = best_;
    if (power < size) Try(power + power / 2);
    if (power >= 4) Try(power / 4 * 3);
    return best_;
  }

  // Of the sample, in that window.
  IssueOrder TakeOrder() { return std::move(best_order_); }

 private:
  // Whether it is better than all before. Of equals the wider one, as long as the sample is many
  // windows long: it has more to choose from later on.
  bool Try(uint32_t window) {
    IssueOrder order = ScheduleWithin(window, input_);
    const int64_t cycles = order.cycles();
    const bool wins_ties =
        window > best_ && uint64_t{window} * kWindowsInSample <= input_.code.program.size();
    if (best_ && (cycles > best_cycles_ || (cycles == best_cycles_ && !wins_ties))) return false;
    best_ = window;
    best_cycles_ = cycles;
    best_order_ = std::move(order);
    return true;
  }

  const ScheduleInput input_;
  uint32_t best_ = 0;
  int64_t best_cycles_ = 0;
  IssueOrder best_order_;
};

IssueOrder BestOrder(const StraightCode& fitted, const SchedulingCore& core) {
  const StraightCode sample = Sample(fitted);
  WindowSearch search(sample, core);
  const uint32_t window = search.Run();
  if (sample.program.size() == fitted.program.size()) return search.TakeOrder();
  return ScheduleWithin(window, ScheduleInput(fitted, core));
}

// Keeps the best of the codes that it is offered, by the core's own issue model; of equals the
// first.
class Choice {
 public:
  explicit Choice(const SchedulingCore& core) : core_(core) {}

  Result<> Offer(Result<FinishedCode> code) {
    if (!code) return Failure{code.error()};
    const auto chart = core_.time(code->program);
    if (!chart) return Failure{chart.error()};
    if (best_ && chart->totals.cycles >= best_cycles_) return Done{};
    best_cycles_ = chart->totals.cycles;
    best_ = *std::move(code);
    return Done{};
  }
  Result<> OfferScheduled(const FittedCode& fitted) {
    return Offer(Finish(fitted, BestOrder(fitted.code, core_), core_));
  }
  FinishedCode Take() { return *std::move(best_); }

 private:
  const SchedulingCore& core_;
  std::optional<FinishedCode> best_;
  int64_t best_cycles_ = 0;
};

}  // namespace

Result<FinishedCode> Finish(const FittedCode& fitted, const IssueOrder& order,
                            const SchedulingCore& core) {
  auto code = AssignRegisters(fitted, order.instruction, core);
  if (code) LayOutPairs(order, core, *code);
  return code;
}

Result<FinishedCode> AllocateInOrder(const StraightCode& code, const SchedulingCore& core) {
  const auto fitted = FitRegisters(code, core);
  if (!fitted) return Failure{fitted.error()};
  return KeepOrder(*fitted, core);
}

Result<FinishedCode> Schedule(const StraightCode& code, const SchedulingCore& core) {
  return ScheduleIterations(code, 1, core);
}

Result<FinishedCode> ScheduleIterations(const StraightCode& code, uint32_t iterations,
                                        const SchedulingCore& core) {
  const auto fitted = FitRegisters(code, core);
  if (!fitted) return Failure{fitted.error()};
  auto in_order = KeepOrder(*fitted, core);
  if (!in_order || in_order->program.empty()) return in_order;
  Choice choice(core);
  if (const auto kept = choice.Offer(std::move(in_order)); !kept) return Failure{kept.error()};
  if (const auto tried = choice.OfferScheduled(*fitted); !tried) return Failure{tried.error()};
  if (iterations < kIterationsTogether) return choice.Take();

  const InterleavedCode beside = InterleaveIterations(code, iterations, kIterationsTogether, core);
  auto roomy = FitRegisters(beside.code, WithRoomToRunAhead(core));
  // Conditions are not spilled: what fits one iteration at a time need not fit two.
  if (!roomy) return choice.Take();
  for (uint32_t& origin : roomy->origin)
    if (origin < kPadding) origin = beside.origin[origin];
  if (const auto tried = choice.OfferScheduled(*roomy); !tried) return Failure{tried.error()};
  return choice.Take();
}

}  // namespace pelt
