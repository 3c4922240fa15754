// `pelt budget`: host, PS3 and Xbox 360 against a target.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/consoles/console_budget.hpp"
#include "bench/consoles/console_report.hpp"
#include "bench/fit/console_price.hpp"
#include "bench/fit/layer_errors.hpp"
#include "bench/fit/tiers.hpp"
#include "bench/report/machine_use.hpp"
#include "core/error.hpp"
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

ExitCode PrintNumbers(const BudgetArgs& args) {
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
  return kDone;
}

// What every platform comes down to.
struct Verdict {
  std::string platform, what = {};
  Spread frame_ms = {};
  double ms = 0.0;  // what it is about
  Fit fit = Fit::kDoesNotFit;
  std::string range = {};                      // of a console
  std::string refusal = {};                    // why it cannot run there at all
  std::vector<std::string> disturbances = {};  // of the host, which are why it is unsure

  std::string_view Name() const { return refusal.empty() ? FitName(fit) : "CANNOT RUN"; }
};

ExitCode ExitCodeOf(Fit fit) {
  return fit == Fit::kUnsure ? kNoAnswer : AnswerOf(fit == Fit::kFits);
}

// Absent where it is not known.
void AddFit(Fit fit, ReportTree& tree) {
  tree.Add(InJson("fits"), fit == Fit::kUnsure ? Value() : Value(fit == Fit::kFits));
}

// Whether all layers have the same solver and quality.
bool SameSimulation(const Scenario& a, const Scenario& b) {
  for (size_t g = 0; g < a.grooms.size(); ++g)
    for (size_t l = 0; l < a.grooms[g].layers.size(); ++l) {
      const LayerParams &p = a.grooms[g].layers[l].params, &q = b.grooms[g].layers[l].params;
      if (p.solver != q.solver || p.quality != q.quality) return false;
    }
  return true;
}

class BudgetPrinter {
 public:
  explicit BudgetPrinter(const BudgetArgs& args) : args_(args) {
    for (auto& known : known_) known = std::make_shared<KnownPrices>();
    RunArgs run;
    run.request = args.request;
    scenario_ = LoadForRun(run, args.json ? stderr : stdout);
    frames_ = args.frames ? args.frames : scenario_.default_frames;
  }

  ExitCode Print() {
    tree_.Add(InJson("scene"), scenario_.name).Add(InJson("strands"), scenario_.StrandCount());
    tree_.Add(InJson("frames"), frames_).Add(InJson("warm_up_frames"), args_.warm_up);
    tree_.Add(InJson("target_ms"), args_.target_ms);
    for (const std::string& platform : args_.platforms) {
      ReportTree& entry = tree_.AddEntry("platforms");
      entry.Add(InJson("platform"), platform);
      if (platform == "host")
        AddHost(entry);
      else
        AddConsoleOrRefusal(platform == "ps3" ? Console::kPs3 : Console::kXbox360, entry);
      entry.Add(InJson("verdict"), verdicts_.back().Name());
      AddFit(verdicts_.back().fit, entry);
    }
    std::vector<Fit> fits;
    for (const Verdict& v : verdicts_) fits.push_back(v.fit);
    const Fit all = JudgeAll(fits);
    tree_.Add(InJson("verdict"), FitName(all));
    AddFit(all, tree_);
    AddVerdicts();
    if (args_.qualities) AddQualities();
    if (all == Fit::kUnsure && fault_.empty())
      tree_.Say(
          "UNSURE: exit code 2. The times are not the scene's alone; measure again while nothing "
          "else runs");
    if (!args_.trace.empty()) WriteTrace();
    tree_.Print(args_.json);
    if (!fault_.empty()) throw Error(fault_);
    return ExitCodeOf(all);
  }

 private:
  RunReport RunOnHost(Scenario& scenario, const LodSettings& lod) const {
    RunOptions options;
    options.frames = frames_;
    options.warm_up = args_.warm_up;
    options.skip = args_.skip;
    options.lod = lod;
    options.digest = false;
    RunningScenario running(scenario, options.scene);
    Progress progress("host", frames_);
    options.progress = [&](uint32_t done, uint32_t) { progress.Show(done); };
    return RunFrames(scenario, running, options);
  }

  void AddHost(ReportTree& entry) {
    const RunReport report = RunOnHost(scenario_, args_.lod);
    const Spread& ms = report.budget.wall_ms;
    const std::string what =
        fmt::format("{} workers, {}, measured", report.workers, IsaName(SceneOptions{}.isa));
    const auto disturbances = FindDisturbances(report.use, report.workers);
    verdicts_.push_back({.platform = "host",
                         .what = what,
                         .frame_ms = ms,
                         .ms = ms.p95,
                         .fit = JudgeTime(ms.p95, args_.target_ms, !disturbances.empty()),
                         .disturbances = disturbances});
    entry.Say(fmt::format("host: {} ({} cores), {}; commit {}", report.machine.processor,
                          report.machine.cores, what, report.machine.commit));
    entry.Add(InJson("processor"), report.machine.processor);
    entry.Add(InJson("workers"), report.workers);
    entry.Add(InJson("frame_ms.median"), ms.median).Add(InJson("frame_ms.p95"), ms.p95);
    entry.Add(InJson("frame_ms.worst"), ms.worst);
    AddMachineUse(report.use, report.workers, entry);
    if (!args_.json) AddBudget(report.budget, report.workers, entry);
  }

