// `pelt calibrate`: what stages cost on this machine.
#include <fmt/format.h>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/fit/host_costs.hpp"
#include "bench/report/report_tree.hpp"

namespace pelt {
namespace {

// Beside what was measured all the same: medians, which others disturb less than they do a verdict.
const std::string kUnsure = "UNSURE, as the machine was not its own: ";

}  // namespace

ExitCode Calibrate(const CalibrateArgs& args) {
  CalibrationOptions options{.workers = args.workers, .frames = args.frames, .scenes = args.scenes};
  Progress progress("calibrate", 1);
  options.progress = [&](const std::string& now) { progress.Show(0, now); };
  std::vector<std::string> disturbances;
  const HostCosts costs = MeasureHost(options, disturbances);
  progress.Clear();
  std::string text = HostCostsText(costs);
  for (const std::string& why : disturbances) text += fmt::format("\n# {}{}\n", kUnsure, why);
  WriteOutput("costs", args.out, text);
  ReportTree tree;
  tree.Say(
      fmt::format("{}, {}, {} workers; commit {}: {} costs of stages; a frame takes {:.3f} of "
                  "its core time: {}",
                  costs.processor, costs.isa, costs.workers, costs.commit, costs.stages.size(),
                  1e-3 * costs.frame_permille, args.out.path()));
  for (const std::string& why : disturbances) tree.Say(kUnsure + why);
  tree.Print(false);
  return kDone;
}

}  // namespace pelt
