#include "bench/report/budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pelt {
namespace {

constexpr double kLinesMs[] = {5.0, 8.0};

uint64_t PortBytes(const PortDesc& port, const SceneShape& shape, Domain domain, uint32_t item) {
  switch (port.access) {
    case Access::kAll:
    case Access::kAllOut:
    case Access::kAllInOut:
      return uint64_t(port.block_bytes) * PlaceOf(shape, domain, item).count[size_t(port.domain)];
    case Access::kGather:
    case Access::kScatter:
      return uint64_t(port.block_bytes) * port.records;
    default:
      return port.block_bytes;
  }
}

uint32_t LayerOfItem(const SceneShape& shape, Domain domain, uint32_t item) {
  return domain >= Domain::kLayer ? shape.LayerOf(domain, item) : 0;
}

// A nanosecond is less than what a clock can resolve, and digits take room.
std::vector<double> Rounded(std::vector<double> ms) {
  for (double& value : ms) value = std::round(value * 1e6) * 1e-6;
  return ms;
}

bool IsInScene(const StageBudget& stage) { return stage.ran + stage.skipped != 0.0; }

bool Admits(const Stage& stage, const SceneShape& shape, uint32_t item) {
  return stage.domain < Domain::kLayer ||
         stage.kinds.Admits(shape.layer_kind[LayerOfItem(shape, stage.domain, item)]);
}

}  // namespace

Spread SpreadOf(std::span<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[size_t(share * double(values.size() - 1) + 0.5)];
  };
  return {at(0.5), at(0.95), values.back()};
}

PortTraffic StageTraffic(const Stage& stage, const SceneShape& shape, uint32_t item) {
  PortTraffic traffic{};
  for (const PortDesc& port : stage.kernel.ports) {
    if (port.access == Access::kShared) continue;
    const uint64_t bytes = PortBytes(port, shape, stage.domain, item);
    const bool out_only = port.access == Access::kOut || port.access == Access::kAllOut ||
                          port.access == Access::kScatter;
    const bool in_only =
        port.access == Access::kIn || port.access == Access::kAll || port.access == Access::kGather;
    if (!out_only) traffic.in_bytes += bytes;
    if (!in_only) traffic.out_bytes += bytes;
  }
  return traffic;
}

BudgetRecorder::BudgetRecorder(const FurScene& scene, uint32_t frames)
    : scene_(scene), times_(scene.plan(), scene.shape()), costs_(scene, frames) {
  const Plan& plan = scene.plan();
  const SceneShape& shape = scene.shape();
  for (const Stage& stage : plan.stages) {
    const uint32_t items = shape.ItemCount(stage.domain);
    uint64_t admitted = 0;
    std::vector<uint64_t> of_layer(stage.domain < Domain::kLayer ? 1 : shape.layer_count);
    for (uint32_t i = 0; i < items; ++i) {
      if (!Admits(stage, shape, i)) continue;
      ++admitted;
      const PortTraffic traffic = StageTraffic(stage, shape, i);
      of_layer[LayerOfItem(shape, stage.domain, i)] = traffic.in_bytes + traffic.out_bytes;
    }
    admitted_.push_back(admitted);
    item_bytes_.push_back(std::move(of_layer));
  }
  stage_ms_.resize(plan.stages.size());
  pass_ms_.resize(plan.passes.size());
  for (auto& row : stage_ms_) row.reserve(frames);
  for (auto& row : pass_ms_) row.reserve(frames);
  caller_ms_.reserve(frames);
  wall_ms_.reserve(frames);
  ran_.resize(plan.stages.size());
  bytes_.resize(plan.stages.size());
}

const FrameProfile* BudgetRecorder::Begin(Recording recording) {
  const bool all = recording == Recording::kAll, trace = recording == Recording::kTrace;
  has_stages_ = all || frame_ % (trace ? 4 : 2) == 1;
  has_wall_ = all || !has_stages_;
  times_.TimeStages(has_stages_);
  return has_stages_ || trace ? times_.profile() : nullptr;
}

