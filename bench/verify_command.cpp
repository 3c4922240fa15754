#include <fmt/format.h>

#include "bench/commands.hpp"
#include "bench/progress.hpp"
#include "bench/verify.hpp"

namespace pelt {

int VerifyScene(const VerifyArgs& args) {
  Scenario scenario = LoadScenario(args.request);
  VerifyOptions options;
  options.frames = args.frames;
  options.skips = args.skips;
  if (args.isa) options.filter = [&](const VerifyCase& c) { return c.isa == *args.isa; };
  VerifyReport report;
  {
    Progress progress("verify", args.isa ? AllCases().size() / 4 : AllCases().size());
    options.progress = [&](uint32_t done, uint32_t, const std::string& now) {
      progress.Show(done, now);
    };
    report = Verify(scenario, options);
  }
  fmt::print("{}\n", args.json ? ReportAsJson(report) : DescribeReport(report));
  return report.Passed() ? 0 : 1;
}

}  // namespace pelt
