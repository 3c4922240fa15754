#include <fmt/format.h>

#include <set>

#include "bench/command/commands.hpp"
#include "bench/consoles/console_budget.hpp"
#include "bench/report/memory_table.hpp"
#include "bench/report/report_tree.hpp"
#include "bench/report/worker_forecast.hpp"
#include "jobs/frame_recording.hpp"

namespace pelt {
namespace {

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
