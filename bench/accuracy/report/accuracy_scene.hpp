// What `pelt accuracy --scene` found, as a report tree. The diagram is the report page's
// (accuracy_section.hpp).
#pragma once

#include <string_view>

#include "bench/accuracy/scene_precision.hpp"
#include "bench/report/machine.hpp"

namespace pelt {

inline constexpr std::string_view kSceneAccuracyFormat = "pelt scene accuracy 2";

struct SceneReport {
  accuracy::ScenePrecision table;
  Machine machine;
  double seconds = 0.0;  // that all of it took
};

ReportTree MakeSceneTree(const SceneReport& report);

}  // namespace pelt
