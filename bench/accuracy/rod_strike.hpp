// How far strands of the modal solver go other ways than a rod that the same ball strikes.
//
// A strand is clamped level and hangs at rest. A ball of kStrikeRadius comes across, its middle half its radius
// below the place it hits, lifts the strand and goes on; the strand slides off it and swings. An error
// is the RMS distance of the tip from the rod's (rod_reference.hpp) over the RMS of how far that one has gone from
// where it hung, 60 times a second.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/rod_contact.hpp"

namespace pelt::accuracy {

inline constexpr double kStrikeRadius = 0.3;  // lengths

struct StrikeCase {
  Preset preset;
  double at;     // where it hits, 0 to 1 along the strand at rest
  double speed;  // of the ball, m/s
};
// Dangly, soft and medium strands, at .5 and .8, at 0.5 and 1.5 m/s.
std::vector<StrikeCase> StrikeCases();

struct StrikeErrorRow {
  std::string model;
  ModalQuality quality;
  int rate;                    // frames a second
  std::vector<double> errors;  // share of the way, case after case
};
struct StrikeErrorTable {
  std::vector<StrikeErrorRow> rows;  // model after model, quality after quality
  // Of each case: how far the rod is from one of steps twice as long, and from one of three quarters of the links.
  std::vector<double> step_errors, link_errors;
};

struct StrikeOptions {
  std::vector<RestModel> models = RestModels();
  std::vector<int> rates = {60};  // frames a second, multiples of 60
  int links = 20;
  int steps_per_second = 15360;  // of the rod, a multiple of 120
  double seconds = 0.5;
  bool self_errors = true;
};
StrikeErrorTable MeasureStrikes(const std::vector<StrikeCase>& cases, Isa isa,
                                const StrikeOptions& options = {});

}  // namespace pelt::accuracy