void BudgetRecorder::Finish(uint64_t caller_ns, uint64_t wall_ns) {
  ++frame_;
  caller_ms_.push_back(double(caller_ns) * 1e-6);
  if (has_wall_) wall_ms_.push_back(double(wall_ns) * 1e-6);
  if (!has_stages_) return;
  const double ms_per_tick = times_.NsPerTick() * 1e-6;
  const Plan& plan = scene_.plan();
  const SceneShape& shape = scene_.shape();
  costs_.BeginFrame();
  for (size_t s = 0; s < plan.stages.size(); ++s) {
    const Domain domain = plan.stages[s].domain;
    uint64_t sum_ticks = 0;
    for (uint32_t i = 0; i < shape.ItemCount(domain); ++i) {
      const Slice slice = times_.Stage(uint32_t(s), i);
      if (!slice.Ran()) continue;
      sum_ticks += slice.Ticks();
      costs_.Add(uint32_t(s), i, slice.Ticks());
      ++ran_[s];
      bytes_[s] += item_bytes_[s][LayerOfItem(shape, domain, i)];
    }
    stage_ms_[s].push_back(double(sum_ticks) * ms_per_tick);
  }
  for (size_t p = 0; p < plan.passes.size(); ++p)
    pass_ms_[p].push_back(double(times_.Pass(uint32_t(p)).Ticks()) * ms_per_tick);
}

Budget BudgetRecorder::Summarise() const {
  const Plan& plan = scene_.plan();
  Budget budget;
  budget.frames = frame_;
  const auto spread = [](std::vector<double> values) { return SpreadOf(values); };
  const double strands = double(scene_.layout().strand_count);
  for (size_t s = 0; s < plan.stages.size(); ++s) {
    const double profiled = std::max<double>(1.0, double(stage_ms_[s].size()));
    StageBudget row;
    row.name = plan.stages[s].kernel.name;
    row.domain = plan.stages[s].domain;
    row.core_ms = spread(stage_ms_[s]);
    row.samples_ms = stage_ms_[s];
    row.ns_per_strand = row.core_ms.median * 1e6 / strands;
    row.bytes = double(bytes_[s]) / profiled;
    row.ran = double(ran_[s]) / profiled;
    row.skipped = double(admitted_[s]) - row.ran;
    budget.stages.push_back(row);
  }
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    const Pass& pass = plan.passes[p];
    const uint32_t last = pass.first_stage + pass.stage_count - 1;
    std::string stages(plan.stages[pass.first_stage].kernel.name);
    if (pass.stage_count > 1) stages += fmt::format(" .. {}", plan.stages[last].kernel.name);
    budget.passes.push_back({stages, spread(pass_ms_[p])});
  }
  budget.caller_ms = spread(caller_ms_);
  budget.wall_ms = spread(wall_ms_);
  budget.samples_ms = wall_ms_;
  budget.ns_per_strand = budget.wall_ms.median * 1e6 / strands;
  return budget;
}

void AddSpread(const std::string& key, const std::string& heading, const Spread& spread,
               ReportTree& tree) {
  ReportTree& of = tree.AddSection(key, heading);
  of.Add({"median", "ms", 3}, spread.median).Add({"p95", "ms", 3}, spread.p95);
  of.Add({"worst", "ms", 3}, spread.worst);
}

void AddBudget(const Budget& budget, uint32_t workers, ReportTree& tree) {
  ReportTable& stages = tree.AddTable("stages", {{"stage"},
                                                 {"core_ms.median", "core ms", 3},
                                                 {"core_ms.p95", "core ms", 3},
                                                 {"core_ms.worst", "core ms", 3},
                                                 {"ns_per_strand", "ns/strand", 2, "median"},
                                                 {"bytes_moved", "MB", 2, "moved", 1e-6},
                                                 {"items_run", "items", 1, "run"},
                                                 {"items_skipped", "items", 1, "skipped"},
                                                 {"share_of_5ms", "%", 1, "of 5 ms", 100},
                                                 {"share_of_8ms", "%", 1, "of 8 ms", 100}});
  const auto share = [&](double ms, int line) { return ms / (workers * kLinesMs[line]); };
  double bytes = 0.0, core_ms = 0.0;
  for (const StageBudget& s : budget.stages) {
    bytes += s.bytes;
    core_ms += s.core_ms.median;
    if (!IsInScene(s)) continue;
    stages.Add({s.name, s.core_ms.median, s.core_ms.p95, s.core_ms.worst, s.ns_per_strand, s.bytes,
                s.ran, s.skipped, share(s.core_ms.median, 0), share(s.core_ms.median, 1)});
  }
  stages.Add(
      {"all stages", core_ms, {}, {}, {}, bytes, {}, {}, share(core_ms, 0), share(core_ms, 1)},
      Show::kText);
  tree.Say(
      fmt::format("Shares are of 5 and 8 ms on each of {} workers; items are chunks, layers or "
                  "characters of a frame.",
                  workers));
  ReportTable& passes = tree.AddTable("passes", {InText("pass"),
                                                 {"wall_ms.median", "wall ms", 3},
                                                 {"wall_ms.p95", "wall ms", 3},
                                                 {"wall_ms.worst", "wall ms", 3},
                                                 {"stages"}});
  for (size_t p = 0; p < budget.passes.size(); ++p) {
    const Spread& ms = budget.passes[p].wall_ms;
    passes.Add({p, ms.median, ms.p95, ms.worst, budget.passes[p].stages});
  }
  tree.BlankLine();
  AddSpread("caller_ms", "poses and parameters, on the caller's thread", budget.caller_ms, tree);
  AddSpread("frame_ms", "whole frame", budget.wall_ms, tree);
  tree.Add({"ns_per_strand", "ns", 1}, budget.ns_per_strand);
  for (const double line : kLinesMs)
    tree.Add({.key = fmt::format("of {} ms", line),
              .unit = "%",
              .decimals = 1,
              .scale = 100,
              .show = Show::kText},
             budget.wall_ms.median / line);
}

