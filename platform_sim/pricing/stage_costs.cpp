#include "platform_sim/pricing/stage_costs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/format.hpp"
#include "platform_sim/pricing/record_stage.hpp"

namespace pelt {
namespace {

constexpr uint32_t kLanesPerIteration = 4;

uint32_t IterationsOf(uint32_t lanes, uint32_t group = 1) {
  lanes = (lanes + group - 1) / group * group;
  return (lanes + kLanesPerIteration - 1) / kLanesPerIteration;
}

// Of the port of a patch's or chunk's stage.
uint32_t LaneIterations(const FrameMemory& memory, const PortDesc& port, uint32_t item) {
  const StreamDesc& stream = (*memory.table)[port.stream];
  if (port.access == Access::kScatter) return IterationsOf(port.records);
  if (stream.lanes.count) return IterationsOf(stream.lanes.count(memory, item), stream.lanes.group);
  uint32_t lanes = 1;
  for (const RowDesc& row : stream.rows) lanes = std::max(lanes, row.lane_count);
  return IterationsOf(std::min(lanes, memory.table->chunk_lanes));
}

// Live lanes of all items of a layer.
uint32_t LayerLanes(const FrameMemory& memory, const StreamDesc& stream, uint32_t layer) {
  const SceneShape& shape = *memory.shape;
  uint32_t live = 0;
  for (uint32_t i = 0; i < shape.LayerItems(stream.domain, layer); ++i)
    live += stream.lanes.count(memory, shape.LayerFirst(stream.domain, layer) + i);
  return live;
}

}  // namespace

uint32_t CountIterations(const Frame& frame, uint32_t stage_index, uint32_t item) {
  const Stage& stage = frame.plan->stages[stage_index];
  const FrameMemory& memory = *frame.memory;
  uint32_t iterations = 0;
  bool has_lanes = IsInLayer(stage.domain);
  for (const PortDesc& port : stage.kernel.ports) {
    if (!IsWritten(port.access)) continue;
    const StreamDesc& stream = (*memory.table)[port.stream];
    if (IsInLayer(stage.domain)) {
      iterations = std::max(iterations, LaneIterations(memory, port, item));
    } else if (stage.domain == Domain::kLayer && IsInLayer(port.domain) && stream.lanes.count) {
      iterations = std::max(iterations, IterationsOf(LayerLanes(memory, stream, item)));
      has_lanes = true;
    }
  }
  return has_lanes ? iterations : 1;
}

namespace {

// What an item's recording shows; items of one kind are near each other in it.
struct Profile {
  std::array<bool, kRecordedKindCount> has{};
  double operations_per_iteration = 0.0;
};

Profile ProfileOf(const Recorder& recorder, uint32_t iterations) {
  Profile p;
  for (uint32_t k = 0; k < kRecordedKindCount; ++k) p.has[k] = recorder.counts()[k] > 0;
  p.operations_per_iteration = double(recorder.operation_count()) / std::max(iterations, 1u);
  return p;
}

constexpr double kOneKind = 1.25;  // of operations per iteration, at most

double Apart(const Profile& a, const Profile& b) {
  const double ratio = a.operations_per_iteration / std::max(b.operations_per_iteration, 1e-9);
  return std::max(ratio, 1.0 / std::max(ratio, 1e-9));
}
bool IsOneKind(const Profile& a, const Profile& b) {
  return a.has == b.has && Apart(a, b) < kOneKind;
}

class Pricing {
 public:
  Pricing(const Frame& frame, std::span<const KernelDesc> kernels, const PricedCore& core,
          const PriceRules& rules, KnownPrices& known)
      : frame_(frame),
        kernels_(kernels),
        core_(core),
        rules_(rules),
        known_(known),
        work_(frame.plan->stages.size()) {
    costs_.clock_hz = core.clock_hz;
    for (const Stage& stage : frame.plan->stages) {
      const uint32_t items = frame.memory->shape->ItemCount(stage.domain);
      StageCosts::Stage& priced = costs_.stages.emplace_back();
      priced.name = stage.kernel.name;
      for (StageCosts::Stage::Price* price : {&priced.as_written, &priced.scheduled}) {
        price->cycles_per_iteration.resize(items);
        price->shared_cycles_per_iteration.resize(items);
      }
    }
    for (StageWork& work : work_) work.layer_seen.resize(frame.memory->shape->layer_count + 1);
  }

  Result<> Record(uint32_t stage, uint32_t item) {
    StageWork& work = work_[stage];
    const uint32_t group = GroupOf(stage, item);
    const bool keep = !work.layer_seen[group];
    work.layer_seen[group] = true;
    Recorder recorder(keep ? Recorder::Keep::kOperations : Recorder::Keep::kCounts);
    auto recorded = RecordStage(frame_, stage, item, kernels_, recorder);
    if (!recorded) return recorded;
    const uint32_t iterations = std::max(CountIterations(frame_, stage, item), 1u);
    const Profile profile = ProfileOf(recorder, iterations);
    if (recorder.operation_count() == 0) {
      work.items.push_back({item, profile, UnseenCycles(stage, item) / iterations});
      return Done{};
    }
    work.items.push_back({item, profile, 0.0});
    const bool is_known = std::ranges::any_of(
        work.profiles, [&](const Profile& known) { return IsOneKind(profile, known); });
    if (!keep || is_known) return Done{};
    const auto cost = known_.Find(recorder.trace(), iterations, core_, rules_);
    if (!cost) return Failure{Format("{}: {}", costs_.stages[stage].name, cost.error())};
    work.profiles.push_back(profile);
    costs_.stages[stage].kinds.push_back(*cost);
    return Done{};
  }