  // A scene that a console cannot run at all is a verdict too; the others still get theirs.
  void AddConsoleOrRefusal(Console console, ReportTree& entry) {
    try {
      AddConsoleOf(console, entry);
    } catch (const Error& error) {
      entry.Add(InJson("refused"), error.what());
      verdicts_.push_back({.platform = std::string(ConsoleName(console)), .refusal = error.what()});
    }
  }

  ConsoleRequest RequestOf(Console console, const LodSettings& lod) const {
    ConsoleRequest request{.console = console,
                           .numbers = NumbersOf(args_),
                           .frames = frames_,
                           .warm_up = args_.warm_up,
                           .skip = args_.skip,
                           .lod = lod,
                           .known = known_[size_t(console)]};
    if (lod.budget_us > 0) request.lod.costs = FurCostsOnConsole(scenario_, request);
    return request;
  }

  void AddConsoleOf(Console console, ReportTree& entry) {
    ConsoleRequest request = RequestOf(console, args_.lod);
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
                         JudgeTime(budget.VerdictMs(), args_.target_ms, false),
                         RangeOf(budget)});
    entry.BlankLine();
    AddConsole(budget, run.scene(), entry);
    entry.Add(InJson("fits_scheduled"),
              budget.machine.Available(budget.scheduled_ms.p95) <= args_.target_ms);
    entry.Add(InJson("fits_as_written"),
              budget.machine.Available(budget.as_written_ms.p95) <= args_.target_ms);
    entry.AddTexts("advice", advice, fmt::format("to fit {} ms", args_.target_ms));
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

  void AddVerdicts() {
    tree_.BlankLine();
    tree_.Say(fmt::format(
        "{}: {} strands, {} frames behind {} to warm up; a frame may take {} ms, by its 95th "
        "percentile: as measured on this machine, with {} availability on a console",
        scenario_.name, scenario_.StrandCount(), frames_, args_.warm_up, args_.target_ms,
        CellSystem{}.Availability()));
    ReportTable& table =
        tree_.AddTable({}, {InText("platform"), InText("median", "ms", 2), InText("p95", "ms", 2),
                            InText("worst", "ms", 2), InText("verdict's", "ms", 2),
                            InText("verdict"), InText("what")});
    std::vector<std::string> remarks;
    for (const Verdict& v : verdicts_) {
      if (!v.refusal.empty()) {
        remarks.push_back(fmt::format("{} CANNOT RUN: {}", v.platform, v.refusal));
        continue;
      }
      table.Add(
          {v.platform, v.frame_ms.median, v.frame_ms.p95, v.frame_ms.worst, v.ms,
           v.fit == Fit::kUnsure ? std::string(v.Name())
                                 : fmt::format("{} {} ms", v.Name(), args_.target_ms),
           v.fit == Fit::kUnsure ? v.what : fmt::format("{}; {}", v.what, DescribeFit(v.ms))});
      for (const std::string& why : v.disturbances)
        remarks.push_back(
            fmt::format("{} UNSURE, as the machine was not its own: {}", v.platform, why));
      if (!v.range.empty()) remarks.push_back(fmt::format("{}: {}", v.platform, v.range));
    }
    tree_.AddTexts({}, remarks);
    tree_.Say(
        "the 5 to 8 ms of the originals were the GPU's, for all characters; these are the "
        "processor's, which they moved work out of");
    if (std::ranges::any_of(verdicts_, [](const Verdict& v) { return !v.range.empty(); }))
      tree_.Say("consoles' verdicts: code " +
                DescribePlace(std::clamp(MeasuredCodePlace().mean, 0.0, 1.0)));
    if (!args_.trace.empty()) tree_.Say("trace " + args_.trace.path());
  }

  // One way to simulate the scene.
  struct Offer {
    std::string quality;
    std::vector<std::optional<double>>
        ms;  // as the verdicts take it, by platform; none: it cannot run there
    TipError error = {};

    double Px() const { return 1e-6 * error.p99_micropixels; }
  };

  std::optional<double> MsOf(const std::string& platform, Scenario& scenario) const {
    const LodSettings& lod = scenario.base.lod;
    if (platform == "host") return RunOnHost(scenario, lod).budget.wall_ms.p95;
    const ConsoleRequest request =
        RequestOf(platform == "ps3" ? Console::kPs3 : Console::kXbox360, lod);
    try {
      return ConsoleRun(scenario, request).TimeVerdictMs();
    } catch (const Error&) {
      return {};
    }
  }

  static constexpr const char* kAllChains = "all chains";

  // The scene as it is first, then what all of its chains, and better qualities, make of it.
  std::vector<Offer> MakeOffers() const {
    std::vector<Offer> offers = {{"as it is", {}}};
    for (const Verdict& v : verdicts_)
      offers[0].ms.push_back(v.refusal.empty() ? std::optional(v.ms) : std::nullopt);
    Scenario as_it_is = scenario_;
    as_it_is.base.lod = args_.lod;
    as_it_is.base.skip.lod = args_.skip.lod;
    std::vector<Scenario> ways = {as_it_is};
    const auto add = [&](std::string name, Scenario way) {
      Offer& offer = offers.emplace_back(Offer{std::move(name), {}});
      for (const std::string& platform : args_.platforms) offer.ms.push_back(MsOf(platform, way));
      ways.push_back(std::move(way));
    };
    if (args_.skip.lod && args_.lod.least_chains < 1.0f) {
      Scenario all_chains = as_it_is;
      all_chains.base.lod.least_chains = 1.0f;
      add(kAllChains, std::move(all_chains));
    }
    for (const Tier& tier : Tiers()) {
      if (tier.choice.solver != Solver::kModal || tier.choice.curl_follows) continue;
      std::vector<bool> has;
      Scenario way = AtTier(as_it_is, tier, has);
      if (!SameSimulation(as_it_is, way)) add(std::string(tier.name), std::move(way));
    }
    Progress progress("errors", args_.warm_up + frames_);
    const auto errors = MeasureTipErrors(
        scenario_, ways,
        {.warm_up = args_.warm_up, .frames = frames_, .progress = [&](uint32_t done, uint32_t) {
           progress.Show(done);
         }});
    for (size_t i = 0; i < offers.size(); ++i) offers[i].error = errors[i].back();
    return offers;
  }

  void AddQualities() {
    const std::vector<Offer> offers = MakeOffers();
    std::vector<Quantity> columns = {
        {"quality"}, {"off_mm", "mm RMS", 3, "off"}, {"p99_px", "px 99 %", 3, "off on screen"}};
    for (const std::string& platform : args_.platforms)
      columns.push_back({"ms." + platform, "ms", 2, platform});
    tree_.BlankLine();
    ReportTable& table = tree_.AddTable("qualities", columns);
    for (const Offer& offer : offers) {
      std::vector<Value> row = {offer.quality, 1e3 * offer.error.off_m, offer.Px()};
      for (const auto& ms : offer.ms) row.push_back(ms ? Value(*ms) : Value());
      table.Add(std::move(row));
    }
    tree_.Say(
        "off: tips from where the modal solver has them at its best, with four frames for one; on "
        "the screen 99 % of those in view");
    for (size_t i = 1; i < offers.size(); ++i)
      tree_.Say(WhatAMillisecondBuys(offers[0], offers[i]));
  }

  // By the platform on which it is dearest, or saves least; a host that was not its own does not count.
  std::string WhatAMillisecondBuys(const Offer& now, const Offer& offer) const {
    std::optional<double> change;
    for (size_t p = 0; p < offer.ms.size(); ++p) {
      if (!offer.ms[p])
        return fmt::format("{} cannot run on {}", offer.quality, args_.platforms[p]);
      if (now.ms[p] && verdicts_[p].fit != Fit::kUnsure)
        change = std::max(change.value_or(-HUGE_VAL), *offer.ms[p] - *now.ms[p]);
    }
    const double more = change.value_or(0.0);
    const double less = now.Px() - offer.Px();
    if (offer.error.off_m == now.error.off_m && offer.quality == kAllChains)
      return offer.quality + " are simulated here: so near, they do not thin";
    if (offer.error.off_m == now.error.off_m)
      return offer.quality + " is the same here: so far off, layers of it run in fast";
    if (more < 0.0)
      return fmt::format("{}: {:.2f} ms less, {:.3f} px more", offer.quality, -more, -less);
    return fmt::format("{}: {:.2f} ms more, {:.3f} px less: {:.3f} px a millisecond", offer.quality,
                       more, less, less / std::max(more, 1e-3));
  }

  void WriteTrace() {
    timeline_.process = fmt::format("pelt {}, modelled", scenario_.name);
    timeline_.metadata = {{"scene", scenario_.name}, {"times", "modelled, not measured"}};
    WriteOutput("trace", args_.trace, ChromeTrace(timeline_));
  }

  const BudgetArgs& args_;
  Scenario scenario_;
  std::shared_ptr<KnownPrices> known_[std::size(kAllConsoles)];
  uint32_t frames_ = 0;
  ReportTree tree_;
  std::vector<Verdict> verdicts_;
  Timeline timeline_;  // the slowest frame of every console
  std::string fault_;  // what makes the model's figures worthless
};

}  // namespace

ExitCode PrintBudget(const BudgetArgs& args) {
  if (args.validate) return PrintValidation({args.json});
  if (args.numbers) return PrintNumbers(args);
  if (args.qualities) RequireAccuracy();
  return BudgetPrinter(args).Print();
}

}  // namespace pelt
