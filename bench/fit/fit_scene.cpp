#include "bench/fit/fit_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "bench/fit/layer_work.hpp"
#include "bench/fit/purchases.hpp"
#include "bench/fit/tiers.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

// Of plans that are tried. Each costs seconds; estimates are good to some percent, and what cannot run is
// found by halves.
constexpr uint32_t kMostPlans = 48;
constexpr uint32_t kOwn = ~0u;  // in place of a tier
// Shares of the strands that are tried, in sixteenths: with less than a quarter it is another coat.
constexpr uint32_t kAllStrands = 16, kFewestStrands = 4;
constexpr std::string_view kThinnedTier = "fast";

bool HasStrands(const LayerParams& layer) { return layer.output != Output::kShells; }

// Of a tier with fewer chains: what that adds to another tier is added in squares, as if they had nothing to do with
// each other.
uint32_t WithFewerChains(const TipError& tier, const TipError& other, const TipError& thinned) {
  const auto square = [](const TipError& error) {
    return double(error.p99_micropixels) * double(error.p99_micropixels);
  };
  const double added = std::max(square(thinned) - square(other), 0.0);
  return uint32_t(std::min(std::sqrt(square(tier) + added), double(UINT32_MAX)));
}

// Where something is within it.
void DropWorse(uint32_t most_micropixels, LayerOptions& options) {
  const auto is_within = [&](const LayerOption& option) {
    return option.micropixels <= most_micropixels;
  };
  if (std::ranges::any_of(options, is_within))
    std::erase_if(options, [&](const LayerOption& option) { return !is_within(option); });
}

class SceneFitter {
 public:
  SceneFitter(const Scenario& scene, const FitRequest& request)
      : scene_(scene),
        request_(request),
        layers_(ListLayers(scene)),
        params_(ListParams(scene)),
        purchases_(MeasureOptions()) {}

  SceneFit Find() {
    const Tried best = Search();
    SceneFit fit;
    fit.scene = scene_.name;
    fit.target_ns = request_.target_ns;
    fit.warm_up = request_.warm_up;
    fit.frames = request_.frames;
    for (const FitPlatform& platform : request_.platforms) fit.platforms.push_back(platform.name);
    fit.costs = best.costs;
    fit.strand_share = float(best.sixteenths) / float(kAllStrands);
    fit.notes = notes_;
    fit.plans_priced = uint32_t(tried_.size());
    for (uint32_t l = 0; l < layers_.size(); ++l) {
      SceneFit::Layer& layer = fit.layers.emplace_back();
      layer.choice = ChoiceOf(l, best);
      layer.tier = NameOf(OptionOf(best.choice, l).tier);
      layer.strands = best.costs[0].live_strands[l];
    }
    MeasurePlan(fit, best);
    if (fit.Fits() && best.sixteenths == kAllStrands) AddNext(best, fit);
    return fit;
  }

 private:
  struct Tried {
    Purchases::Choice choice;
    uint32_t sixteenths = kAllStrands;
    std::vector<PlatformCost> costs = {};
    std::string refusal = {};
  };

  void Say(const std::string& now) const {
    if (request_.progress) request_.progress(now);
  }
  static std::string NameOf(uint32_t tier) {
    return tier == kOwn ? "own" : std::string(Tiers()[tier].name);
  }
  const LayerOption& OptionOf(const Purchases::Choice& choice, uint32_t layer) const {
    return purchases_.layers()[layer][choice[layer]];
  }
  LayerChoice ChoiceOf(uint32_t layer, const Tried& plan) const {
    LayerChoice choice = layers_[layer];
    const LayerOption& option = OptionOf(plan.choice, layer);
    if (option.tier != kOwn) choice.choice = Tiers()[option.tier].choice;
    if (option.level > 0) choice.choice.chain_share = ChainShareOf(option.level);
    if (plan.sixteenths < kAllStrands && HasStrands(*params_[layer]))
      choice.choice.strand_share = float(plan.sixteenths) / float(kAllStrands);
    return choice;
  }

  // A tier on every layer that can have it.
  struct Way {
    uint32_t tier;
    std::vector<bool> has;
    std::vector<std::vector<PlatformCost>> costs;  // [platform][level of chains]
  };

  std::vector<std::vector<PlatformCost>> PriceLevels(const Scenario& way,
                                                     const std::string& name) const {
    std::vector<Scenario> levels(kChainLevels, way);
    for (uint32_t level = 1; level < kChainLevels; ++level) ThinChains(levels[level], level);
    std::vector<std::vector<PlatformCost>> costs;
    for (const FitPlatform& platform : request_.platforms) {
      Say(fmt::format("{}: {}", platform.name, name));
      costs.push_back(platform.price_layers(levels));
    }
    return costs;
  }

