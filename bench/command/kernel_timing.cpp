// `pelt timing --kernel`: our own kernels on a console's core, from their source (kernel_cost.hpp).
// Each is recorded on the item of the scene's second frame that has most to do, every skip off.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <span>

#include "bench/command/commands.hpp"
#include "bench/command/usage_error.hpp"
#include "bench/consoles/console_report.hpp"
#include "bench/report/report_tree.hpp"
#include "core/groom/nearest_word.hpp"
#include "platform_sim/pipeline/instruction_set.hpp"
#include "platform_sim/pricing/record_stage.hpp"
#include "platform_sim/pricing/stage_costs.hpp"

namespace pelt {
namespace {

constexpr SkipSettings kNoSkips{false, false, false, false, false, false};

// A stage whose name the argument begins, with the item that has the most iterations.
struct TimedStage {
  uint32_t stage;
  std::string_view name;
  uint32_t item = 0, iterations = 0;
  Trace trace = {};
  KernelCost cost = {};
};

std::vector<TimedStage> FindStages(const Plan& plan, const TimingArgs& args) {
  std::vector<TimedStage> out;
  std::vector<std::string_view> names;
  for (uint32_t s = 0; s < plan.stages.size(); ++s) {
    const std::string_view name = plan.stages[s].kernel.name;
    names.push_back(name);
    if (name.starts_with(args.kernel)) out.push_back({s, name});
  }
  if (out.empty() || args.kernel.empty())
    throw UsageError(fmt::format("--kernel '{}': no stage of scene {} begins so; there are {}{}",
                                 args.kernel, args.scene, fmt::join(names, ", "),
                                 DidYouMean(args.kernel, names)));
  return out;
}

void RecordStages(const Frame& frame, std::vector<TimedStage>& stages) {
  RecordFrame(frame, [&](uint32_t, uint32_t stage, uint32_t item) {
    const auto timed = std::ranges::find(stages, stage, &TimedStage::stage);
    Recorder recorder(timed == stages.end() ? Recorder::Keep::kCounts
                                            : Recorder::Keep::kOperations);
    RecordStage(frame, stage, item, RecordingKernels(), recorder).OrThrow();
    if (timed == stages.end()) return true;
    const uint32_t iterations = CountIterations(frame, stage, item);
    if (iterations <= timed->iterations) return true;
    timed->item = item;
    timed->iterations = iterations;
    timed->trace = recorder.trace();
    return true;
  });
}

// Cycles per strand: one iteration is four strands.
double PerStrand(double cycles_per_iteration) { return cycles_per_iteration / 4.0; }

// Where a compiler's kernels lay in their range.
double ExpectedCycles(const KernelCost& c) {
  const double least = c.scheduled.cycles_per_iteration, most = c.as_written.cycles_per_iteration;
  return least + MeasuredCodePlace().mean * (most - least);
}

// In text, cycles and operations per iteration are given per strand.
void AddCosts(const std::vector<TimedStage>& stages, const PricedCore& core, ReportTree& tree) {
  const Show if_cached = core.caches ? Show::kBoth : Show::kJson;
  const double strand = PerStrand(1.0);
  ReportTable& costs = tree.AddTable(
      "kernels", {{"kernel", "", -1, "cycles per strand"},
                  InJson("item"),
                  InJson("iterations"),
                  InJson("operations"),
                  InText("operat.", "", 1),
                  {"instructions_per_iteration", "", 1, "instr.", strand},
                  {"scheduled_cycles_per_iteration", "", 1, "scheduled", strand},
                  {"expected_cycles_per_iteration", "", 1, "expected", strand},
                  {"as_written_cycles_per_iteration", "", 1, "written", strand},
                  {"shared_cycles_per_iteration", "", 1, "two thr.", strand, if_cached},
                  {"wait_cycles_per_iteration", "", 1, "waits", strand, if_cached},
                  {"unfetched_wait_cycles_per_iteration", "", 1, "unfetched", strand, if_cached},
                  InJson("lines_per_iteration"),
                  InJson("as_written_cycles_per_strand"),
                  InJson("scheduled_cycles_per_strand"),
                  InJson("fixed_cycles"),
                  InJson("divides_per_iteration"),
                  InJson("roots_per_iteration"),
                  InJson("binds"),
                  InJson("busiest_unit_share"),
                  InJson("dual_issue_rate"),
                  InJson("registers_live"),
                  InJson("registers"),
                  InJson("spill_stores"),
                  InJson("spill_loads"),
                  InJson("code_bytes"),
                  InJson("iterations_scheduled_together")});
  ReportTable& rest =
      tree.AddTable({}, {InText("kernel"), InText("fixed cycles", "", 0), InText("binds"),
                         InText("busy", "%", 0), InText("dual", "%", 0), InText("registers"),
                         InText("spills"), InText("code", "B"), InText("iterations", "together")});
  std::vector<std::string> not_priced;
  for (const TimedStage& timed : stages) {
    const KernelCost& c = timed.cost;
    const auto if_caches = [&](double value) { return core.caches ? Value(value) : Value{}; };
    costs.Add({timed.name,
               timed.item,
               timed.iterations,
               c.operations,
               PerStrand(double(c.operations) / std::max(1u, c.iterations)),
               c.instructions_per_iteration,
               c.scheduled.cycles_per_iteration,
               ExpectedCycles(c),
               c.as_written.cycles_per_iteration,
               c.scheduled.shared_cycles_per_iteration,
               if_caches(c.wait_cycles_per_iteration),
               if_caches(c.unfetched_wait_cycles_per_iteration),
               if_caches(c.lines_per_iteration),
               PerStrand(c.as_written.cycles_per_iteration),
               PerStrand(c.scheduled.cycles_per_iteration),
               c.scheduled.fixed_cycles,
               c.divides_per_iteration,
               c.roots_per_iteration,
               c.binding,
               c.busiest_unit_share,
               c.dual_issue_rate,
               c.most_live,
               c.register_limit,
               c.spill_stores,
               c.spill_loads,
               c.code_bytes,
               c.window_iterations},
              c.operations ? Show::kBoth : Show::kJson);
    if (c.operations)
      rest.Add({timed.name, c.scheduled.fixed_cycles, c.binding, 100.0 * c.busiest_unit_share,
                100.0 * c.dual_issue_rate, fmt::format("{}/{}", c.most_live, c.register_limit),
                c.spill_stores + c.spill_loads, c.code_bytes, c.window_iterations});
    else
      not_priced.push_back(fmt::format(
          "{}: {}", timed.name,
          timed.iterations ? "scalar code that is not recorded" : "does not run in this scene"));
  }
  tree.BlankLine();
  tree.AddTexts({}, not_priced);
}

// "fma $5,$4,$6,$5"; a place in memory is the recorder's, in its own space.
std::string InstructionText(const ScheduledWindow& window, uint32_t index,
                            const InstructionSet& set) {
  const Instruction& it = window.code.program[index];
  std::string out(window.name[index]);
  const char* before = " ";
  for (const auto& registers : {std::vector<uint32_t>(it.writes.begin(), it.writes.end()),
                                std::vector<uint32_t>(it.reads.begin(), it.reads.end())})
    for (const uint32_t reg : registers) {
      out += before;
      out += RegisterName(set, reg);
      before = ",";
    }
  if (it.address.size_bytes)
    out += fmt::format("{}[{:#x}]", before, uint32_t(it.address.displacement_bytes));
  return out;
}

void AddWindow(const TimedStage& timed, const ScheduledWindow& window, uint32_t slots,
               const InstructionSet& set, ReportTree& tree) {
  slots = uint32_t(std::min<size_t>(slots, window.chart.first_pass.size()));
  tree.BlankLine();
  tree.Say(fmt::format("{}: {} iterations scheduled together, first {} of {} instructions",
                       timed.name, timed.cost.window_iterations, slots,
                       window.chart.first_pass.size()));
  ReportTable& table = tree.AddTable({}, {InText(" "), InText("cycle"), InText("pipe"),
                                          InText("instruction"), InText("cycles waited for")});
  for (const IssueSlot& slot : std::span(window.chart.first_pass).first(slots)) {
    std::string waited;
    for (uint32_t s = 0; s < slot.stall_count; ++s)
      waited += fmt::format("{}{} {}", s ? ", " : "", slot.stalls[s].cycles,
                            StallCauseName(slot.stalls[s].cause));
    table.Add({slot.unpaired == Unpaired::kPaired ? "+" : "", slot.cycle,
               window.chart.pipes[slot.pipe], InstructionText(window, slot.instruction, set),
               waited});
  }
}

}  // namespace

ExitCode PrintKernelTiming(const TimingArgs& args) {
  const PlatformParameters platforms;
  const PricedCore core = MakePricedCore(*ParseCoreKind(args.core), platforms);
  PriceRules rules;
  rules.lowering.host_operations = args.host_operations;
  Scenario scenario = LoadScenario(args.scene);
  SceneOptions options;
  options.plan.must_fit = core.kind == CoreKind::kSpu;
  RunningScenario running(scenario, options);
  std::vector<TimedStage> stages = FindStages(running.scene().plan(), args);
  running.Begin(0, kNoSkips, scenario.base.lod);
  SerialExecutor().Run(running.scene().CurrentFrame());
  running.Begin(1, kNoSkips, scenario.base.lod);
  RecordStages(running.scene().CurrentFrame(), stages);
  for (TimedStage& timed : stages)
    timed.cost = PriceTrace(timed.trace, timed.iterations, core, rules).OrThrow();
  ReportTree tree;
  tree.Say(fmt::format("scene {}, {} at {:.3f} GHz{}", args.scene, CoreKindName(core.kind),
                       double(core.clock_hz) * 1e-9,
                       args.host_operations ? ", the host's operations one for one" : ""));
  tree.Add(InJson("scene"), args.scene).Add(InJson("core"), CoreKindName(core.kind));
  tree.Add(InJson("clock_hz"), core.clock_hz);
  tree.Add(InJson("host_operations"), args.host_operations);
  tree.Add(InJson("code_order"), MeasuredCodePlace().mean);
  tree.Add(InJson("code_order_least"), MeasuredCodePlace().least);
  tree.Add(InJson("code_order_most"), MeasuredCodePlace().most);
  AddCosts(stages, core, tree);
  tree.Say("expected: " + DescribePlace(MeasuredCodePlace().mean));
  for (const TimedStage& timed : stages)
    if (args.chart_slots && timed.cost.operations)
      AddWindow(timed, ScheduleWindow(timed.trace, timed.iterations, core, rules).OrThrow(),
                args.chart_slots,
                core.kind == CoreKind::kSpu ? SpuInstructionSet() : PpeInstructionSet(), tree);
  tree.Print(args.json);
  return kDone;
}

}  // namespace pelt
