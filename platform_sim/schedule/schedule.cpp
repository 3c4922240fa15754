#include "platform_sim/schedule/schedule.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "platform_sim/schedule/assign_registers.hpp"
#include "platform_sim/schedule/fit_registers.hpp"
#include "platform_sim/schedule/interleave_iterations.hpp"
#include "platform_sim/schedule/lay_out_pairs.hpp"
#include "platform_sim/schedule/list_schedule.hpp"

namespace pelt {
namespace {

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
