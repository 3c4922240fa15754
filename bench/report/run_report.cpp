#include "bench/report/run_report.hpp"

#include <fmt/format.h>

#include <memory>

#include "bench/report/json_text.hpp"
#include "bench/verify/lockstep.hpp"
#include "core/error.hpp"
#include "jobs/pass_loop.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

void AddSpread(JsonText& json, std::string_view key, const Spread& spread) {
  json.BeginObject(key);
  json.Add("median", spread.median);
  json.Add("p95", spread.p95);
  json.Add("worst", spread.worst);
  json.EndObject();
}

std::string DescribeExecutor(const RunReport& report) {
  const RunOptions& o = report.options;
  if (HasWorkers(o.executor))
    return fmt::format("{}, {} workers asked for, {} observed", ExecutorName(o.executor),
                       report.workers, report.workers_observed);
  if (o.executor == ExecutorKind::kPermuted) return fmt::format("permuted, seed {}", o.order_seed);
  return std::string(ExecutorName(o.executor));
}

}  // namespace

void CheckRecords(ExecutorKind executor) {
  if (executor == ExecutorKind::kLocalStore)
    throw Error(
        "the local-store executor records no times: what it spends copying is not what a frame "
        "costs. Take serial, tbb or permuted");
}

RunReport RunFrames(Scenario& scenario, RunningScenario& running, const RunOptions& options) {
  VerifyCase as_case;
  as_case.executor = options.executor;
  as_case.workers = options.workers;
  as_case.order_seed = options.order_seed;
  const std::unique_ptr<Executor> executor = MakeExecutor(as_case);

  FurScene& scene = running.scene();
  RunReport report;
  report.scene = scenario.name;
  report.machine = DescribeMachine();
  report.options = options;
  report.frames = options.frames ? options.frames : scenario.default_frames;
  report.workers = WorkersOf(as_case);
  report.workers_observed = ObservedWorkers(*executor);
  report.strands = scene.layout().strand_count;
  report.characters = scene.shape().character_count;
  report.layers = scene.shape().layer_count;
  report.chunks = scene.shape().chunk_count;
  report.memory = scene.layout().ranges;
  report.memory_table = DescribeMemory(scene.layout());
  report.memory_bytes = scene.layout().total_bytes;
  report.state_bytes_per_strand = scene.layout().StateBytesPerStrand();

  BudgetRecorder recorder(scene, report.frames);
  Digest fold;
  for (uint32_t f = 0; f < options.warm_up; ++f) {
    running.Begin(f, options.skip, options.lod);
    executor->Run(scene.CurrentFrame());
  }
  for (uint32_t f = 0; f < report.frames; ++f) {
    if (options.progress) options.progress(f, report.frames);
    const bool observed = options.observe && f >= options.observe_from_frame;
    const FrameProfile* profile =
        recorder.Begin(observed ? options.observed_as : Recording::kBudget);
    FrameTicks ticks;
    const TimePoint start = Now();
    ticks.begin = ReadTicks();
    running.Begin(options.warm_up + f, options.skip, options.lod);
    ticks.prepared = ReadTicks();
    const uint64_t caller_ns = ElapsedNs(start);
    Frame frame = scene.CurrentFrame();
    frame.profile = profile;
    executor->Run(frame);
    ticks.end = ReadTicks();
    recorder.Finish(caller_ns, ElapsedNs(start));
    if (observed) options.observe({f, ticks, *profile, scene});
    if (options.after_frame) options.after_frame(f, scene);
    if (options.digest) fold.Add64(scene.DigestFrame());
  }
  report.budget = recorder.Summarise();
  if (options.digest) report.digest = fold.Value();
  report.live_strands = scene.LiveStrands();
  report.drawn_strands = scene.DrawnStrands();
  report.faults = FaultsOf(*executor);
  return report;
}

std::string DescribeRun(const RunReport& r) {
  std::string out =
      fmt::format("scene {}: {} strands in {} chunks, {} layers, {} characters; {} frames\n",
                  r.scene, r.strands, r.chunks, r.layers, r.characters, r.frames);
  out += fmt::format("on {} ({} cores), {}, {}, commit {}\n", r.machine.processor, r.machine.cores,
                     r.machine.compiler, r.machine.build_type, r.machine.commit);
  out += fmt::format("executor {}; kernels {}; {} plan\n\n", DescribeExecutor(r),
                     IsaName(r.options.scene.isa), r.options.scene.plan.fuse ? "fused" : "unfused");
  out += DescribeBudget(r.budget, r.workers) + '\n' + r.memory_table + '\n';
  out += fmt::format("last frame: {} strands live, {} drawn\n", r.live_strands, r.drawn_strands);
  for (const std::string& fault : r.faults) out += "FAULT " + fault + '\n';
  if (r.options.digest)
    out += fmt::format("digest {:016x}\n", r.digest);
  else
    out += "digest not taken\n";
  return out;
}

std::string RunAsJson(const RunReport& r) {
  JsonText json;
  json.BeginObject();
  json.Add("scene", r.scene);
  json.Add("strands", r.strands);
  json.Add("chunks", r.chunks);
  json.Add("layers", r.layers);
  json.Add("characters", r.characters);
  json.Add("frames", r.frames);
  AddMachine(r.machine, json);
  json.Add("executor", ExecutorName(r.options.executor));
  json.Add("workers", r.workers);
  json.Add("workers_observed", r.workers_observed);
  json.Add("isa", IsaName(r.options.scene.isa));
  json.Add("fused", r.options.scene.plan.fuse);
  json.BeginArray("stages");
  for (const StageBudget& s : r.budget.stages) {
    if (s.ran + s.skipped == 0.0) continue;
    json.BeginObject();
    json.Add("stage", s.name);
    AddSpread(json, "core_ms", s.core_ms);
    json.Add("ns_per_strand", s.ns_per_strand);
    json.Add("bytes_moved", s.bytes);
    json.Add("items_run", s.ran);
    json.Add("items_skipped", s.skipped);
    json.Add("share_of_5ms", s.core_ms.median / (5.0 * r.workers));
    json.Add("share_of_8ms", s.core_ms.median / (8.0 * r.workers));
    json.EndObject();
  }
  json.EndArray();
  json.BeginArray("passes");
  for (const PassBudget& p : r.budget.passes) {
    json.BeginObject();
    json.Add("stages", p.stages);
    AddSpread(json, "wall_ms", p.wall_ms);
    json.EndObject();
  }
  json.EndArray();
  AddSpread(json, "caller_ms", r.budget.caller_ms);
  AddSpread(json, "frame_ms", r.budget.wall_ms);
  json.Add("ns_per_strand", r.budget.ns_per_strand);
  json.BeginObject("memory");
  for (const MemoryRange& range : r.memory)
    if (range.bytes) json.Add(range.name, range.bytes);
  json.EndObject();
  json.Add("memory_bytes", r.memory_bytes);
  json.Add("state_bytes_per_strand", r.state_bytes_per_strand);
  json.Add("live_strands", r.live_strands);
  json.Add("drawn_strands", r.drawn_strands);
  json.BeginArray("faults");
  for (const std::string& fault : r.faults) json.Add("", fault);
  json.EndArray();
  if (r.options.digest) json.AddDigest("digest", r.digest);
  json.EndObject();
  return json.text();
}

}  // namespace pelt
