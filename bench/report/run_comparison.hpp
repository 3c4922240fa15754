// Two ways to run held against each other: what `pelt compare` prints. It reads what `pelt run
// --json` printed, of one run each or of many rounds that took turns.
//
// How sure a ratio is comes from ranks: no bootstrap, no random numbers, no assumption about how
// times are spread but that pairs are independent. A pair is a round of each, or, of one run each,
// the same twelfth of both runs: frames beside each other are alike, so they are taken in blocks.
// What changed on the machine between two single runs is in no such interval; rounds that take
// turns have it in theirs.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/report/report_tree.hpp"

namespace pelt {

// One `pelt run --json`.
struct MeasuredRun {
  std::vector<std::pair<std::string, std::string>> settings;  // what was run, on what
  std::string digest;                                         // empty: not taken
  std::vector<double> frame_ms;
  using Times = std::vector<std::pair<std::string, std::vector<double>>>;
  Times stages_ms;
  Times owners_ms;  // layers, then characters; none of a program that did not say
};

// `from` names the text in errors: a file, or a round of a command. Throws Error.
MeasuredRun ReadMeasuredRun(std::string_view from, std::string_view json);

struct ComparedSide {
  std::string name;
  std::vector<MeasuredRun> rounds;
};

// Of the median of b/a over independent pairs.
struct RatioInterval {
  double ratio, low, high;
};
// The least pairs that an interval can be had of.
inline constexpr size_t kLeastPairs = 6;
// That the interval of so many pairs holds the median, at least 0.95; 0: there are too few.
double ConfidenceOf(size_t pairs);
// None of too few pairs or times that are not above 0.
std::optional<RatioInterval> RatioOf(std::span<const std::pair<double, double>> pairs);
// The medians of the same parts of two series, in order; as many as there can be, up to 12.
std::vector<std::pair<double, double>> PairBlocks(std::span<const double> a,
                                                  std::span<const double> b);

// Both have as many rounds. Throws Error when the rounds of a side are not of one thing.
ReportTree CompareRuns(const ComparedSide& a, const ComparedSide& b);

}  // namespace pelt
