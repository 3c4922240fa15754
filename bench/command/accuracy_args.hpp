// What `pelt accuracy` is asked for: all that its options and its function (commands.hpp) take of bench/accuracy.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/drawn_problem.hpp"
#include "bench/command/output_path.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "core/isa.hpp"

namespace pelt {

// Error off a rod against run time, of layers and every strand solver; or, with `scene`, of every way to run its
// frames; or, with `features`, of contacts, clumps and wind.
struct AccuracyArgs {
  std::vector<int> rates, links;         // empty: all
  std::vector<std::string> presets;      // empty: all
  uint64_t seed = accuracy::kDrawnSeed;  // that problems are drawn from
  bool tuned = false;                    // instead: the suite that chose the constants
  bool calibrated = false;  // there: strands as layers have them, not equal masses and joints
  Isa isa = BestIsa();
  bool quick = false;                    // few solvers, cases and rounds
  OutputPath json;                       // file to write
  std::optional<ScenarioRequest> scene;  // frames of this instead of the benchmark
  uint32_t frames = 0;                   // of the scene; 0: enough
  bool contact = true;                   // in the scene
  bool features = false;
};

}  // namespace pelt
