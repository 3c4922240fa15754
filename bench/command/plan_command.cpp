#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <queue>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "bench/command/commands.hpp"
#include "bench/consoles/console_budget.hpp"
#include "bench/report/budget.hpp"
#include "bench/report/report_tree.hpp"
#include "bench/report/run_comparison.hpp"
#include "core/error.hpp"
#include "jobs/frame.hpp"
#include "jobs/frame_recording.hpp"
#include "jobs/frame_scheduler.hpp"

namespace pelt {
namespace {

// How far a frame spreads: what its graph (jobs/frame_graph.hpp) lets so many workers do at once,
// by a simulation that is the same on every machine.
//
// An item costs what its stages cost on it. Without times a stage costs the bytes that it moves; with
// those of a run it costs what it took there, by the bytes of each item. Nothing else costs: not the
// taking of an item, not a cache that other cores write to. What is left is what no number of cores
// helps: that items are few, uneven, and wait for each other.

// By stage name: ms on one core, over all items of a frame.
using StageTimes = std::map<std::string, double, std::less<>>;

struct WorkerForecast {
  uint32_t workers;
  double best, ours;  // times one worker's speed: the bound of any executor, and Pelt's
};

class FrameForecast {
 public:
  // Of the stages that `profile` says ran; of those without a time in `times` by bytes, unless it
  // is empty: then of all.
  FrameForecast(const Frame& frame, const StageTimes& times);

  double TotalCost() const { return total_; }  // ms, or bytes
  // What the longest chain of items that wait for each other costs.
  double CriticalPath() const;
  WorkerForecast On(uint32_t workers) const;

 private:
  const Plan& plan_;
  std::vector<double> costs_;  // of items, as FrameGraph::item_node
  double total_ = 0.0;
};

using Scheduler = FrameScheduler<std::atomic>;

// Workers take items as they do in a frame (it is the same scheduler), but time is counted.
class SimulatedFrame {
 public:
  SimulatedFrame(const FrameGraph& graph, std::span<const double> costs, uint32_t workers)
      : graph_(graph),
        costs_(costs),
        scheduler_(workers, uint32_t(graph.words.size()), uint32_t(graph.nodes.size())) {
    for (uint32_t w = 0; w < workers; ++w) idle_.push_back(w);
  }

  // Returns when it ends.
  double Run() {
    double now = 0.0;
    if (!scheduler_.TakeForFrame()) return now;
    scheduler_.Start(graph_, [] {});
    for (StartItems(now); !running_.empty(); StartItems(now)) {
      const auto [end, worker, node] = running_.top();
      running_.pop();
      now = end;
      scheduler_.Finish(graph_, node, [] {});
      idle_.insert(std::ranges::lower_bound(idle_, worker), worker);
    }
    return now;
  }

 private:
  void StartItems(double now) {
    std::erase_if(idle_, [&](uint32_t worker) {
      Scheduler::Claim claim;
      if (scheduler_.TryClaim(worker, claim) != PullResult::kRan) return false;
      const uint32_t at = graph_.AtItem(claim.word, claim.bit);
      running_.emplace(now + costs_[at], worker, graph_.item_node[at]);
      return true;
    });
  }

