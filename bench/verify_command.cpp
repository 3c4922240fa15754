#include <fmt/format.h>

#include <algorithm>

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
    const std::vector<VerifyCase> all = AllCases();
    const auto wanted = [&](const VerifyCase& c) { return !options.filter || options.filter(c); };
    Progress progress("verify", uint64_t(std::count_if(all.begin(), all.end(), wanted)));
    options.progress = [&](uint32_t done, uint32_t, const std::string& now) {
      progress.Show(done, now);
    };
    report = Verify(scenario, options);
  }
  fmt::print("{}\n", args.json ? ReportAsJson(report) : DescribeReport(report));
  return report.Passed() ? 0 : 1;
}

}  // namespace pelt
