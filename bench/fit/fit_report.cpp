#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/fit/fit_scene.hpp"

namespace pelt {
namespace {

double Px(const TipError& error) { return 1e-6 * error.p99_micropixels; }

Value Word(auto LayerParams::*param, const auto& value) {
  return value ? Value(LayerParamEntryOf(param).words[size_t(*value)]) : Value();
}

// Of the table of layers: each platform has a column for a layer's part of its frame.
std::vector<Quantity> Columns(const SceneFit& fit) {
  std::vector<Quantity> columns = {{"character"},
                                   {"layer"},
                                   {"tier"},
                                   InJson("solver"),
                                   InJson("quality"),
                                   InJson("curl_follows"),
                                   {"chain_share", "", 3, "chains"},
                                   {"strands"}};
  for (const std::string& platform : fit.platforms)
    columns.push_back({"ms." + platform, "ms", 3, platform});
  columns.push_back({"off_mm", "mm RMS", 2, "off"});
  columns.push_back({"p99_px", "px 99 %", 2, "off on screen"});
  return columns;
}

void AddLayers(const SceneFit& fit, ReportTree& tree) {
  ReportTable& table = tree.AddTable("layers", Columns(fit));
  for (size_t l = 0; l < fit.layers.size(); ++l) {
    const SceneFit::Layer& layer = fit.layers[l];
    const SimulationChoice& choice = layer.choice.choice;
    std::vector<Value> row = {layer.choice.character,
                              layer.choice.name,
                              layer.tier,
                              Word(&LayerParams::solver, choice.solver),
                              Word(&LayerParams::quality, choice.quality),
                              Word(&LayerParams::curl_follows, choice.curl_follows),
                              choice.chain_share ? Value(*choice.chain_share) : Value(),
                              layer.strands};
    for (size_t p = 0; p < fit.costs.size(); ++p)
      row.push_back(fit.LayerMs(p, fit.costs[p].layer_ns[l]));
    // Nothing of it is simulated.
    row.push_back(layer.error.tips ? Value(1e3 * layer.error.off_m) : Value());
    row.push_back(layer.error.tips ? Value(Px(layer.error)) : Value());
    table.Add(std::move(row));
  }
  const auto add = [&](const char* what, const auto& ms_of) {
    std::vector<Value> row = {{}, what, {}, {}, {}, {}, {}, {}};
    for (size_t p = 0; p < fit.costs.size(); ++p) row.push_back(ms_of(p));
    row.insert(row.end(), 2, Value());
    table.Add(std::move(row), Show::kText);
  };
  add("poses, layers' order", [&](size_t p) { return fit.LayerMs(p, fit.costs[p].rest_ns); });
  add("sum: the frame", [&](size_t p) { return 1e-6 * double(fit.costs[p].frame_ns); });
}

void AddPlatforms(const SceneFit& fit, ReportTree& tree) {
  const double target_ms = 1e-6 * double(fit.target_ns);
  for (size_t p = 0; p < fit.platforms.size(); ++p) {
    const double frame_ms = 1e-6 * double(fit.costs[p].frame_ns);
    ReportTree& entry = tree.AddEntry("platforms");
    entry.Add(InJson("platform"), fit.platforms[p]).Add(InJson("frame_ms"), frame_ms);
    entry.Add(InJson("rest_ms"), fit.LayerMs(p, fit.costs[p].rest_ns));
    entry.Add(InJson("fits"), fit.Fits(p));
    entry.Say(
        fit.Fits(p)
            ? fmt::format("{}: FITS {:.6g} ms: {:.3f} ms", fit.platforms[p], target_ms, frame_ms)
            : fmt::format("{}: DOES NOT FIT {:.6g} ms: the least that fits is {:.3f} ms",
                          fit.platforms[p], target_ms, frame_ms));
  }
}

void AddNext(const SceneFit& fit, ReportTree& tree) {
  if (!fit.next) return;
  const SceneFit::Step& next = *fit.next;
  const LayerChoice& layer = fit.layers[next.layer].choice;
  ReportTree& section = tree.AddSection("next");
  section.Add(InJson("character"), layer.character).Add(InJson("layer"), layer.name);
  section.Add(InJson("tier"), next.tier).Add(InJson("less_px"), next.less_px);
  std::vector<std::string> more;
  for (size_t p = 0; p < fit.platforms.size(); ++p) {
    section.Add(InJson("more_ms." + fit.platforms[p]), next.more_ms[p]);
    more.push_back(fmt::format("{:+.3f} ms on {}", next.more_ms[p], fit.platforms[p]));
  }
  section.Say(fmt::format("next: {} of character {} to {}, for about {}: {:+.3f} px", layer.name,
                          layer.character, next.tier, fmt::join(more, ", "), -next.less_px));
}

}  // namespace

ReportTree MakeFitTree(const SceneFit& fit) {
  ReportTree tree;
  tree.Add(InJson("scene"), fit.scene).Add(InJson("target_ms"), 1e-6 * double(fit.target_ns));
  tree.Add(InJson("frames"), fit.frames).Add(InJson("warm_up_frames"), fit.warm_up);
  tree.Add(InJson("plans_priced"), fit.plans_priced);
  tree.Say(fmt::format("{}: {} layers; {} frames behind {} to warm up", fit.scene,
                       fit.layers.size(), fit.frames, fit.warm_up));
  AddLayers(fit, tree);
  tree.Say(
      "A layer's ms are its part of the frame, by core time; off: its tips from where the modal "
      "solver has them at its best, with four frames for one.");
  tree.AddTexts("notes", fit.notes, "note");
  tree.Add(InJson("strand_share"), fit.strand_share);
  if (fit.strand_share < 1.0f)
    tree.Say(
        fmt::format("{:.4g} % of the strands: with all of them not even the cheapest plan fits",
                    100.0f * fit.strand_share));
  AddPlatforms(fit, tree);
  tree.Add(InJson("fits"), fit.Fits());
  AddNext(fit, tree);
  tree.Add(InJson("measured.off_mm"), 1e3 * fit.error.off_m);
  tree.Add(InJson("measured.p99_px"), Px(fit.error));
  tree.Say(fmt::format(
      "measured of exactly this plan: tips are {:.3f} mm off (RMS), 99 % of those in view at most "
      "{:.3f} px",
      1e3 * fit.error.off_m, Px(fit.error)));
  return tree;
}

}  // namespace pelt