  const FrameGraph& graph_;
  std::span<const double> costs_;
  Scheduler scheduler_;
  std::vector<uint32_t> idle_;  // by number
  // When an item ends, who runs it, what it counts for: the earliest first.
  using Running = std::tuple<double, uint32_t, uint32_t>;
  std::priority_queue<Running, std::vector<Running>, std::greater<>> running_;
};

// The cost of each stage on each of its items, as the profile says it ran.
std::vector<double> StageBytes(const Frame& frame, uint32_t pass, uint32_t stage) {
  const Plan& plan = *frame.plan;
  const SceneShape& shape = *frame.memory->shape;
  std::vector<double> bytes(shape.ItemCount(plan.passes[pass].domain), 0.0);
  for (uint32_t i = 0; i < bytes.size(); ++i) {
    if (!frame.profile->Stage(plan, pass, i, stage - plan.passes[pass].first_stage).Ran()) continue;
    const PortTraffic traffic = StageTraffic(plan.stages[stage], shape, i);
    bytes[i] = double(traffic.in_bytes + traffic.out_bytes);
  }
  return bytes;
}

FrameForecast::FrameForecast(const Frame& frame, const StageTimes& times) : plan_(*frame.plan) {
  costs_.resize(plan_.graph.item_node.size(), 0.0);
  for (uint32_t p = 0; p < plan_.passes.size(); ++p)
    for (uint32_t s = 0; s < plan_.passes[p].stage_count; ++s) {
      const uint32_t stage = plan_.passes[p].first_stage + s;
      const std::vector<double> bytes = StageBytes(frame, p, stage);
      double sum = 0.0;
      for (const double b : bytes) sum += b;
      const auto time = times.find(plan_.stages[stage].kernel.name);
      const double scale = times.empty()         ? 1.0
                           : time == times.end() ? 0.0
                                                 : time->second / std::max(sum, 1.0);
      for (size_t i = 0; i < bytes.size(); ++i)
        costs_[plan_.graph.pass_first[p] + i] += scale * bytes[i];
    }
  for (const double cost : costs_) total_ += cost;
}

double FrameForecast::CriticalPath() const {
  const FrameGraph& graph = plan_.graph;
  std::vector<double> fires(graph.nodes.size(), 0.0);  // when: with workers without end
  std::vector<uint32_t> left, ready = {0};
  for (const FrameGraph::Node& node : graph.nodes) left.push_back(node.waits_for);
  const auto count = [&](uint32_t node, double when) {
    fires[node] = std::max(fires[node], when);
    if (--left[node] == 0) ready.push_back(node);
  };
  while (!ready.empty()) {
    const uint32_t node = ready.back();
    ready.pop_back();
    graph.ForEachOpened(node, [&](uint32_t, uint32_t, uint32_t at) {
      count(graph.item_node[at], fires[node] + costs_[at]);
    });
    for (uint32_t n = graph.nodes[node].first_next; n < graph.nodes[node + 1].first_next; ++n)
      count(graph.next[n], fires[node]);
  }
  return fires[graph.LastNode()];
}

WorkerForecast FrameForecast::On(uint32_t workers) const {
  const double best = std::max(total_ / workers, CriticalPath());
  const double ours = SimulatedFrame(plan_.graph, costs_, workers).Run();
  return {workers, total_ / best, total_ / ours};
}

// What the stages of the plan took in a run. Throws Error where it is of another plan; `from` names it.
StageTimes StageTimesOf(const MeasuredRun& run, std::string_view from, const Plan& plan) {
  StageTimes times;
  for (auto [stage, ms] : run.stages_ms) times[stage] = SpreadOf(ms).median;
  for (const Stage& stage : plan.stages)
    if (!times.contains(stage.kernel.name))
      throw Error(fmt::format("{}: has no stage '{}': it is of another scene or plan", from,
                              stage.kernel.name));
  return times;
}

// "2 by patch_list, 1 layer": of pass 2 what its list names, of pass 1 all in its layer.
std::vector<std::string> DescribeWaits(const Plan& plan, const Pass& pass) {
  std::vector<std::string> texts;
  for (const Wait& wait : pass.waits)
    texts.push_back(wait.list != Stream::kNone
                        ? fmt::format("{} by {}", wait.pass, (*plan.table)[wait.list].name)
                    : wait.within == pass.domain && pass.domain == plan.passes[wait.pass].domain
                        ? fmt::format("{} itself", wait.pass)
                        : fmt::format("{} {}", wait.pass, DomainName(wait.within)));
  return texts;
}

void AddPasses(const FurScene& scene, ReportTree& report) {
  const Plan& plan = scene.plan();
  ReportTable& passes = report.AddTable("passes", {InText("pass"),
                                                   {"domain"},
                                                   {"items"},
                                                   {"resident_bytes", "B", -1, "resident"},
                                                   {.key = "double_buffered", .heading = "twice"},
                                                   {"get_bytes", "B", -1, "get"},
                                                   {"put_bytes", "B", -1, "put"},
                                                   {"waits_for"},
                                                   {"stages"},
                                                   InJson("streams")});
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    const Pass& pass = plan.passes[p];
    std::vector<std::string> stages;
    for (uint32_t s = 0; s < pass.stage_count; ++s)
      stages.emplace_back(plan.stages[pass.first_stage + s].kernel.name);
    ReportTable streams{{}, {{"stream"}, {"bytes"}, {"get"}, {"put"}, {"transient"}}};
    for (const PassStream& stream : pass.streams)
      streams.Add({DescribeStream(stream.stream).name, stream.bytes, stream.get, stream.put,
                   stream.transient});
    passes.Add({p, DomainName(pass.domain), scene.shape().ItemCount(pass.domain),
                pass.resident_bytes, pass.double_buffered, pass.get_bytes, pass.put_bytes,
                DescribeWaits(plan, pass), stages, streams});
  }
}

// Which of the plans it is.
std::string DescribePlace(const PlanOptions& options) {
  if (options.code_bytes)
    return fmt::format(
        "For a PS3's local stores: {} bytes for the data of a pass, its code and parameters.",
        options.code_and_data_bytes);
  if (options.must_fit)
    return fmt::format(
        "For local stores with {} bytes for data. In main memory passes are longer, and large "
        "layers "
        "sort whole: without --local-store.",
        options.local_store_data_bytes);
  return fmt::format(
      "For main memory, as pelt run runs it: stages share a pass while it takes no more than {} "
      "bytes of "
      "a core's cache. In local stores passes are shorter, and large layers sort in pieces: "
      "--local-store.",
      options.cache_bytes);
}

void AddChunks(ReportTree& report) {
  report.Say(fmt::format("chunk: {} strands and {} mesh vertices; blocks of one chunk:",
                         kStrandsPerChunk, kVerticesPerChunk));
  ReportTable& blocks = report.AddTable("chunk_blocks", {{"stream"}, {"bytes"}});
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    if (IsInLayer(desc.domain)) blocks.Add({desc.name, desc.block_bytes});
  }
}

