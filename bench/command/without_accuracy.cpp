// In builds without bench/accuracy: what needs it says so.
#include "bench/command/command_options.hpp"
#include "bench/fit/layer_errors.hpp"

namespace pelt {
namespace {

Subcommand SetUpWithoutAccuracy(CLI::App& root, const char* name) {
  CLI::App* app = root.add_subcommand(name, "Left out of this build: -DPELT_ACCURACY=ON");
  app->allow_extras();
  return {app, [] {},
          [] {
            RequireAccuracy();
            return kNoAnswer;
          }};
}

}  // namespace

Subcommand SetUpAccuracy(CLI::App& root) { return SetUpWithoutAccuracy(root, "accuracy"); }
Subcommand SetUpStress(CLI::App& root) { return SetUpWithoutAccuracy(root, "stress"); }

std::function<void(JsonText&)> ReadAccuracySection(const std::string&) {
  RequireAccuracy();
  return {};
}

}  // namespace pelt
