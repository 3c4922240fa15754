// One modelled run of tiny for each console, shared by all tests that only look at it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench/consoles/console_report.hpp"
#include "bench/report/json_text.hpp"

namespace pelt::testing {

inline constexpr uint32_t kModelledFrames = 40;

// tiny on a console.
struct Modelled {
  Scenario scenario = LoadScenario("tiny");
  ConsoleRun run;
  ConsoleBudget budget;

  explicit Modelled(const ConsoleRequest& request) : run(scenario, request), budget(run.Run()) {}
  const FurScene& scene() const { return run.scene(); }
  const Plan& plan() const { return run.scene().plan(); }
};

// Of kModelledFrames; made once.
inline Modelled& On(Console console) {
  static std::map<Console, std::unique_ptr<Modelled>> made;
  std::unique_ptr<Modelled>& on = made[console];
  if (!on)
    on = std::make_unique<Modelled>(ConsoleRequest{.console = console, .frames = kModelledFrames});
  return *on;
}

inline std::string TextOf(const ConsoleBudget& budget, const FurScene& scene) {
  ReportTree tree;
  AddConsole(budget, scene, tree);
  return tree.Text();
}

// On one line.
inline std::string ProseOf(const ConsoleBudget& budget, const FurScene& scene) {
  std::string text = TextOf(budget, scene);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// What `add` writes, parsed.
template <class Add>
nlohmann::json JsonOf(Add add) {
  JsonText json;
  add(json);
  return nlohmann::json::parse(json.text(), nullptr, false);
}

class ConsoleOf : public ::testing::TestWithParam<Console> {
 protected:
  Modelled& on() { return On(GetParam()); }
};

}  // namespace pelt::testing
