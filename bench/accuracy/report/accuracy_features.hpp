// What `pelt accuracy --features` found: error, penetration and time of everything that acts on
// strands besides their material (bench/accuracy/feature_errors.hpp).
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/feature_errors.hpp"
#include "bench/report/machine.hpp"
#include "core/kernels/frame_table.hpp"

namespace pelt {

inline constexpr std::string_view kFeatureAccuracyFormat = "pelt feature accuracy 1";

struct FeatureReport {
  struct Chain {
    int links;
    std::vector<accuracy::FeatureError> rows;
  };
  std::vector<Chain> chains;
  accuracy::FeatureOptions options;  // but for the links
  Isa isa = BestIsa();
  bool quick = false;
  Machine machine;
  double seconds = 0.0;  // that all of it took
};

// `links` empty: 3 and 4. Quick: one second of motion and fewer rounds of the clock.
FeatureReport MeasureFeatureReport(Isa isa, const std::vector<int>& links, bool quick);

ReportTree MakeFeatureTree(const FeatureReport& report);

}  // namespace pelt
