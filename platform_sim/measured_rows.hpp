// The measured rows: what real hardware did on a known piece of work, and what the models say of
// the same work, from the platform's numbers alone. The one table that tests and `pelt budget
// --validate` read.
//
// Idea: a row is its work (rows/), what was measured, how far off a prediction may be, and of which
// kind it is, because one rule says where a platform's availability counts (cell_system.hpp): on
// rates, not on single ways. Both predictions are in the result; `Predicted()` is the one that the
// rule picks and that is held against the measurement.
//
// Invariant: no row has a number of its own in the models. Rows that are their own parameter
// (`is_parameter`) are listed so that nobody counts them as predictions.
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
  kRate,  // operations, bytes or jobs held up over many turns: availability counts
  kWay,   // the time or the gain of a single way: it does not
};
enum class Allowed : uint8_t { kPercent, kUnits };

struct RowDefinition {
  std::string_view id, work, unit;
  double measured_least, measured_most;  // equal: one value
  RowKind kind;
  bool is_parameter;
  double allowed;  // beyond the measured range
  Allowed allowed_in;
  std::string_view allowed_from;
  // What the models say, with an availability of 1 for the raw value. False, and why in `error`,
  // when the platform cannot run the work.
  bool (*predict)(const PlatformParameters& p, double availability, uint32_t argument,
                  double& predicted, std::string& error);
  uint32_t argument = 0;  // what differs between rows of one kind: block bytes, job length
};

struct RowResult {
  std::string_view id, work, unit;
  double measured_least, measured_most;
  double predicted_raw = 0.0, predicted_with_availability = 0.0;
  RowKind kind;
  bool is_parameter;
  double allowed;
  Allowed allowed_in;
  std::string_view allowed_from;
  std::string failure;  // why there is no prediction; empty
  bool passes = false;

  double Predicted() const {
    return kind == RowKind::kRate ? predicted_with_availability : predicted_raw;
  }
  // How far off, in percent, from the nearer end of what was measured; 0 inside.
  double ErrorPercent(double predicted) const;
};

std::span<const RowDefinition> MeasuredRows();
// Null if there is no such row.
const RowDefinition* FindRow(std::string_view id);

RowResult PredictRow(const RowDefinition& row, const PlatformParameters& p);
std::vector<RowResult> PredictRows(const PlatformParameters& p = {});

}  // namespace pelt
