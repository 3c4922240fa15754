#include "bench/report/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <numeric>

#include "bench/verify/lockstep.hpp"
#include "core/error.hpp"
#include "core/groom/layer_params.hpp"
#include "core/modal/modal_quality.hpp"
#include "jobs/pass_loop.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

Value ShareOf(const LayerQuality& layer, ModalQuality quality) {
  const uint32_t all = std::reduce(layer.frames.begin(), layer.frames.end());
  return all ? Value(double(layer.frames[size_t(quality)]) / all) : Value();
}

// `named`: how many layers in text; which and whose in JSON.
void AddRow(const LayerQuality& layer, std::vector<Value> named, Show show, ReportTable& table) {
  const bool modal = !layer.asked.empty();
  std::vector<Value> values = std::move(named);
  values.emplace_back(layer.solver);
  values.push_back(modal ? Value(layer.asked) : Value());
  for (const auto quality : {ModalQuality::kFast, ModalQuality::kFine, ModalQuality::kBest})
    values.push_back(ShareOf(layer, quality));
  values.push_back(modal ? Value(1.0 / double(1u << layer.chain_level)) : Value());
  values.push_back(modal ? Value(double(layer.error_px)) : Value());
  table.Add(std::move(values), show);
}

std::string_view WordOf(auto LayerParams::*param, const LayerParams& params) {
  return LayerParamEntryOf(param).words[size_t(params.*param)];
}

}  // namespace

std::vector<LayerQuality> QualitiesOf(const FurScene& scene, std::span<const Groom* const> grooms) {
  std::vector<LayerQuality> layers;
  for (uint32_t c = 0; c < grooms.size(); ++c)
    for (const GroomLayer& layer : grooms[c]->layers)
      layers.push_back({.name = std::string(scene.LayerName(uint32_t(layers.size()))),
                        .character = c,
                        .solver = WordOf(&LayerParams::solver, layer.params),
                        .asked = layer.params.solver == Solver::kModal
                                     ? WordOf(&LayerParams::quality, layer.params)
                                     : std::string_view()});
  return layers;
}

void AddFrame(const FurScene& scene, std::vector<LayerQuality>& layers) {
  for (uint32_t l = 0; l < layers.size(); ++l) {
    LayerQuality& layer = layers[l];
    if (layer.asked.empty()) continue;
    const ScreenQuality ran = scene.QualityOf(l);
    ++layer.frames[size_t(ran.quality)];
    layer.chain_level = std::max(layer.chain_level, ran.chain_level);
    layer.error_px = std::max(layer.error_px, ran.error_px);
  }
}

void AddLayerQuality(const std::vector<LayerQuality>& layers, ReportTree& tree) {
  struct Group {
    LayerQuality sum;
    uint32_t layers = 0;
  };
  std::map<std::pair<std::string_view, std::string_view>, Group> groups;
  ReportTable& table = tree.AddTable("layer_quality", {InText("layers"),
                                                       InJson("layer"),
                                                       InJson("character"),
                                                       {"solver"},
                                                       {"asked", "", -1, "quality"},
                                                       {"ran.fast", "% ran", 1, "fast", 100},
                                                       {"ran.fine", "% ran", 1, "fine", 100},
                                                       {"ran.best", "% ran", 1, "best", 100},
                                                       {"least_chains", "%", 1, "chains", 100},
                                                       {"error_px", "px", 2, "99 % within"}});
  for (size_t l = 0; l < layers.size(); ++l) {
    const LayerQuality& layer = layers[l];
    AddRow(layer,
           {Value(), fmt::format("layer {} {}", l, layer.name),
            fmt::format("character {}", layer.character)},
           Show::kJson, table);
    Group& group = groups[{layer.solver, layer.asked}];
    if (group.layers++ == 0) {
      group.sum = layer;
      continue;
    }
    for (size_t q = 0; q < layer.frames.size(); ++q) group.sum.frames[q] += layer.frames[q];
    group.sum.chain_level = std::max(group.sum.chain_level, layer.chain_level);
    group.sum.error_px = std::max(group.sum.error_px, layer.error_px);
  }
  for (const auto& [key, group] : groups)
    AddRow(group.sum, {group.layers, Value(), Value()}, Show::kText, table);
}

void AddMemory(const SceneLayout& layout, ReportTree& report) {
  ReportTable& memory =
      report.AddTable("memory", {{.key = "memory"}, {"bytes"}, {"blocks"}, {"role"}});
  memory.is_map = true;
  for (const MemoryRange& range : layout.ranges)
    if (range.bytes) memory.Add({range.name, range.bytes, range.blocks, RoleName(range.role)});
  report.Add({"memory_bytes", "B", -1, "all"}, layout.total_bytes);
  report.Add(InText("bytes per strand", "", 0),
             double(layout.total_bytes) / double(layout.strand_count));
  report.Add({"state_bytes_per_strand", "", 1, "of them simulation state"},
             layout.StateBytesPerStrand());
}

void CheckRecords(ExecutorKind executor) {
  if (executor->local_store)
    throw Error(fmt::format(
        "the {} executor records no times: what it spends copying is not what a frame costs. Take "
        "serial, tbb or permuted",
        executor->name));
}