  std::vector<LayerOptions> MeasureOptions() {
    std::vector<Way> ways;
    std::vector<Scenario> measured;
    size_t other = 0;  // that is thinned
    for (uint32_t t = 0; t < Tiers().size(); ++t) {
      std::vector<bool> has;
      Scenario way = AtTier(scene_, Tiers()[t], has);
      if (std::ranges::count(has, true) == 0) continue;
      if (Tiers()[t].name == kThinnedTier) other = ways.size();
      ways.push_back({t, std::move(has), PriceLevels(way, NameOf(t))});
      measured.push_back(std::move(way));
    }
    if (ways.empty())
      throw Error(fmt::format("{}: no layer can be simulated in another way", scene_.name));
    for (uint32_t level = 1; level < kChainLevels; ++level) {
      measured.push_back(measured[other]);
      ThinChains(measured.back(), level);
    }
    const auto errors = MeasureTipErrors(scene_, measured, ErrorFramesOf("errors"));
    std::vector<LayerOptions> options;
    for (size_t l = 0; l < layers_.size(); ++l) {
      const auto error = [&](size_t w, uint32_t level) {
        if (level == 0) return errors[w][l].p99_micropixels;
        return WithFewerChains(errors[w][l], errors[other][l], errors[ways.size() + level - 1][l]);
      };
      options.push_back(OptionsOf(
          l, ways, [&](size_t w) { return errors[w][l].tips > 0; }, error));
    }
    return options;
  }

  template <class IsMeasured, class ErrorOf>
  LayerOptions OptionsOf(size_t l, const std::vector<Way>& ways, const IsMeasured& is_measured,
                         const ErrorOf& error_of) const {
    LayerOptions options;
    const auto add = [&](size_t w, uint32_t tier, uint32_t level) {
      LayerOption& option = options.emplace_back();
      option.tier = tier;
      option.level = level;
      option.micropixels = error_of(w, level);
      option.error = uint64_t(option.micropixels) * ways[0].costs[0][0].live_strands[l];
      for (const auto& levels : ways[w].costs) option.ns.push_back(levels[level].layer_ns[l]);
    };
    for (size_t w = 0; w < ways.size(); ++w)
      for (uint32_t level = 0; level < kChainLevels; ++level)
        if (ways[w].has[l] && is_measured(w) && (level == 0 || CanThin(*params_[l], level)))
          add(w, ways[w].tier, level);
    if (options.empty()) add(0, kOwn, 0);
    DropWorse(uint32_t(std::min(1e6 * double(request_.worst_px), double(UINT32_MAX))), options);
    return options;
  }

  ErrorFrames ErrorFramesOf(const char* what) const {
    return {.warm_up = request_.warm_up,
            .frames = request_.frames,
            .progress = [this, what](uint32_t done, uint32_t total) {
              Say(fmt::format("{}: frame {} of {}", what, done, total));
            }};
  }

  Scenario Planned(const Tried& plan) const {
    std::vector<LayerChoice> choices;
    for (uint32_t l = 0; l < layers_.size(); ++l) choices.push_back(ChoiceOf(l, plan));
    Scenario scenario = scene_;
    ApplyLayerPlan(choices, "plan", scenario);
    return scenario;
  }

  // Without costs: it cannot run. References stay good.
  const Tried& Price(const Purchases::Choice& choice, uint32_t sixteenths = kAllStrands) {
    const auto known = std::ranges::find_if(tried_, [&](const Tried& tried) {
      return tried.choice == choice && tried.sixteenths == sixteenths;
    });
    if (known != tried_.end()) return *known;
    Tried& tried = tried_.emplace_back(Tried{choice, sixteenths});
    Scenario scenario = Planned(tried);
    try {
      for (const FitPlatform& platform : request_.platforms) {
        Say(fmt::format("{}: plan {}", platform.name, tried_.size()));
        tried.costs.push_back(platform.price(scenario));
      }
    } catch (const Error& error) {
      tried.costs.clear();
      tried.refusal = error.what();
    }
    return tried;
  }

  static Purchases::Choice After(Purchases::Choice choice, std::span<const Purchase> bought) {
    for (const Purchase& purchase : bought) choice[purchase.layer] = purchase.option;
    return choice;
  }

  // The plan after these purchases, or after as many of the first of them as can run; the tier of the next
  // one is then closed to further layers.
  const Tried& PriceWhatRuns(const Purchases::Choice& from, std::span<const Purchase> bought) {
    const Tried* runs = &Price(After(from, bought));
    if (runs->refusal.empty()) return *runs;
    std::string refusal = runs->refusal;
    size_t good = 0, bad = bought.size();
    while (bad - good > 1) {
      const size_t middle = (good + bad) / 2;
      const Tried& tried = Price(After(from, bought.first(middle)));
      if (tried.refusal.empty()) {
        good = middle;
      } else {
        bad = middle;
        refusal = tried.refusal;
      }
    }
    const Purchase& first_bad = bought[good];
    const uint32_t tier = purchases_.layers()[first_bad.layer][first_bad.option].tier;
    runs = &Price(After(from, bought.first(good)));
    purchases_.Close(tier, runs->choice);
    notes_.push_back(fmt::format("no more layers can be {}: {}", NameOf(tier), refusal));
    return *runs;
  }

