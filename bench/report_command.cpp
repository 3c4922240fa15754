#include <fmt/format.h>

#include "bench/commands.hpp"
#include "bench/progress.hpp"
#include "bench/report_page.hpp"
#include "jobs/tick_clock.hpp"
#include "traces/file_bytes.hpp"

namespace pelt {

int Report(const ReportArgs& args) {
  CheckRecords(args.run.options.executor);
  Scenario scenario = LoadForRun(args.run, stdout);
  RunOptions options = args.run.options;
  RunningScenario running(scenario, options.scene);
  ReportRecorder recorder(running.scene());
  options.observed_as = Recording::kAll;
  options.observe = [&](const FinishedFrame& frame) { recorder.Add(frame); };
  const TickScale tick_scale;
  RunReport report;
  {
    Progress progress("run", options.frames ? options.frames : scenario.default_frames);
    options.progress = [&](uint32_t done, uint32_t) { progress.Show(done); };
    report = RunFrames(scenario, running, options);
  }
  WriteFileBytes("report", args.out, AsBytes(recorder.Page(report, tick_scale.NsPerTick())));
  fmt::print("report of {} frames {}\n", report.frames, args.out);
  return 0;
}

}  // namespace pelt
