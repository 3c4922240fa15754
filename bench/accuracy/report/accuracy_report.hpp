// What `pelt accuracy` found, as report trees; and as sections of the report page.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bench/accuracy/feature_errors.hpp"
#include "bench/accuracy/model_error.hpp"
#include "bench/accuracy/scene_precision.hpp"
#include "bench/accuracy/solver_checks.hpp"
#include "bench/accuracy/work_precision.hpp"
#include "bench/report/json_text.hpp"
#include "bench/report/machine.hpp"
#include "core/isa.hpp"

namespace pelt {

// ---- Solvers ---------------------------------------------------------------------------------

// The JSON is what `pelt report --accuracy` reads (AddAccuracySection): a member that goes there
// is part of a format, named by kAccuracyFormat.
inline constexpr std::string_view kAccuracyFormat = "pelt accuracy 3";

struct AccuracyReport {
  accuracy::WorkPrecision table;
  accuracy::ModelErrorOptions model_options;
  accuracy::ModelErrorTable model_error;
  std::vector<accuracy::CantileverRow> cantilever;
  std::vector<accuracy::PendulumRow> pendulum;
  std::vector<accuracy::StabilityRow> stability;
  Machine machine;
  double seconds = 0.0;  // that all of it took
};

ReportTree MakeAccuracyTree(const AccuracyReport& report);

// ---- Scenes ----------------------------------------------------------------------------------

// Of --scene. The diagram is the report page's.
inline constexpr std::string_view kSceneAccuracyFormat = "pelt scene accuracy 2";

struct SceneReport {
  accuracy::ScenePrecision table;
  Machine machine;
  double seconds = 0.0;  // that all of it took
};

ReportTree MakeSceneTree(const SceneReport& report);

// ---- Features --------------------------------------------------------------------------------

// Of --features: error, penetration and time of everything that acts on strands besides their material.
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

// ---- The report page -------------------------------------------------------------------------

// The accuracy sections of the report page: what `pelt accuracy --json` wrote, of solvers or, with
// --scene, of a scene's frames, checked and passed on.
//
// Measuring takes longer than a report may, so the report reads it from a file. Invariant: the file
// comes from outside; only members that are known, of the right type and within limits reach the
// page, and a file that lacks one is an Error that names it.

inline constexpr uint64_t kAccuracyBytesLimit = 16u << 20;

// Adds one object, or throws. `path` is for messages.
void AddAccuracySection(JsonText& json, std::string_view text, const std::string& path);

}  // namespace pelt
