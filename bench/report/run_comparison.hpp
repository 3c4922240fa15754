// Two ways to run compared with each other: what `pelt compare` prints. It reads what `pelt run
// --json` printed, of one run each or of many rounds that ran alternately.
//
// How sure a ratio is comes from ranks: no bootstrap, no random numbers, no assumption about how
// times are spread but that pairs are independent. A pair is a round of each, or, of one run each,
// the same twelfth of both runs: frames beside each other are alike, so they are taken in blocks.
// What changed on the machine between two single runs is in no such interval; rounds that
// alternate have it in theirs. The intervals of all rows hold together: with each at 95 % for itself, one
// in twenty rows that are equal would be reported as slower or faster. Where others used the machine,
// no row is reported as either.
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
  std::vector<std::string> disturbances;  // why its machine was not its own
};

// 10,000 frames of a scene with all stages there are make a tenth of it.
inline constexpr uint64_t kRunBytesLimit = 64 << 20;
// `from` names the text in errors: a file, or a round of a command. Throws Error.
MeasuredRun ReadMeasuredRun(std::string_view from, std::string_view json);
MeasuredRun ReadRunFile(const std::string& path);

struct ComparedSide {
  std::string name;
  std::vector<MeasuredRun> rounds;
};

// Of the median of b/a over independent pairs.
struct RatioInterval {
  double ratio, low, high;
};
// That the intervals of all rows hold their medians, at the least.
inline constexpr double kConfidence = 0.95;
// The least pairs that an interval can be had of, if it is one of so many.
size_t PairsNeeded(size_t rows);
// One of so many intervals; none of too few pairs or times that are not above 0.
std::optional<RatioInterval> RatioOf(std::span<const std::pair<double, double>> pairs, size_t rows);
// The medians of the same parts of two series, in order: 12, or more where so many rows need more;
// no more than there are times.
std::vector<std::pair<double, double>> PairBlocks(std::span<const double> a,
                                                  std::span<const double> b, size_t rows);

// What makes the comparison UNSURE, a sentence for each side that others disturbed; empty: nothing.
std::vector<std::string> WhyUnsure(const ComparedSide& a, const ComparedSide& b);

// Both have as many rounds. Throws Error when the rounds of a side are not of one thing.
ReportTree CompareRuns(const ComparedSide& a, const ComparedSide& b);

}  // namespace pelt
