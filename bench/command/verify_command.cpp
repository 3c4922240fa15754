#include <fmt/format.h>

#include <algorithm>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/verify/shard.hpp"
#include "bench/verify/verify.hpp"

namespace pelt {
namespace {

// What two runs must have alike for their cases to be of one list.
Fingerprint FingerprintOf(const VerifyArgs& args, const VerifyReport& report) {
  const ScenarioRequest& request = args.request;
  Fingerprint all = FingerprintOfBuild("verify");
  const auto add = [&](std::string name, std::string value) {
    all.emplace_back(std::move(name), std::move(value));
  };
  add("scene", report.scene);
  add("only", args.isa ? std::string(IsaName(*args.isa)) : std::string("-"));
  if (args.random) return all;  // seeds say the rest
  if (request.scene.empty()) {
    add("character", request.character);
    add("fur", request.setup.empty() ? request.groom : request.setup);
  }
  add("strands", fmt::format("{}", report.strands));
  add("seed", fmt::format("{}", request.seed));
  add("frames", fmt::format("{}", report.frames));
  add("skips", args.skips ? "yes" : "no");
  add("checks", !args.checks ? "no" : args.every_executor ? "full" : "yes");
  add("rollback", fmt::format("{}", args.rollback));
  // Says the rest: solver, quality, what is in the files.
  add("digest", fmt::format("{:016x}", report.digest));
  return all;
}

}  // namespace

ExitCode VerifyScene(const VerifyArgs& args) {
  if (!args.merge.empty()) return PrintMergedShards("verify", args.merge, args.json);
  VerifyOptions options;
  options.frames = args.frames;
  options.skips = args.skips;
  options.shard = args.shard;
  options.stop_at_failure = args.stop_at_failure;
  options.checks = args.checks;
  options.rollback = args.rollback;
  options.every_executor = args.every_executor;
  if (args.isa) options.filter = [&](const VerifyCase& c) { return c.isa == *args.isa; };
  VerifyReport report;
  if (args.random) {
    Progress progress("verify", args.random);
    options.progress = [&](uint32_t done, uint32_t, const std::string& now) {
      progress.Show(done, now);
    };
    report = VerifyRandom(args.random, args.request.seed, options);
  } else {
    Scenario scenario = LoadScenario(args.request);
    scenario.velocities |= args.velocities;
    scenario.origins |= args.origins;
    const std::vector<VerifyCase> all = AllCases();
    const auto wanted = [&](const VerifyCase& c) { return !options.filter || options.filter(c); };
    const auto cases = uint32_t(std::count_if(all.begin(), all.end(), wanted));
    Progress progress("verify", cases);
    options.progress = [&](uint32_t done, uint32_t total, const std::string& now) {
      progress.Show(total == 0 ? cases : done, now);
    };
    report = Verify(scenario, options);
  }
  const ReportTree tree = MakeVerifyTree(report, FingerprintOf(args, report));
  tree.Print(args.json);
  if (report.Passed() && !report.Missing().empty()) return kIncomplete;
  return AnswerOf(report.Passed());
}

}  // namespace pelt