  bool Fits(const Tried& tried) const {
    return std::ranges::all_of(
        tried.costs, [&](const PlatformCost& cost) { return cost.frame_ns <= request_.target_ns; });
  }
  uint64_t ErrorOf(const Purchases::Choice& choice) const {
    uint64_t sum = 0;
    for (size_t l = 0; l < choice.size(); ++l) sum += purchases_.layers()[l][choice[l]].error;
    return sum;
  }

  // Core time that layers may have for the target, if frames are to core time as in this plan.
  Purchases::Costs Estimate(const Tried& tried) const {
    Purchases::Costs budget;
    for (const PlatformCost& cost : tried.costs) {
      const uint64_t all =
          request_.target_ns * cost.CoreNs() / std::max<uint64_t>(cost.frame_ns, 1);
      budget.push_back(all - std::min(all, cost.rest_ns));
    }
    return budget;
  }

  // The most that fit; the fewest where those do not.
  Tried WithFewerStrands(const Purchases::Choice& cheapest) {
    uint32_t fits = kFewestStrands, over = kAllStrands;
    if (!Fits(Price(cheapest, fits))) return Price(cheapest, fits);
    while (over - fits > 1) {
      const uint32_t middle = (fits + over) / 2;
      (Fits(Price(cheapest, middle)) ? fits : over) = middle;
    }
    return Price(cheapest, fits);
  }

  Tried Search() {
    const Purchases::Costs targets(request_.platforms.size(), request_.target_ns);
    const Purchases::Choice cheapest = purchases_.Cheapest(targets);
    Tried best = Price(cheapest);
    if (!best.refusal.empty()) throw Error(best.refusal);
    if (!Fits(best)) return WithFewerStrands(cheapest);
    Purchases::Costs most(targets.size(), ~0ull);  // less than what was too much
    Purchases::Costs budget = Estimate(best);
    while (tried_.size() < kMostPlans) {
      const std::vector<Purchase> bought = purchases_.Fill(cheapest, budget);
      const size_t known = tried_.size();
      const Tried& tried = PriceWhatRuns(cheapest, bought);
      if (tried_.size() == known) break;
      const Purchases::Costs spent = purchases_.CostOf(tried.choice);
      budget = Estimate(tried);
      for (size_t p = 0; p < budget.size(); ++p) {
        if (tried.costs[p].frame_ns > request_.target_ns)
          most[p] = std::min(most[p], spent[p] - std::min<uint64_t>(spent[p], 1));
        budget[p] = std::min(budget[p], most[p]);
      }
      if (Fits(tried) && ErrorOf(tried.choice) < ErrorOf(best.choice)) best = tried;
    }
    return best;
  }

  void MeasurePlan(SceneFit& fit, const Tried& best) const {
    std::vector<Scenario> plan = {Planned(best)};
    const auto errors = MeasureTipErrors(scene_, plan, ErrorFramesOf("error of the plan"));
    for (size_t l = 0; l < fit.layers.size(); ++l) fit.layers[l].error = errors[0][l];
    fit.error = errors[0].back();
  }

  void AddNext(const Tried& best, SceneFit& fit) const {
    const auto next = purchases_.Next(best.choice, Estimate(best));
    if (!next) return;
    const LayerOptions& options = purchases_.layers()[next->layer];
    const LayerOption &from = options[best.choice[next->layer]], &to = options[next->option];
    std::string tier = NameOf(to.tier);
    if (from.level != to.level)
      tier += fmt::format(" with {} of its chains", ChainShareOf(to.level));
    fit.next = {.layer = next->layer,
                .tier = tier,
                .less_px = 1e-6 * (double(from.micropixels) - double(to.micropixels)),
                .more_ms = {}};
    for (size_t p = 0; p < fit.costs.size(); ++p)
      fit.next->more_ms.push_back(fit.LayerMs(p, to.ns[p]) - fit.LayerMs(p, from.ns[p]));
  }

  const Scenario& scene_;
  const FitRequest& request_;
  const std::vector<LayerChoice> layers_;
  const std::vector<const LayerParams*> params_;
  std::vector<std::string> notes_;
  Purchases purchases_;
  std::deque<Tried> tried_;
};

}  // namespace

uint64_t PlatformCost::CoreNs() const {
  return std::accumulate(layer_ns.begin(), layer_ns.end(), rest_ns);
}

bool SceneFit::Fits() const {
  for (size_t p = 0; p < costs.size(); ++p)
    if (!Fits(p)) return false;
  return true;
}

double SceneFit::LayerMs(size_t platform, uint64_t core_ns) const {
  const PlatformCost& cost = costs[platform];
  return 1e-6 * double(core_ns) * double(cost.frame_ns) /
         double(std::max<uint64_t>(cost.CoreNs(), 1));
}

std::vector<LayerChoice> SceneFit::Plan() const {
  std::vector<LayerChoice> plan;
  for (const Layer& layer : layers)
    if (layer.choice.choice != SimulationChoice{}) plan.push_back(layer.choice);
  return plan;
}

SceneFit FitScene(const Scenario& scene, const FitRequest& request) {
  return SceneFitter(scene, request).Find();
}

}  // namespace pelt
