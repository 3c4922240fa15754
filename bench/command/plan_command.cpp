#include <fmt/format.h>

#include <algorithm>

#include "bench/command/commands.hpp"
#include "bench/report/json_text.hpp"
#include "bench/report/timeline.hpp"

namespace pelt {
namespace {

std::string DescribeChunks() {
  std::string out = fmt::format("chunk: {} strands and {} mesh vertices; blocks of one chunk:\n",
                                kStrandsPerChunk, kVerticesPerChunk);
  for (uint32_t s = 1; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    if (desc.domain == Domain::kChunk)
      out += fmt::format("  {:<18} {:>7} bytes\n", desc.name, desc.block_bytes);
  }
  return out;
}

// Which of the two plans it is.
std::string DescribePlace(const PlanOptions& options) {
  if (options.must_fit)
    return fmt::format(
        "For local stores with {} bytes for data. In main memory large layers sort whole: "
        "without --local-store.\n",
        options.local_store_data_bytes);
  return "For main memory, as pelt run runs it. In local stores large layers sort in pieces: "
         "--local-store.\n";
}

std::string PlanAsJson(const FurScene& scene, const PlanOptions& options) {
  const Plan& plan = scene.plan();
  JsonText json;
  json.BeginObject();
  json.Add("strands_per_chunk", kStrandsPerChunk);
  json.Add("place", options.must_fit ? "local store" : "main memory");
  json.Add("barriers", plan.passes.size());
  json.BeginArray("passes");
  for (const Pass& pass : plan.passes) {
    json.BeginObject();
    json.Add("domain", DomainName(pass.domain));
    json.Add("items", scene.shape().ItemCount(pass.domain));
    json.Add("resident_bytes", pass.resident_bytes);
    json.Add("get_bytes", pass.get_bytes);
    json.Add("put_bytes", pass.put_bytes);
    json.Add("double_buffered", pass.double_buffered);
    json.BeginArray("stages");
    for (uint32_t s = 0; s < pass.stage_count; ++s)
      json.Add("", plan.stages[pass.first_stage + s].kernel.name);
    json.EndArray();
    json.BeginArray("streams");
    for (const PassStream& stream : pass.streams) {
      json.BeginObject();
      json.Add("stream", DescribeStream(stream.stream).name);
      json.Add("bytes", stream.bytes);
      json.Add("get", stream.get);
      json.Add("put", stream.put);
      json.Add("transient", stream.transient);
      json.EndObject();
    }
    json.EndArray();
    json.EndObject();
  }
  json.EndArray();
  json.BeginObject("memory");
  for (const MemoryRange& range : scene.layout().ranges)
    if (range.bytes) json.Add(range.name, range.bytes);
  json.EndObject();
  json.Add("memory_bytes", scene.layout().total_bytes);
  json.Add("heap_bytes", scene.HeapBytes());
  json.EndObject();
  return json.text();
}

}  // namespace

int PrintPlan(const PlanArgs& args) {
  Scenario scenario = LoadScenario(args.request);
  SceneOptions options = args.options;
  options.plan.must_fit = args.local_store;
  const RunningScenario running(scenario, options);
  const FurScene& scene = running.scene();
  if (args.json) {
    fmt::print("{}\n", PlanAsJson(scene, options.plan));
    return 0;
  }
  fmt::print("{}{}", DescribePlan(scene.plan(), scene.shape()), DescribePlace(options.plan));
  if (args.chunk) fmt::print("\n{}", DescribeChunks());
  if (args.memory)
    fmt::print("\n{}and {} bytes outside the block: plan and tables of the scene\n",
               DescribeMemory(scene.layout()), scene.HeapBytes());
  return 0;
}

}  // namespace pelt
