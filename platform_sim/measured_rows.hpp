// The measured rows: what real hardware did on a known piece of work, and what the models say of
// the same work, from the platform's numbers alone. The one table that tests and `pelt budget
// --validate` read.
//
// Idea: a row is its work (rows/), what was measured, how far off a prediction may be, and of which
// kind it is, because one rule says where a platform's availability counts (platforms/cell.hpp): on
// what was held up over many iterations, not on single ways. Both predictions are in the result;
// `Predicted()` is the one that the rule picks and that is compared with the measurement.
//
// Invariant: no row has a number of its own in the models. Each row says of which class it is, and
// only independent ones count as predictions: a row that repeats another, that holds a loop of our
// own making or that is the models' own number would pad the count and prove nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "platform_sim/platforms/platform.hpp"

namespace pelt {

// What a row measures, for the availability.
enum class RowKind : uint8_t {
  // Work held up over many iterations, as a rate or as the mean of one: availability counts.
  kRate,
  kWay,  // a message's way, what an SPU counted of itself, a vendor's print: it does not
};
enum class Allowed : uint8_t { kPercent, kUnits };

// What a row is worth as evidence.
enum class RowClass : uint8_t {
  kIndependent,   // known work, measured, and none of the models' numbers comes from it
  kDerived,       // follows from another row or from its own measurement: no news
  kPlausibility,  // the work is of our choosing, or the prediction rests on guesses: size only
  kParameter,     // the measurement is the models' number
};
inline constexpr uint32_t kRowClassCount = 4;
std::string_view RowClassName(RowClass row_class);

struct RowDefinition {
  std::string_view id, work, unit;
  double measured_least, measured_most;  // equal: one value
  RowKind kind;
  RowClass row_class;
  double allowed;  // beyond the measured range
  Allowed allowed_in;
  std::string_view allowed_from;
  // What the models say, with an availability of 1 for the raw value. False, and why in `error`,
  // when the platform cannot run the work.
  bool (*predict)(const PlatformParameters& platform, double availability, uint32_t argument,
                  double& predicted, std::string& error);
  uint32_t argument = 0;  // what differs between rows of one kind: block bytes, job length
  std::string_view class_because = {};   // why it is not independent
  std::string_view missed_because = {};  // of a row that the models are known to miss
};

struct RowResult {
  std::string_view id, work, unit;
  double measured_least, measured_most;
  double predicted_raw = 0.0, predicted_with_availability = 0.0;
  RowKind kind;
  RowClass row_class;
  double allowed;
  Allowed allowed_in;
  std::string_view allowed_from, class_because, missed_because;
  std::string failure;  // why there is no prediction; empty
  bool passes = false;

  // Missed without a reason given, or given a reason and not missed.
  bool Surprises() const { return passes != missed_because.empty(); }

  double Predicted() const {
    return kind == RowKind::kRate ? predicted_with_availability : predicted_raw;
  }
  // How far off, in percent, from the nearer end of what was measured; 0 inside.
  double ErrorPercent(double predicted) const;
};

std::span<const RowDefinition> MeasuredRows();
// Null if there is no such row.
const RowDefinition* FindRow(std::string_view id);

RowResult PredictRow(const RowDefinition& row, const PlatformParameters& platform);
std::vector<RowResult> PredictRows(const PlatformParameters& platform = {});

// How many rows of a class there are and how many of them are missed.
struct RowCount {
  uint32_t rows = 0, missed = 0;
};
RowCount CountRows(std::span<const RowResult> rows, RowClass row_class);

}  // namespace pelt
