// `pelt budget`: host, PS3 and Xbox 360 against a target.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/consoles/console_advice.hpp"
#include "bench/consoles/console_report.hpp"
#include "bench/consoles/console_timeline.hpp"
#include "bench/consoles/kernel_rows_report.hpp"
#include "core/error.hpp"
#include "platform_sim/frame/what_if.hpp"
#include "traces/chrome_trace.hpp"

namespace pelt {

PlatformParameters NumbersOf(const BudgetArgs& args) {
  PlatformParameters p;
  if (args.spus) p.cell.spu_count = *args.spus;
  // What a message says is what was given, as far as 32 bits go.
  if (args.local_store_kib)
    p.cell.local_store_bytes =
        uint32_t(std::min<uint64_t>(uint64_t(*args.local_store_kib) * 1024, 1u << 30));
  if (args.cores) p.xenon.cores = *args.cores;
  if (args.gpu_percent) p.xenon.gpu_permille = *args.gpu_percent * 10;
  return p;
}

namespace {

int PrintNumbers(const BudgetArgs& args) {
  const PlatformParameters p = NumbersOf(args);
  ReportTree tree;
  tree.Say(
      "How sure: P published or measured and read at its source; S second-hand; L a lead only.");
  ReportTable& table = tree.AddTable(
      "numbers", {{"console"}, {"sure"}, {"value"}, {"unit"}, {"number"}, {"source"}});
  const auto add = [&](std::string_view console, const std::vector<PlatformNumber>& numbers) {
    for (const PlatformNumber& n : numbers)
      table.Add({console, std::string(1, SurenessLetter(n.sure)), fmt::format("{}", n.value),
                 n.unit, n.name, n.source});
  };
  add("ps3", DescribeCell(p.cell));
  add("xbox360", DescribeXenon(p.xenon));
  fmt::print("{}", tree.Text());
  return 0;
}

// What every platform comes down to.
struct Verdict {
  std::string platform, what = {};
  Spread frame_ms = {};
  double ms = 0.0;  // what it is about
  bool fits = false;
  std::string range = {};    // of a console
  std::string refusal = {};  // why it cannot run there at all
};

class BudgetPrinter {
 public:
  explicit BudgetPrinter(const BudgetArgs& args) : args_(args) {
    RunArgs run;
    run.request = args.request;
    scenario_ = LoadForRun(run, args.json ? stderr : stdout);
    frames_ = args.frames ? args.frames : scenario_.default_frames;
  }

  int Print() {
    json_.BeginObject();
    json_.Add("scene", scenario_.name);
    json_.Add("strands", scenario_.StrandCount());
    json_.Add("frames", frames_);
    json_.Add("warm_up_frames", args_.warm_up);
    json_.Add("target_ms", args_.target_ms);
    json_.BeginArray("platforms");
    for (const std::string& platform : args_.platforms) {
      json_.BeginObject();
      json_.Add("platform", platform);
      if (platform == "host")
        AddHost();
      else
        AddConsoleOrRefusal(platform == "ps3" ? Console::kPs3 : Console::kXbox360);
      json_.Add("fits", verdicts_.back().fits);
      json_.EndObject();
    }
    json_.EndArray();
    const bool fits =
        std::all_of(verdicts_.begin(), verdicts_.end(), [](const Verdict& v) { return v.fits; });
    json_.Add("fits", fits);
    json_.EndObject();
    if (!args_.trace.empty()) WriteTrace();
    if (args_.json)
      fmt::print("{}\n", json_.text());
    else
      PrintVerdicts();
    if (!fault_.empty()) throw Error(fault_);
    return fits ? 0 : 1;
  }

 private:
  void AddHost() {
    RunOptions options;
    options.frames = frames_;
    options.warm_up = args_.warm_up;
    options.skip = args_.skip;
    options.lod = args_.lod;
    options.digest = false;
    RunningScenario running(scenario_, options.scene);
    Progress progress("host", frames_);
    options.progress = [&](uint32_t done, uint32_t) { progress.Show(done); };
    const RunReport report = RunFrames(scenario_, running, options);
    progress.Clear();
    const Spread& ms = report.budget.wall_ms;
    const std::string what =
        fmt::format("{} workers, {}, measured", report.workers, IsaName(options.scene.isa));
    verdicts_.push_back({"host", what, ms, ms.p95, ms.p95 <= args_.target_ms});
    json_.Add("processor", report.machine.processor);
    json_.Add("workers", report.workers);
    json_.BeginObject("frame_ms");
    json_.Add("median", ms.median);
    json_.Add("p95", ms.p95);
    json_.Add("worst", ms.worst);
    json_.EndObject();
    if (!args_.json) {
      ReportTree tree;
      AddBudget(report.budget, report.workers, tree);
      fmt::print("host: {} ({} cores), {}; commit {}\n{}\n", report.machine.processor,
                 report.machine.cores, what, report.machine.commit, tree.Text());
    }
  }

