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

std::optional<FinishedCode> KeepOrder(const FittedCode& fitted, const SchedulingCore& core,
                                      std::string& error) {
  std::vector<uint32_t> order(fitted.code.program.size());
  std::iota(order.begin(), order.end(), 0u);
  FinishedCode out;
  if (!AssignRegisters(fitted, order, core, out, error)) return std::nullopt;
  return out;
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

  bool TryOffer(FinishedCode code, std::string& error) {
    const auto chart = core_.time(code.program, error);
    if (!chart) return false;
    if (best_ && chart->totals.cycles >= best_cycles_) return true;
    best_cycles_ = chart->totals.cycles;
    best_ = std::move(code);
    return true;
  }
  bool TryOfferScheduled(const FittedCode& fitted, std::string& error) {
    FinishedCode out;
    return TryFinish(fitted, BestOrder(fitted.code, core_), core_, out, error) &&
           TryOffer(std::move(out), error);
  }
  std::optional<FinishedCode> Take() { return std::move(best_); }

 private:
  const SchedulingCore& core_;
  std::optional<FinishedCode> best_;
  int64_t best_cycles_ = 0;
};

}  // namespace

bool TryFinish(const FittedCode& fitted, const IssueOrder& order, const SchedulingCore& core,
               FinishedCode& out, std::string& error) {
  if (!AssignRegisters(fitted, order.instruction, core, out, error)) return false;
  LayOutPairs(order, core, out);
  return true;
}

std::optional<FinishedCode> TryAllocateInOrder(const StraightCode& code, const SchedulingCore& core,
                                               std::string& error) {
  const std::optional<FittedCode> fitted = TryFitRegisters(code, core, error);
  if (!fitted) return std::nullopt;
  return KeepOrder(*fitted, core, error);
}

std::optional<FinishedCode> TrySchedule(const StraightCode& code, const SchedulingCore& core,
                                        std::string& error) {
  return TryScheduleIterations(code, 1, core, error);
}

std::optional<FinishedCode> TryScheduleIterations(const StraightCode& code, uint32_t iterations,
                                             const SchedulingCore& core, std::string& error) {
  const std::optional<FittedCode> fitted = TryFitRegisters(code, core, error);
  if (!fitted) return std::nullopt;
  std::optional<FinishedCode> in_order = KeepOrder(*fitted, core, error);
  if (!in_order || in_order->program.empty()) return in_order;
  Choice choice(core);
  if (!choice.TryOffer(*std::move(in_order), error)) return std::nullopt;
  if (!choice.TryOfferScheduled(*fitted, error)) return std::nullopt;
  if (iterations < kIterationsTogether) return choice.Take();

  const InterleavedCode beside = InterleaveIterations(code, iterations, kIterationsTogether, core);
  std::optional<FittedCode> roomy = TryFitRegisters(beside.code, WithRoomToRunAhead(core), error);
  // Conditions are not spilled: what fits one turn at a time need not fit two.
  if (!roomy) return choice.Take();
  for (uint32_t& origin : roomy->origin)
    if (origin < kPadding) origin = beside.origin[origin];
  if (!choice.TryOfferScheduled(*roomy, error)) return std::nullopt;
  return choice.Take();
}

}  // namespace pelt