constexpr uint32_t kFramesBefore =
    8;  // until who moves and who sleeps is what it is in most frames

void AddForecast(RunningScenario& running, const PlanArgs& args, ReportTree& report) {
  const Plan& plan = running.scene().plan();
  FrameRecording recording(plan, running.scene().shape());
  SerialExecutor serial;
  Frame frame;
  for (uint32_t f = 0; f < kFramesBefore; ++f) {
    running.Begin(f);
    frame = running.scene().CurrentFrame();
    frame.profile = recording.profile();
    serial.Run(frame);
  }
  StageTimes times;
  if (!args.times.empty())
    times = StageTimesOf(ReadRunFile(args.times), fmt::format("run '{}'", args.times), plan);
  const FrameForecast forecast(frame, times);
  const char* unit = times.empty() ? "MB moved" : "ms";
  const double scale = times.empty() ? 1e-6 : 1.0;
  report.BlankLine();
  report.Add({"cost", unit, 3, "one worker"}, forecast.TotalCost() * scale);
  report.Add({"critical_path", unit, 3, "longest chain of items"}, forecast.CriticalPath() * scale);
  report.EndLine();
  ReportTable& table = report.AddTable("spread", {{"workers"},
                                                  {"best", "times", 2, "any executor"},
                                                  {"ours", "times", 2, "Pelt"},
                                                  {"of_linear", "%", 0, "of linear", 100.0}});
  std::set<uint32_t> counts = {args.workers};
  for (const uint32_t w : {2u, 4u, 8u, 12u, 16u, 32u, 64u})
    if (w < args.workers) counts.insert(w);
  for (const uint32_t workers : counts) {
    const WorkerForecast on = forecast.On(workers);
    table.Add({workers, on.best, on.ours, on.ours / workers});
  }
  report.Say(
      "Simulated: items as they wait for each other, at no cost for handing them out or for memory "
      "that cores share. Any executor: the longer of the sum over the workers and the longest "
      "chain.");
}

ReportTree MakePlanReport(const FurScene& scene, const PlanArgs& args, const PlanOptions& options) {
  ReportTree report;
  report.Add(InJson("strands_per_chunk"), kStrandsPerChunk);
  report.Add(InJson("place"), options.code_bytes ? "PS3"
                              : options.must_fit ? "local store"
                                                 : "main memory");
  AddPasses(scene, report);
  report.Add({"stages"}, scene.plan().stages.size());
  report.Say(
      "Bytes are for one item of the layer kind that needs most; resident: with room for two items "
      "where they fit (twice).");
  report.Say(DescribePlace(options));
  if (args.chunk) AddChunks(report);
  if (args.memory || args.json) AddMemory(scene.layout(), report);
  if (args.memory || args.json)
    report.Add({"heap_bytes", "B: plan and tables of the scene", -1, "outside the block"},
               scene.HeapBytes());
  return report;
}

}  // namespace

ExitCode PrintPlan(const PlanArgs& args) {
  Scenario scenario = LoadScenario(args.request);
  SceneOptions options = args.options;
  if (args.ps3) {
    const ConsoleRun run(scenario, {.console = Console::kPs3, .scene = options});
    MakePlanReport(run.scene(), args, run.plan_options()).Print(args.json);
    return kDone;
  }
  options.plan.must_fit = args.local_store;
  RunningScenario running(scenario, options);
  ReportTree report = MakePlanReport(running.scene(), args, options.plan);
  if (args.workers) AddForecast(running, args, report);
  report.Print(args.json);
  return kDone;
}

}  // namespace pelt
