// `pelt timing --kernel`: our own kernels on a console's core, from their source (kernel_cost.hpp).
// Each is recorded on the item of the scene's second frame that has most to do, every skip off.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "bench/command/commands.hpp"
#include "bench/command/usage_error.hpp"
#include "bench/consoles/kernel_rows_report.hpp"
#include "bench/report/json_text.hpp"
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
  std::string names;
  for (uint32_t s = 0; s < plan.stages.size(); ++s) {
    const std::string_view name = plan.stages[s].kernel.name;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
    if (name.starts_with(args.kernel)) out.push_back({s, name});
  }
  if (out.empty() || args.kernel.empty())
    throw UsageError(fmt::format("--kernel '{}': no stage of scene {} begins so; there are {}",
                                 args.kernel, args.scene, names));
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

// Cycles a strand: an iteration is four.
double PerStrand(double cycles_per_iteration) { return cycles_per_iteration / 4.0; }

// Where measured kernels lay in their range.
double ExpectedCycles(const KernelCost& c) {
  const double least = c.scheduled.cycles_per_iteration, most = c.as_written.cycles_per_iteration;
  return least + MeasuredCodePlace().mean * (most - least);
}

void PrintTable(const std::vector<TimedStage>& stages, const PricedCore& core) {
  const bool shares = core.caches.has_value();
  fmt::print(
      "{:<22} {:>9} {:>9} {:>9} {:>9} {:>9}{} {:>8} {:<14} {:>5} {:>6} {:>9} {:>7} {:>7} {:>6}\n",
      "cycles a strand", "operat.", "instruct.", "scheduled", "expected", "written",
      shares ? fmt::format(" {:>9} {:>7} {:>9}", "two thr.", "waits", "unfetched") : "", "fixed",
      "binds", "busy", "dual", "registers", "spills", "code B", "iterations");
  for (const TimedStage& timed : stages) {
    const KernelCost& c = timed.cost;
    if (c.operations == 0) {
      fmt::print("{:<22} {}\n", timed.name,
                 timed.iterations ? "scalar code that is not recorded" : "does not run in this scene");
      continue;
    }
    fmt::print(
        "{:<22} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f}{} {:>8.0f} {:<14} {:>4.0f}% {:>5.0f}% "
        "{:>9} {:>7} {:>7} {:>6}\n",
        timed.name, PerStrand(double(c.operations) / c.iterations), PerStrand(c.instructions_per_iteration),
        PerStrand(c.scheduled.cycles_per_iteration), PerStrand(ExpectedCycles(c)),
        PerStrand(c.as_written.cycles_per_iteration),
        shares ? fmt::format(
                     " {:>9.1f} {:>7.1f} {:>9.1f}", PerStrand(c.scheduled.shared_cycles_per_iteration),
                     PerStrand(c.wait_cycles_per_iteration), PerStrand(c.unfetched_wait_cycles_per_iteration))
               : "",
        c.scheduled.fixed_cycles, c.binding, 100.0 * c.busiest_unit_share,
        100.0 * c.dual_issue_rate, fmt::format("{}/{}", c.most_live, c.register_limit),
        c.spill_stores + c.spill_loads, c.code_bytes, c.window_iterations);
  }
  fmt::print("\nexpected: {}\n", DescribePlace(MeasuredCodePlace().mean));
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

void PrintWindow(const TimedStage& timed, const ScheduledWindow& window, uint32_t slots,
                 const InstructionSet& set) {
  fmt::print(
      "\n{}: {} iterations scheduled together, first {} of {} instructions\n{:>8}  {:<11} {:<34} {}\n",
      timed.name, timed.cost.window_iterations, std::min<size_t>(slots, window.chart.first_pass.size()),
      window.chart.first_pass.size(), "cycle", "pipe", "instruction", "cycles waited for");
  for (const IssueSlot& slot : window.chart.first_pass) {
    if (slots-- == 0) break;
    const bool paired = slot.unpaired == Unpaired::kPaired;
    std::string waited;
    for (uint32_t s = 0; s < slot.stall_count; ++s)
      waited += fmt::format("{}{} {}", s ? ", " : "", slot.stalls[s].cycles,
                            StallCauseName(slot.stalls[s].cause));
    std::string line = fmt::format(
        "{:>8}  {:<11} {:<34} {}", paired ? "+" : fmt::format("{}", slot.cycle),
        window.chart.pipes[slot.pipe], InstructionText(window, slot.instruction, set), waited);
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print("{}\n", line);
  }
}

std::string AsJson(const std::vector<TimedStage>& stages, const PricedCore& core,
                   const TimingArgs& args) {
  JsonText json;
  json.BeginObject();
  json.Add("scene", args.scene);
  json.Add("core", CoreKindName(core.kind));
  json.Add("clock_hz", core.clock_hz);
  json.Add("host_operations", args.host_operations);
  json.Add("code_order", MeasuredCodePlace().mean);
  json.Add("code_order_least", MeasuredCodePlace().least);
  json.Add("code_order_most", MeasuredCodePlace().most);
  json.BeginArray("kernels");
  for (const TimedStage& timed : stages) {
    const KernelCost& c = timed.cost;
    json.BeginObject();
    json.Add("kernel", timed.name);
    json.Add("item", timed.item);
    json.Add("iterations", timed.iterations);
    json.Add("operations", c.operations);
    json.Add("instructions_per_iteration", c.instructions_per_iteration);
    json.Add("as_written_cycles_per_iteration", c.as_written.cycles_per_iteration);
    json.Add("expected_cycles_per_iteration", ExpectedCycles(c));
    json.Add("scheduled_cycles_per_iteration", c.scheduled.cycles_per_iteration);
    json.Add("shared_cycles_per_iteration", c.scheduled.shared_cycles_per_iteration);
    json.Add("as_written_cycles_per_strand", PerStrand(c.as_written.cycles_per_iteration));
    json.Add("scheduled_cycles_per_strand", PerStrand(c.scheduled.cycles_per_iteration));
    json.Add("fixed_cycles", c.scheduled.fixed_cycles);
    if (core.caches) {
      json.Add("lines_per_iteration", c.lines_per_iteration);
      json.Add("wait_cycles_per_iteration", c.wait_cycles_per_iteration);
      json.Add("unfetched_wait_cycles_per_iteration", c.unfetched_wait_cycles_per_iteration);
    }
    json.Add("divides_per_iteration", c.divides_per_iteration);
    json.Add("roots_per_iteration", c.roots_per_iteration);
    json.Add("binds", c.binding);
    json.Add("busiest_unit_share", c.busiest_unit_share);
    json.Add("dual_issue_rate", c.dual_issue_rate);
    json.Add("registers_live", c.most_live);
    json.Add("registers", c.register_limit);
    json.Add("spill_stores", c.spill_stores);
    json.Add("spill_loads", c.spill_loads);
    json.Add("code_bytes", c.code_bytes);
    json.Add("iterations_scheduled_together", c.window_iterations);
    json.EndObject();
  }
  json.EndArray();
  json.EndObject();
  return json.text();
}

}  // namespace

int PrintKernelTiming(const TimingArgs& args) {
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
  if (args.json) {
    fmt::print("{}\n", AsJson(stages, core, args));
    return 0;
  }
  fmt::print("scene {}, {} at {:.3f} GHz{}\n\n", args.scene, CoreKindName(core.kind),
             double(core.clock_hz) * 1e-9,
             args.host_operations ? ", the host's operations one for one" : "");
  PrintTable(stages, core);
  for (const TimedStage& timed : stages)
    if (args.chart_slots && timed.cost.operations)
      PrintWindow(timed, ScheduleWindow(timed.trace, timed.iterations, core, rules).OrThrow(),
                  args.chart_slots,
                  core.kind == CoreKind::kSpu ? SpuInstructionSet() : PpeInstructionSet());
  return 0;
}

}  // namespace pelt