namespace {

// What they are called where both kinds stand beside each other; layers may share a name.
std::string LayerLabel(const CostSplit& costs, size_t layer) {
  return fmt::format("layer {} {}", layer, costs.layers[layer].name);
}
std::string CharacterLabel(size_t character) { return fmt::format("character {}", character); }

Value NsPerStrand(double ms, uint64_t strands) {
  return strands ? Value(ms * 1e6 / double(strands)) : Value();
}

}  // namespace

void AddCostSplit(const CostSplit& costs, const Budget& budget, ReportTree& tree) {
  ReportTable layers{.key = {},
                     .columns = {{"layer"},
                                 {"character"},
                                 {"strands"},
                                 {"chunks"},
                                 {"core_ms.median"},
                                 {"core_ms.p95"},
                                 {"core_ms.worst"},
                                 {"ns_per_strand"},
                                 {"dearest_stage"},
                                 {"dearest_share"}}};
  for (size_t l = 0; l < costs.layers.size(); ++l) {
    const LayerCost& layer = costs.layers[l];
    layers.Add({LayerLabel(costs, l), CharacterLabel(layer.character), layer.strands, layer.chunks,
                layer.core_ms.median, layer.core_ms.p95, layer.core_ms.worst,
                NsPerStrand(layer.core_ms.median, layer.strands),
                budget.stages[layer.dearest_stage].name, layer.dearest_share});
  }
  tree.Add(InJson("layer_costs"), std::move(layers));
  ReportTable characters{.key = {},
                         .columns = {{"character"},
                                     {"layers"},
                                     {"strands"},
                                     {"core_ms.median"},
                                     {"core_ms.p95"},
                                     {"core_ms.worst"},
                                     {"ns_per_strand"},
                                     {"pose_and_joints_ms"}}};
  for (size_t c = 0; c < costs.characters.size(); ++c) {
    const CharacterCost& character = costs.characters[c];
    characters.Add({CharacterLabel(c), character.layers, character.strands,
                    character.core_ms.median, character.core_ms.p95, character.core_ms.worst,
                    NsPerStrand(character.core_ms.median, character.strands), character.own_ms});
  }
  tree.Add(InJson("character_costs"), std::move(characters));
}

void AddSamples(const Budget& budget, const CostSplit& costs, ReportTree& tree) {
  tree.Add(InJson("samples.frame_ms"), Rounded(budget.samples_ms));
  ReportTable stages{.key = {}, .columns = {{"stage"}, {"core_ms"}}, .is_map = true};
  for (const StageBudget& s : budget.stages)
    if (IsInScene(s)) stages.Add({s.name, Rounded(s.samples_ms)});
  tree.Add(InJson("samples.stages"), std::move(stages));
  ReportTable layers{.key = {}, .columns = {{"layer"}, {"core_ms"}}, .is_map = true};
  for (size_t l = 0; l < costs.layers.size(); ++l)
    layers.Add({LayerLabel(costs, l), Rounded(costs.layers[l].samples_ms)});
  tree.Add(InJson("samples.layers"), std::move(layers));
  ReportTable characters{.key = {}, .columns = {{"character"}, {"core_ms"}}, .is_map = true};
  for (size_t c = 0; c < costs.characters.size(); ++c)
    characters.Add({CharacterLabel(c), Rounded(costs.characters[c].samples_ms)});
  tree.Add(InJson("samples.characters"), std::move(characters));
}

}  // namespace pelt
