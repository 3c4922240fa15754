#include <fmt/format.h>

#include "bench/command/commands.hpp"
#include "bench/consoles/console_budget.hpp"
#include "bench/report/memory_table.hpp"
#include "bench/report/report_tree.hpp"

namespace pelt {
namespace {

void AddPasses(const FurScene& scene, ReportTree& report) {
  const Plan& plan = scene.plan();
  ReportTable& passes = report.AddTable("passes", {InText("pass"),
                                                   {"domain"},
                                                   {"items"},
                                                   {"resident_bytes", "B", -1, "resident"},
                                                   {.key = "double_buffered", .heading = "twice"},
                                                   {"get_bytes", "B", -1, "get"},
                                                   {"put_bytes", "B", -1, "put"},
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
                pass.resident_bytes, pass.double_buffered, pass.get_bytes, pass.put_bytes, stages,
                streams});
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

ReportTree MakePlanReport(const FurScene& scene, const PlanArgs& args, const PlanOptions& options) {
  ReportTree report;
  report.Add(InJson("strands_per_chunk"), kStrandsPerChunk);
  report.Add(InJson("place"), options.code_bytes ? "PS3"
                              : options.must_fit ? "local store"
                                                 : "main memory");
  AddPasses(scene, report);
  report.Add({"stages"}, scene.plan().stages.size());
  report.Add({"barriers"}, scene.plan().passes.size());
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
  const RunningScenario running(scenario, options);
  MakePlanReport(running.scene(), args, options.plan).Print(args.json);
  return kDone;
}

}  // namespace pelt