  // A scene that a console cannot run at all is a verdict too; the others still get theirs.
  void AddConsoleOrRefusal(Console console) {
    try {
      AddConsoleOf(console);
    } catch (const Error& error) {
      json_.Add("refused", error.what());
      verdicts_.push_back({.platform = std::string(ConsoleName(console)), .refusal = error.what()});
    }
  }

  void AddConsoleOf(Console console) {
    ConsoleRequest request{.console = console,
                           .numbers = NumbersOf(args_),
                           .frames = frames_,
                           .warm_up = args_.warm_up,
                           .what_if = *ParseWhatIf(args_.what_if),
                           .skip = args_.skip,
                           .lod = args_.lod};
    Progress progress(ConsoleName(console), frames_);
    request.progress = [&](uint32_t done, uint32_t) { progress.Show(done); };
    ConsoleRun run(scenario_, request);
    const ConsoleBudget budget = run.Run();
    const FrameSummary& s = budget.summary;
    std::vector<std::string> advice;
    if (args_.advice) advice = Advise(run, budget, args_.target_ms);
    progress.Clear();

    verdicts_.push_back({std::string(ConsoleName(console)),
                         fmt::format("{} {}, modelled", budget.machine.units,
                                     budget.machine.local_store_bytes ? "SPUs" : "threads"),
                         {s.median_ms, s.p95_ms, s.worst_ms},
                         budget.VerdictMs(),
                         budget.Fits(args_.target_ms),
                         RangeOf(budget)});
    AddConsole(json_, budget, run.scene());
    json_.Add("fits_scheduled",
              budget.machine.Available(budget.scheduled_ms.p95) <= args_.target_ms);
    json_.Add("fits_as_written",
              budget.machine.Available(budget.as_written_ms.p95) <= args_.target_ms);
    json_.BeginArray("advice");
    for (const std::string& line : advice) json_.Add("", line);
    json_.EndArray();
    if (!args_.json) {
      fmt::print("{}", DescribeConsole(budget, run.scene()));
      for (const std::string& line : advice)
        fmt::print("to fit {} ms: {}\n", args_.target_ms, line);
      fmt::print("\n");
    }
    if (!args_.trace.empty())
      AddConsoleTracks(run.scene(), budget.machine, budget.slowest, timeline_);
    if (fault_.empty() && budget.differs_at)
      fault_ = fmt::format("{}: frame {} has another digest than the host's", budget.machine.name,
                           *budget.differs_at);
    if (fault_.empty() && !budget.faults.empty())
      fault_ = fmt::format("{}: {} local-store faults, the first: {}", budget.machine.name,
                           budget.faults.size(), budget.faults.front());
  }

  std::string RangeOf(const ConsoleBudget& budget) const {
    std::string out = DescribeRange(budget);
    if (budget.FitsOnlyAtOneEnd(args_.target_ms)) out += ": THE VERDICT HANGS ON THE SCHEDULE";
    return out;
  }

  void PrintVerdicts() const {
    fmt::print(
        "{}: {} strands, {} frames behind {} to warm up; a frame may take {} ms, by its 95th "
        "percentile: as measured on this machine, with {} availability on a console\n",
        scenario_.name, scenario_.StrandCount(), frames_, args_.warm_up, args_.target_ms,
        CellSystem{}.Availability());
    bool has_range = false;
    for (const Verdict& v : verdicts_) {
      if (!v.refusal.empty()) {
        fmt::print("  {:<8} CANNOT RUN: {}\n", v.platform, v.refusal);
        continue;
      }
      fmt::print(
          "  {:<8} {:<32} median {:>7.2f}  p95 {:>7.2f}  worst {:>7.2f} ms; {:>7.2f} ms {} {} ms "
          "({})\n",
          v.platform, v.what, v.frame_ms.median, v.frame_ms.p95, v.frame_ms.worst, v.ms,
          v.fits ? "FITS" : "DOES NOT FIT", args_.target_ms, DescribeFit(v.ms));
      if (!v.range.empty()) fmt::print("  {:<8} {}\n", "", v.range);
      has_range = has_range || !v.range.empty();
    }
    if (has_range)
      fmt::print("consoles' verdicts: code {}\n",
                 DescribePlace(std::clamp(MeasuredCodePlace().mean, 0.0, 1.0)));
    if (!args_.trace.empty()) fmt::print("trace {}\n", args_.trace.path());
  }

  void WriteTrace() {
    timeline_.process = fmt::format("pelt {}, modelled", scenario_.name);
    timeline_.metadata = {{"scene", scenario_.name}, {"times", "modelled, not measured"}};
    WriteOutput("trace", args_.trace, ChromeTrace(timeline_));
  }

  const BudgetArgs& args_;
  Scenario scenario_;
  uint32_t frames_ = 0;
  JsonText json_;
  std::vector<Verdict> verdicts_;
  Timeline timeline_;  // the slowest frame of every console
  std::string fault_;  // what makes the model's figures worthless
};

}  // namespace

int PrintBudget(const BudgetArgs& args) {
  if (args.validate) return PrintValidation({args.json});
  if (args.numbers) return PrintNumbers(args);
  return BudgetPrinter(args).Print();
}

}  // namespace pelt
