// What 16 bits would cost where Pelt has floats, and cost where it has 16 bits already.
//
// Pelt keeps a chain's state in floats and writes places as floats; of lines' vertices the tangents
// are 16 bits signed. Each row replaces one of these and says how far points, or tangents, are from
// those of the same strands without it, on the drawn problems at 60 Hz with quality `fine`.
// State is packed after each frame and read back for the next, so its error is what the motion
// makes of it; what is written is packed once.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/drawn_problem.hpp"
#include "core/isa.hpp"

namespace pelt::accuracy {

struct QuantisationOptions {
  DrawnOptions drawn;
  int strands = 4;  // a motion
  int links = 3;
  std::vector<Preset> presets{std::begin(kPresets), std::end(kPresets)};
  double seconds = kMotionSeconds;
};

struct QuantisationRow {
  std::string what;
  int bytes = 0;       // of a strand's state, or of a place or tangent
  double rms_m = 0.0;  // distance of points; of tangents 0
  double worst_m = 0.0;
  double of_length = 0.0;     // RMS over strands' lengths; of tangents, of their own
  double of_secondary = 0.0;  // RMS over that of the secondary motion; of tangents 0
};

// Throws Error where this program or processor lacks the instruction set.
std::vector<QuantisationRow> MeasureQuantisation(const QuantisationOptions& options, Isa isa);

}  // namespace pelt::accuracy