RunReport RunFrames(Scenario& scenario, RunningScenario& running, const RunOptions& options) {
  VerifyCase as_case;
  as_case.executor = options.executor;
  as_case.workers = options.workers;
  as_case.order_seed = options.order_seed;
  const std::unique_ptr<WatchedExecutor> executor = MakeExecutor(as_case);

  FurScene& scene = running.scene();
  RunReport report;
  report.scene = scenario.name;
  report.machine = DescribeMachine();
  report.options = options;
  report.frames = options.frames ? options.frames : scenario.default_frames;
  report.workers = WorkersOf(as_case);
  report.workers_observed = executor->ObservedWorkers();
  report.strands = scene.layout().strand_count;
  report.characters = scene.shape().character_count;
  report.layers = scene.shape().layer_count;
  report.chunks = scene.shape().chunk_count;
  report.layout = scene.layout();
  for (const Groom* groom : scenario.ActorGrooms())
    for (const auto& layer : groom->layers) report.layer_strands.push_back(layer.strand_count);
  report.qualities = QualitiesOf(scene, scenario.ActorGrooms());

  BudgetRecorder recorder(scene, report.frames);
  Digest fold;
  for (uint32_t f = 0; f < options.warm_up; ++f) {
    running.Begin(f, options.skip, options.lod);
    executor->Run(scene.CurrentFrame());
  }
  const MachineUseWatch use;
  for (uint32_t f = 0; f < report.frames; ++f) {
    if (options.progress) options.progress(f, report.frames);
    const bool observed = options.observe && f >= options.observe_from_frame;
    const FrameProfile* profile =
        recorder.Begin(observed ? options.observed_as : Recording::kBudget);
    FrameTicks ticks;
    const CoreWait before = observed ? ReadCoreWait() : CoreWait{};
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
    AddFrame(scene, report.qualities);
    if (observed) options.observe({f, ticks, *profile, scene, ReadCoreWait().Since(before)});
    if (options.after_frame) options.after_frame(f, scene);
    if (options.digest) fold.Add64(scene.DigestFrame());
  }
  report.use = use.Finish();
  report.budget = recorder.Summarise();
  report.costs = recorder.SplitCosts(report.layer_strands);
  if (options.digest) report.digest = fold.Value();
  report.fur_budget = scene.budget();
  report.live_strands = scene.LiveStrands();
  report.drawn_strands = scene.DrawnStrands();
  report.faults = executor->Faults();
  return report;
}

namespace {

// What the last frame's choice is said to take.
void AddFurBudget(const RunReport& r, ReportTree& tree) {
  const LodSettings& lod = r.options.lod;
  if (lod.budget_us == 0) return;
  const LodBudget& found = r.fur_budget;
  ReportTree& section = tree.AddSection("fur_budget");
  section.Add(InJson("budget_us"), lod.budget_us).Add(InJson("estimate_us"), 1e-3 * found.ns);
  section.Add(InJson("fast_px"), found.fast_px).Add(InJson("share"), found.scale);
  section.Add(InJson("chunk_ns"), lod.costs.chunk_ns);
  section.Add(InJson("vertex_ns"), lod.costs.vertex_ns);
  section.Add(InJson("strand_ns"), lod.costs.strand_ns);
  std::vector<std::string> nodes;
  for (const float ns : lod.costs.node_ns) nodes.push_back(fmt::format("{:.1f}", ns));
  section.Say(
      fmt::format("{}: fur for {} us of core time, by its costs {:.0f}: 'fine' in 'fast' up to "
                  "{:.2f} px, {:.1f} % of the "
                  "strands that are asked for",
                  1e-3 * found.ns <= 1.001 * lod.budget_us ? "IN BUDGET" : "OVER BUDGET",
                  lod.budget_us, 1e-3 * found.ns, found.fast_px, 100.0 * found.scale));
  section.Say(fmt::format(
      "costs: {:.0f} ns a chunk, {:.1f} a vertex, {:.1f} a strand, {} a chain's point by PBD, "
      "Verlet, fast, fine, best",
      lod.costs.chunk_ns, lod.costs.vertex_ns, lod.costs.strand_ns, fmt::join(nodes, ", ")));
}

}  // namespace

ReportTree MakeRunTree(const RunReport& r) {
  ReportTree tree;
  tree.Add({"scene"}, r.scene).Add({"strands"}, r.strands).Add({"chunks"}, r.chunks);
  tree.Add({"layers"}, r.layers).Add({"characters"}, r.characters).Add({"frames"}, r.frames);
  tree.EndLine();
  AddMachine(r.machine, tree);
  tree.EndLine();
  tree.Add({"executor"}, r.options.executor->name);
  if (r.options.executor->HasSeed()) tree.Add(InText("seed"), r.options.order_seed);
  const Show if_workers = r.options.executor->HasWorkers() ? Show::kBoth : Show::kJson;
  tree.Add({.key = "workers", .heading = "workers asked for", .show = if_workers}, r.workers);
  tree.Add({.key = "workers_observed", .heading = "observed", .show = if_workers},
           r.workers_observed);
  tree.Add({"isa", "", -1, "kernels"}, IsaName(r.options.scene.isa));
  tree.Add({"fused"}, r.options.scene.plan.fuse);
  tree.EndLine();
  AddMachineUse(r.use, r.workers, tree);
  AddBudget(r.budget, r.workers, tree);
  AddCostSplit(r.costs, r.budget, tree);
  AddLayerQuality(r.qualities, tree);
  AddFurBudget(r, tree);
  AddMemory(r.layout, tree);
  tree.BlankLine();
  tree.Add({"live_strands"}, r.live_strands).Add({"drawn_strands"}, r.drawn_strands);
  tree.AddTexts("faults", r.faults, "FAULT");
  if (r.options.digest)
    tree.Add({"digest"}, DigestText(r.digest));
  else
    tree.Say("digest not taken");
  AddSamples(r.budget, r.costs, tree);
  return tree;
}

}  // namespace pelt
