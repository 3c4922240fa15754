#include "bench/fit/fit_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <numeric>

#include "bench/fit/purchases.hpp"
#include "bench/fit/tiers.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

// Of plans that are tried. Each costs seconds; estimates are good to some percent, and what cannot run is
// found by halves.
constexpr uint32_t kMostPlans = 48;
constexpr uint32_t kOwn = ~0u;  // in place of a tier

class SceneFitter {
 public:
  SceneFitter(const Scenario& scene, const FitRequest& request)
      : scene_(scene),
        request_(request),
        layers_(ListLayers(scene)),
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
    fit.notes = notes_;
    fit.plans_priced = uint32_t(tried_.size());
    for (uint32_t l = 0; l < layers_.size(); ++l) {
      SceneFit::Layer& layer = fit.layers.emplace_back();
      const uint32_t tier = TierOf(best.choice, l);
      layer.choice = ChoiceOf(l, tier);
      layer.tier = NameOf(tier);
      layer.strands = best.costs[0].live_strands[l];
    }
    MeasurePlan(fit, best);
    if (fit.Fits()) AddNext(best, fit);
    return fit;
  }

 private:
  struct Tried {
    Purchases::Choice choice;
    std::vector<PlatformCost> costs = {};
    std::string refusal = {};
  };

  void Say(const std::string& now) const {
    if (request_.progress) request_.progress(now);
  }
  static std::string NameOf(uint32_t tier) {
    return tier == kOwn ? "own" : std::string(Tiers()[tier].name);
  }
  uint32_t TierOf(const Purchases::Choice& choice, uint32_t layer) const {
    return purchases_.layers()[layer][choice[layer]].tier;
  }
  LayerChoice ChoiceOf(uint32_t layer, uint32_t tier) const {
    LayerChoice choice = layers_[layer];
    if (tier != kOwn) choice.choice = Tiers()[tier].choice;
    return choice;
  }

  using PriceFunction = std::function<PlatformCost(Scenario&)> FitPlatform::*;
  std::vector<PlatformCost> PriceOn(PriceFunction price, Scenario& scenario,
                                    const std::string& what) const {
    std::vector<PlatformCost> costs;
    for (const FitPlatform& platform : request_.platforms) {
      Say(fmt::format("{}: {}", platform.name, what));
      costs.push_back((platform.*price)(scenario));
    }
    return costs;
  }

  // Every tier on every layer that can have it.
  std::vector<LayerOptions> MeasureOptions() {
    std::vector<Scenario> ways;
    std::vector<uint32_t> tiers;
    std::vector<std::vector<bool>> has;
    std::vector<std::vector<PlatformCost>> costs;
    for (uint32_t t = 0; t < Tiers().size(); ++t) {
      std::vector<bool> has_it;
      Scenario way = AtTier(scene_, Tiers()[t], has_it);
      if (std::ranges::count(has_it, true) == 0) continue;
      costs.push_back(PriceOn(&FitPlatform::price_layers, way, NameOf(t)));
      ways.push_back(std::move(way));
      tiers.push_back(t);
      has.push_back(std::move(has_it));
    }
    if (ways.empty())
      throw Error(fmt::format("{}: no layer can be simulated in another way", scene_.name));
    const auto errors = MeasureTipErrors(scene_, ways, ErrorFramesOf("errors"));
    std::vector<LayerOptions> options(layers_.size());
    for (size_t l = 0; l < layers_.size(); ++l) {
      const auto add = [&](size_t way, uint32_t tier) {
        LayerOption& option = options[l].emplace_back();
        option.tier = tier;
        option.error = uint64_t(errors[way][l].p99_micropixels) * costs[0][0].live_strands[l];
        for (const PlatformCost& cost : costs[way]) option.ns.push_back(cost.layer_ns[l]);
      };
      for (size_t w = 0; w < ways.size(); ++w)
        if (has[w][l] && errors[w][l].tips > 0) add(w, tiers[w]);
      if (options[l].empty()) add(0, kOwn);
    }
    errors_.assign(Tiers().size(), {});
    for (size_t w = 0; w < ways.size(); ++w) errors_[tiers[w]] = errors[w];
    return options;
  }

  ErrorFrames ErrorFramesOf(const char* what) const {
    return {.warm_up = request_.warm_up,
            .frames = request_.frames,
            .progress = [this, what](uint32_t done, uint32_t total) {
              Say(fmt::format("{}: frame {} of {}", what, done, total));
            }};
  }

  Scenario Planned(const Purchases::Choice& choice) const {
    std::vector<LayerChoice> plan;
    for (uint32_t l = 0; l < layers_.size(); ++l) plan.push_back(ChoiceOf(l, TierOf(choice, l)));
    Scenario scenario = scene_;
    ApplyLayerPlan(plan, "plan", scenario);
    return scenario;
  }

  // Without costs: it cannot run. References stay good.
  const Tried& Price(const Purchases::Choice& choice) {
    const auto known = std::ranges::find(tried_, choice, &Tried::choice);
    if (known != tried_.end()) return *known;
    Scenario scenario = Planned(choice);
    Tried& tried = tried_.emplace_back(Tried{choice});
    try {
      const std::string what = fmt::format("plan {}", tried_.size());
      tried.costs = PriceOn(&FitPlatform::price, scenario, what);
    } catch (const Error& error) {
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

  Tried Search() {
    const Purchases::Costs targets(request_.platforms.size(), request_.target_ns);
    const Purchases::Choice cheapest = purchases_.Cheapest(targets);
    Tried best = Price(cheapest);
    if (!best.refusal.empty()) throw Error(best.refusal);
    if (!Fits(best)) return best;
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
    std::vector<Scenario> plan = {Planned(best.choice)};
    const auto errors = MeasureTipErrors(scene_, plan, ErrorFramesOf("error of the plan"));
    for (size_t l = 0; l < fit.layers.size(); ++l) fit.layers[l].error = errors[0][l];
    fit.error = errors[0].back();
  }

  void AddNext(const Tried& best, SceneFit& fit) const {
    const auto next = purchases_.Next(best.choice, Estimate(best));
    if (!next) return;
    const LayerOptions& options = purchases_.layers()[next->layer];
    const LayerOption &from = options[best.choice[next->layer]], &to = options[next->option];
    const auto px = [&](const LayerOption& option) {
      return 1e-6 * double(errors_[option.tier][next->layer].p99_micropixels);
    };
    fit.next = {
        .layer = next->layer, .tier = NameOf(to.tier), .less_px = px(from) - px(to), .more_ms = {}};
    for (size_t p = 0; p < fit.costs.size(); ++p)
      fit.next->more_ms.push_back(fit.LayerMs(p, to.ns[p]) - fit.LayerMs(p, from.ns[p]));
  }

  const Scenario& scene_;
  const FitRequest& request_;
  const std::vector<LayerChoice> layers_;
  std::vector<std::string> notes_;
  std::vector<std::vector<TipError>> errors_;  // [tier][layer]; empty: no layer has the tier
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
