// What `pelt accuracy --scene` found, as a report tree and as one diagram from the cheapest way to
// run the scene to the most exact.
#pragma once

#include <string>

#include "bench/accuracy/scene_precision.hpp"
#include "bench/report/machine.hpp"

namespace pelt {

inline constexpr std::string_view kSceneAccuracyFormat = "pelt scene accuracy 1";

struct SceneReport {
  accuracy::ScenePrecision table;
  Machine machine;
  double seconds = 0.0;  // that all of it took
};

ReportTree MakeSceneTree(const SceneReport& report);
// An SVG file: error against ns per strand in the simulation, both logarithmic; a named point a way.
std::string SceneSvg(const accuracy::ScenePrecision& table);

}  // namespace pelt
