// What the `pelt` command can do. Each function does one subcommand, writes its result to standard
// output and returns the exit code; bad input is thrown as Error.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bench/run_report.hpp"
#include "bench/scenarios.hpp"

namespace pelt {

struct BakeArgs {
  std::string character = "builtin";
  std::string setup = "monster";
  std::string out;
  uint64_t seed = 0;
  bool stats = false, keys = false, json = false;
};
int Bake(const BakeArgs& args);

struct RunArgs {
  ScenarioRequest request;
  RunOptions options;
  std::optional<WeatherCourse> weather;  // the scenario's own if not given
  double fps = 0.0;                      // 0: the scenario's own
  std::string picture;
  uint32_t picture_width_px = 1200, picture_height_px = 900;
  bool json = false;
};
int Run(const RunArgs& args);

struct PlanArgs {
  ScenarioRequest request;
  SceneOptions options;
  bool chunk = false, json = false;
};
int PrintPlan(const PlanArgs& args);

struct VerifyArgs {
  ScenarioRequest request;
  uint32_t frames = 20;
  std::optional<Isa> isa;  // only this instruction set, besides the reference
  bool skips = true, json = false;
};
int VerifyScene(const VerifyArgs& args);

}  // namespace pelt