  StageCosts Take() {
    for (uint32_t s = 0; s < work_.size(); ++s) FillStage(work_[s], costs_.stages[s]);
    return std::move(costs_);
  }

 private:
  struct Item {
    uint32_t item;
    Profile profile;
    double unseen_cycles_per_iteration;
  };
  struct StageWork {
    std::vector<bool> layer_seen;
    std::vector<Profile> profiles;  // of StageCosts::Stage::kinds
    std::vector<Item> items;
  };

  // The first item of every layer is recorded whole; the rest counted.
  uint32_t GroupOf(uint32_t stage, uint32_t item) const {
    const SceneShape& shape = *frame_.memory->shape;
    const Domain domain = frame_.plan->stages[stage].domain;
    return domain < Domain::kLayer ? shape.layer_count : shape.LayerOf(domain, item);
  }

  double UnseenCycles(uint32_t stage_index, uint32_t item) const {
    const Stage& stage = frame_.plan->stages[stage_index];
    uint64_t words = 0;
    for (const PortDesc& port : stage.kernel.ports) {
      if (port.block_bytes > kSmallBlockBytes) continue;
      const Binding binding = BindPort(port, *frame_.memory, stage.domain, item);
      // Lists end in entries that mean nothing.
      const uint32_t blocks =
          port.access == Access::kGather
              ? uint32_t(std::count_if(binding.index, binding.index + binding.count,
                                       [](uint32_t place) { return place != ~0u; }))
              : binding.count;
      words += uint64_t(port.block_bytes) / 4 * blocks;
    }
    return double(words) * core_.scalar_word_cycles;
  }

  size_t NearestKind(const StageWork& work, const Profile& profile) const {
    size_t nearest = 0;
    const auto distance = [&](size_t k) {
      return Apart(profile, work.profiles[k]) + (profile.has == work.profiles[k].has ? 0.0 : 10.0);
    };
    for (size_t k = 1; k < work.profiles.size(); ++k)
      if (distance(k) < distance(nearest)) nearest = k;
    return nearest;
  }

  void FillStage(const StageWork& work, StageCosts::Stage& out) const {
    FillPrice(work, out.kinds, &KernelCost::as_written, out.as_written);
    FillPrice(work, out.kinds, &KernelCost::scheduled, out.scheduled);
    for (const KernelCost& cost : out.kinds)
      out.code_bytes = std::max(out.code_bytes, cost.code_bytes);
  }

  void FillPrice(const StageWork& work, const std::vector<KernelCost>& kinds,
                 CodePrice KernelCost::*code, StageCosts::Stage::Price& out) const {
    double fixed = 0.0;
    for (const Item& item : work.items) {
      if (item.profile.operations_per_iteration == 0.0 || work.profiles.empty()) {
        out.cycles_per_iteration[item.item] = float(item.unseen_cycles_per_iteration);
        // Every other cycle of a core is the other thread's.
        out.shared_cycles_per_iteration[item.item] =
            float(item.unseen_cycles_per_iteration * (core_.time_shared ? 2.0 : 1.0));
        fixed += core_.call_cycles;
        continue;
      }
      const KernelCost& cost = kinds[NearestKind(work, item.profile)];
      const CodePrice& price = cost.*code;
      const double operations = item.profile.operations_per_iteration;
      out.cycles_per_iteration[item.item] =
          float(cost.PerOperation(price.cycles_per_iteration) * operations);
      out.shared_cycles_per_iteration[item.item] =
          float(cost.PerOperation(price.shared_cycles_per_iteration) * operations);
      fixed += price.fixed_cycles;
    }
    if (!work.items.empty()) out.fixed_cycles = float(fixed / double(work.items.size()));
  }

  const Frame& frame_;
  const std::span<const KernelDesc> kernels_;
  const PricedCore& core_;
  const PriceRules& rules_;
  KnownPrices& known_;
  std::vector<StageWork> work_;
  StageCosts costs_;
};

}  // namespace

Result<StageCosts> PriceStages(const Frame& frame, std::span<const KernelDesc> kernels,
                               const PricedCore& core, const PriceRules& rules,
                               KnownPrices* known) {
  KnownPrices none;
  Pricing pricing(frame, kernels, core, rules, known ? *known : none);
  Result<> recorded = Done{};
  RecordFrame(frame, [&](uint32_t, uint32_t stage, uint32_t item) {
    recorded = pricing.Record(stage, item);
    return bool(recorded);
  });
  if (!recorded) return Failure{recorded.error()};
  return pricing.Take();
}

}  // namespace pelt
