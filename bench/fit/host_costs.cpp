#include "bench/fit/host_costs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "bench/fit/layer_work.hpp"
#include "bench/fit/tiers.hpp"
#include "bench/report/run_report.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/setup_entries.hpp"
#include "core/modal/modal_quality.hpp"
#include "jobs/frame_recording.hpp"

namespace pelt {
namespace {

constexpr uint64_t kCostsBytesLimit = 1u << 20;

// The stages whose iterations cost what the tier of their layer says.
bool IsByTier(std::string_view stage) { return stage.starts_with("simulate_modal"); }

// Of a layer with the modal solver.
std::string_view TierOf(ModalQuality quality, CurlFollows curl) {
  for (const Tier& tier : Tiers())
    if (tier.choice.solver == Solver::kModal && tier.choice.quality == quality &&
        tier.choice.curl_follows.value_or(curl) == curl)
      return tier.name;
  return {};
}

using StageKey = std::pair<std::string, std::string>;  // stage, tier

// Of work after its frame, by the quality that ran.
StageKey KeyOf(const FurScene& scene, const StageWork& work,
               const std::vector<const LayerParams*>& layers) {
  const std::string_view name = scene.plan().stages[work.stage].kernel.name;
  if (work.layer == kNoLayer || !IsByTier(name)) return {std::string(name), {}};
  return {std::string(name), std::string(TierOf(scene.QualityOf(work.layer).quality,
                                                layers[work.layer]->curl_follows))};
}

double P95(std::vector<double> values) {
  const auto at = values.begin() + ptrdiff_t((values.size() - 1) * 95 / 100);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}
double Median(std::vector<double> values) {
  const auto at = values.begin() + ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// ns = item * items + iteration * iterations, through runs that weigh alike, with nothing below 0.
class CostLine {
 public:
  void Add(double items, double iterations, double ns) {
    const double weight = 1.0 / (ns * ns);
    items_[0] += weight * items * items;
    items_[1] += weight * items * iterations;
    iterations_ += weight * iterations * iterations;
    ns_[0] += weight * items * ns;
    ns_[1] += weight * iterations * ns;
  }
  struct Costs {
    double item = 0.0, iteration = 0.0;
  };
  Costs Solve() const {
    const double determinant = items_[0] * iterations_ - items_[1] * items_[1];
    const Costs by_iteration{0.0, iterations_ > 0.0 ? ns_[1] / iterations_ : 0.0};
    // As many iterations an item in all runs: none is known for itself.
    if (!(determinant > 1e-6 * items_[0] * iterations_)) return by_iteration;
    const Costs line{(ns_[0] * iterations_ - ns_[1] * items_[1]) / determinant,
                     (ns_[1] * items_[0] - ns_[0] * items_[1]) / determinant};
    if (line.iteration < 0.0) return {ns_[0] / items_[0], 0.0};
    return line.item < 0.0 ? by_iteration : line;
  }

 private:
  double items_[2] = {}, iterations_ = 0.0, ns_[2] = {};
};

// What stages take, over the frames of many runs.
class Measured {
 public:
  // The median of a run's frames counts.
  void AddRun(Scenario& scenario, const CalibrationOptions& options, bool thins) {
    RunningScenario running(scenario, {});
    FrameRecording recording(running.scene().plan(), running.scene().shape());
    const std::vector<const LayerParams*> params = ListParams(scenario);
    std::map<StageKey, Run> runs;
    std::map<StageKey, Run> frame;
    // Every layer in its tier, seen or not.
    LodSettings lod;
    lod.fast_quality_px = 0.0f;
    lod.full_detail_px = 1e9f;  // where strands thin: to an eighth
    lod.min_fraction = 0.125f;
    WalkWork(
        running,
        {.warm_up = options.warm_up,
         .count = options.frames,
         .lod = lod,
         .thins = thins,
         .profile = recording.profile()},
        [&](const StageWork& work) {
          const Slice slice = recording.Stage(work.stage, work.item);
          if (!slice.Ran()) return;
          Run& sum = frame[KeyOf(running.scene(), work, params)];
          sum.ticks += double(slice.Ticks());
          sum.items += 1.0;
          sum.iterations += work.iterations;
        },
        [&] {
          for (const auto& [key, sum] : frame) runs[key].Add(sum);
          frame.clear();
        });
    for (const auto& [key, run] : runs) {
      const auto frames = double(run.frame_ticks.size());
      const double ns = Median(run.frame_ticks) * recording.NsPerTick();
      if (ns > 0.0) lines_[key].Add(run.items / frames, run.iterations / frames, ns);
    }
  }

  std::vector<HostCosts::Stage> Stages() const {
    const auto picoseconds = [](double ns) { return uint32_t(1e3 * ns + 0.5); };
    std::vector<HostCosts::Stage> stages;
    for (const auto& [key, line] : lines_) {
      const CostLine::Costs costs = line.Solve();
      stages.push_back(
          {key.first, key.second, picoseconds(costs.iteration), picoseconds(costs.item)});
    }
    return stages;
  }

 private:
  struct Run {
    double ticks = 0.0, items = 0.0, iterations = 0.0;
    std::vector<double> frame_ticks = {};

    void Add(const Run& frame) {
      frame_ticks.push_back(frame.ticks);
      items += frame.items;
      iterations += frame.iterations;
    }
  };
  std::map<StageKey, CostLine> lines_;
};

// What each stage costs.
class Prices {
 public:
  struct Price {
    uint64_t item = 0, iterations = 0;  // ps
    uint64_t All() const { return item + iterations; }
  };
  Prices(const HostCosts& costs, const std::string& path) : path_(path) {
    for (const HostCosts::Stage& stage : costs.stages)
      prices_[{stage.name, stage.tier}] = {stage.item_picoseconds, stage.picoseconds};
  }
  // Throws Error for what was not measured.
  Price Of(const FurScene& scene, const StageWork& work,
           const std::vector<const LayerParams*>& layers) const {
    const StageKey key = KeyOf(scene, work, layers);
    const auto price = prices_.find(key);
    if (price == prices_.end())
      throw Error(
          fmt::format("{}: has no cost of stage {}{}; pelt calibrate measures it with --scenes "
                      "that have it",
                      path_, key.first, key.second.empty() ? "" : ", " + key.second));
    return {price->second.item, price->second.iterations * work.iterations};
  }

 private:
  std::map<StageKey, Price> prices_;
  const std::string path_;
};

PlatformCost PriceOn(const HostCosts& costs, const std::string& path, Scenario& scenario,
                     uint32_t warm_up, uint32_t frames) {
  const Prices prices(costs, path);
  RunningScenario running(scenario, {});
  const std::vector<const LayerParams*> params = ListParams(scenario);
  std::vector<uint64_t> layers(params.size()), ended;
  uint64_t rest = 0, frame = 0;
  WalkWork(
      running, {.warm_up = warm_up, .count = frames},
      [&](const StageWork& work) {
        const uint64_t picoseconds = prices.Of(running.scene(), work, params).All();
        (work.layer == kNoLayer ? rest : layers[work.layer]) += picoseconds;
        frame += picoseconds;
      },
      [&] {
        ended.push_back(frame);
        frame = 0;
      });
  PlatformCost cost;
  for (const uint64_t picoseconds : layers) cost.layer_ns.push_back(picoseconds / 1000 / frames);
  cost.rest_ns = rest / 1000 / frames;
  const auto p95 = ended.begin() + ptrdiff_t((ended.size() - 1) * 95 / 100);
  std::nth_element(ended.begin(), p95, ended.end());
  cost.frame_ns = (*p95 / 1000) * costs.frame_permille / 1000;
  cost.live_strands = CountLiveStrands(running.scene());
  return cost;
}

}  // namespace

template <>
std::span<const KeyEntry<HostCosts::Stage>> Schema() {
  using S = HostCosts::Stage;
  using namespace setup_entries;
  static const KeyEntry<S> kEntries[] = {
      Required(Plain<&S::name>("name", "text", "of the stage")),
      Plain<&S::tier>("tier", "text", "of pelt fit"),
      Required(Count<&S::picoseconds>("picoseconds", 0, 4e9, "per iteration")),
      Count<&S::item_picoseconds>("item_picoseconds", 0, 4e9, "an item"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<HostCosts>> Schema() {
  using H = HostCosts;
  using namespace setup_entries;
  static const KeyEntry<H> kEntries[] = {
      Required(Plain<&H::processor>("processor", "text", "measured")),
      Required(Plain<&H::commit>("commit", "text", "of the program")),
      Required(Plain<&H::isa>("isa", "text", "of the kernels")),
      Required(Count<&H::workers>("workers", 1, 1024, "that shared a frame")),
      Required(Count<&H::frame_permille>("frame_permille", 1, 1e6, "of its core time")),
      {{"stage", "tables", "", 0, 1024, "costs"},
       [](SetupReader& reader, const KeyInfo& info, const toml::node& node, H& costs) {
         if (!node.is_array_of_tables())
           reader.FailKey(reader.LineOf(node), info.key, "expected [[stage]] tables");
         for (const toml::node& each : *node.as_array())
           reader.ReadTable({}, *each.as_table(), costs.stages.emplace_back());
       },
       nullptr},
  };
  return kEntries;
}

HostCosts MeasureHost(const CalibrationOptions& options, std::vector<std::string>& disturbances) {
  const Machine machine = DescribeMachine();
  HostCosts costs{.processor = machine.processor,
                  .commit = machine.commit,
                  .isa = std::string(IsaName(BestIsa())),
                  .workers = options.workers ? options.workers : machine.cores,
                  .stages = {}};
  const auto say = [&](const std::string& now) {
    if (options.progress) options.progress(now);
  };
  Measured measured;
  for (const std::string& name : options.scenes) {
    const Scenario scene = LoadScenario(name);
    for (const Tier& tier : Tiers()) {
      say(fmt::format("{}, {}", name, tier.name));
      std::vector<bool> has;
      Scenario way = AtTier(scene, tier, has);
      if (std::ranges::count(has, true))
        for (const bool thins : {false, true}) measured.AddRun(way, options, thins);
    }
  }
  costs.stages = measured.Stages();
  // What is left when workers share the core time: of the last scene as it is.
  say("frames");
  Scenario scene = LoadScenario(options.scenes.back());
  RunningScenario running(scene, {});
  RunOptions run;
  run.frames = options.frames;
  run.warm_up = options.warm_up;
  run.workers = costs.workers;
  run.digest = false;
  const RunReport report = RunFrames(scene, running, run);
  disturbances = FindDisturbances(report.use, report.workers);
  costs.frame_permille = 1000;
  const PlatformCost cost = PriceOn(costs, "calibration", scene, options.warm_up, options.frames);
  costs.frame_permille = std::max(1u, uint32_t(1e9 * P95(report.budget.samples_ms) /
                                                   double(std::max<uint64_t>(cost.frame_ns, 1)) +
                                               0.5));
  return costs;
}

std::string HostCostsText(const HostCosts& costs) {
  const auto quoted = [](const std::string& text) {
    std::ostringstream out;
    out << toml::value<std::string>(text);
    return out.str();
  };
  std::string text = fmt::format(
      "# pelt calibrate: what stages cost, for pelt fit --platform host --costs\n"
      "processor = {}\ncommit = {}\nisa = {}\nworkers = {}\n"
      "frame_permille = {}  # frame time over its core time\n",
      quoted(costs.processor), quoted(costs.commit), quoted(costs.isa), costs.workers,
      costs.frame_permille);
  for (const HostCosts::Stage& stage : costs.stages) {
    text += fmt::format("\n[[stage]]\nname = {}\n", quoted(stage.name));
    if (!stage.tier.empty()) text += fmt::format("tier = {}\n", quoted(stage.tier));
    text += fmt::format("picoseconds = {}\nitem_picoseconds = {}\n", stage.picoseconds,
                        stage.item_picoseconds);
  }
  return text;
}

HostCosts ReadHostCosts(const std::string& path) {
  const auto bytes = ReadFileBytes("costs", path, kCostsBytesLimit).OrThrow();
  HostCosts costs;
  SetupReader reader(path, "");
  reader.ReadTable({}, ParseToml(AsText(bytes), path), costs);
  return costs;
}

FurCosts FurCostsOnHost(const HostCosts& costs, const std::string& path, const Scenario& scene) {
  const Prices prices(costs, path);
  FurCostSums sums;
  std::vector<bool> has;
  const auto fast = std::ranges::find(Tiers(), "fast", &Tier::name);
  for (Scenario way : {scene, AtTier(scene, *fast, has)}) {
    const std::vector<const LayerParams*> params = ListParams(way);
    sums.Add(way, [&](const FurScene& fur, const StageWork& work) {
      const Prices::Price price = prices.Of(fur, work, params);
      return StagePrice{1e-3 * double(price.item), 1e-3 * double(price.iterations)};
    });
  }
  return sums.Take();
}

FitPlatform OnHost(const HostCosts& costs, const std::string& path, uint32_t warm_up,
                   uint32_t frames) {
  const auto price = [=](Scenario& scenario) {
    return PriceOn(costs, path, scenario, warm_up, frames);
  };
  const auto price_layers = [=](std::span<Scenario> scenes) {
    std::vector<PlatformCost> layers;
    for (Scenario& scene : scenes) layers.push_back(price(scene));
    return layers;
  };
  return {.name = "host", .price = price, .price_layers = price_layers};
}

}  // namespace pelt
