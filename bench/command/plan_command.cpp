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

std::string PlanAsJson(const FurScene& scene) {
  const Plan& plan = scene.plan();
  JsonText json;
  json.BeginObject();
  json.Add("strands_per_chunk", kStrandsPerChunk);
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
  // The plan shown is the one that runs in a local store; main memory runs the same passes, but
  // sorts layers of any size whole.
  SceneOptions options = args.options;
  options.plan.must_fit = true;
  const RunningScenario running(scenario, options);
  const FurScene& scene = running.scene();
  if (args.json) {
    fmt::print("{}\n", PlanAsJson(scene));
    return 0;
  }
  fmt::print("{}", DescribePlan(scene.plan(), scene.shape()));
  if (args.chunk) fmt::print("\n{}", DescribeChunks());
  if (args.memory)
    fmt::print("\n{}and {} bytes outside the block: plan and tables of the scene\n",
               DescribeMemory(scene.layout()), scene.HeapBytes());
  return 0;
}

}  // namespace pelt
