#include "platform_sim/pipeline/issue_chart.hpp"

#include <algorithm>
#include <numeric>

namespace pelt {

std::string_view StallCauseName(StallCause cause) {
  static constexpr std::string_view kNames[kStallCauseCount] = {
      "register",       "branch",       "not pipelined", "FP6 after FP7",
      "load-hit-store", "other thread", "hint target"};
  return kNames[uint32_t(cause)];
}

std::string_view UnpairedName(Unpaired reason) {
  static constexpr std::string_view kNames[kUnpairedCount] = {
      "paired", "first", "pipe", "address", "not ready", "never pairs"};
  return kNames[uint32_t(reason)];
}

uint64_t IssueTotals::AllStallCycles() const {
  return std::accumulate(stall_cycles.begin(), stall_cycles.end(), uint64_t{0});
}

double IssueTotals::DualIssueRate() const {
  return IssueCycles() ? double(dual_issues) / double(IssueCycles()) : 0.0;
}

namespace {

template <class Change>
void ChangeAll(IssueTotals& totals, const IssueTotals& other, Change change) {
  change(totals.cycles, other.cycles);
  change(totals.instructions, other.instructions);
  change(totals.dual_issues, other.dual_issues);
  const auto each = [&](auto& mine, const auto& theirs) {
    for (size_t i = 0; i < mine.size(); ++i) change(mine[i], theirs[i]);
  };
  each(totals.stall_cycles, other.stall_cycles);
  each(totals.unpaired, other.unpaired);
  each(totals.pipe_cycles, other.pipe_cycles);
}

}  // namespace

IssueTotals& IssueTotals::operator+=(const IssueTotals& other) {
  ChangeAll(*this, other, [](auto& a, auto b) { a += b; });
  return *this;
}
IssueTotals& IssueTotals::operator-=(const IssueTotals& other) {
  ChangeAll(*this, other, [](auto& a, auto b) { a -= b; });
  return *this;
}
IssueTotals operator*(IssueTotals totals, uint64_t times) {
  ChangeAll(totals, totals, [times](auto& a, auto) { a *= times; });
  return totals;
}

std::string_view BindingResource(const IssueChart& chart, const IssueTotals& totals) {
  std::string_view best = "nothing";
  uint64_t most = 0;
  const auto consider = [&](std::string_view name, uint64_t cycles) {
    if (cycles <= most) return;
    most = cycles;
    best = name;
  };
  for (size_t p = 0; p < chart.pipes.size(); ++p) consider(chart.pipes[p], totals.pipe_cycles[p]);
  for (uint32_t c = 0; c < kStallCauseCount; ++c) {
    // What an instruction that is not pipelined blocks is its pipe's time already.
    if (StallCause(c) == StallCause::kBlocked) continue;
    consider(StallCauseName(StallCause(c)), totals.stall_cycles[c]);
  }
  return best;
}

}  // namespace pelt
