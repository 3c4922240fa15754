#include <fmt/format.h>

#include <limits>

#include "bench/accuracy/report/accuracy_report.hpp"

namespace pelt {

using namespace accuracy;

namespace {

constexpr SceneTime kFrame = &ScenePrecisionRow::frame_ns;
constexpr SceneTime kSimulate = &ScenePrecisionRow::simulate_ns;

void AddHead(const ScenePrecision& t, ReportTree& tree) {
  const ScenePrecisionOptions& o = t.options;
  tree.Add({"scene"}, t.scene).Add({"strands"}, t.strands).Add({"layers"}, t.layers);
  tree.Add({"frames"}, o.frames)
      .Add({"frames_per_second", "", -4, "a second"}, t.frames_per_second);
  tree.Add({"warm_up_frames", "", -1, "of them to warm up"}, t.warm_up);
  tree.Add({"still_frames"}, o.still_frames).Add({"contact", "", -1, "contacts"}, o.contact);
  tree.Say(fmt::format(
      "Dry, nothing culled. Error: part of the secondary motion that is wrong, over all strands, "
      "points and frames; 100 %: no better than no simulation. Measured against modal best at {} "
      "times the rate. The secondary motion is {:.2f} mm (RMS). Front: no way as cheap is more "
      "exact, f: as the whole frame, s: as the simulation (wind and solver). ~: another material, "
      "the artist's PBD or Verlet parameters as they stand: the figure says how different the "
      "motion is, not how wrong, and is never Pareto-optimal; nor does sleeping, which goes "
      "with every way. own: the same against a chain for each strand, for scenes that have "
      "chains at mesh vertices which strands follow. off its rod: a sample of strands, without "
      "contact, wind and clumps, against the elastic rods they stand for.",
      o.reference_rate, 1e3 * t.secondary_m));
}

std::string Mark(const ScenePrecision& t, const ScenePrecisionRow& row) {
  if (!row.way.OnReferenceMaterial()) return "~";
  return std::string(t.IsParetoOptimal(row, kFrame) ? "f" : "") +
         (t.IsParetoOptimal(row, kSimulate) ? "s" : "");
}

// What the diagram gives one colour.
std::string_view FamilyOf(const SceneWay& way) {
  if (!way.simulate) return "no simulation";
  if (way.strand_share < 1.0) return "LOD";
  if (way.sleep) return "sleeping";
  if (way.solver == Solver::kPbd) return "PBD";
  if (way.solver == Solver::kVerlet) return "Verlet";
  return "modal";
}

void AddRods(const SceneRodErrors& rods, ReportTree& tree) {
  tree.Add(InJson("rod_self_error"), rods.self_error);
  tree.Add(InJson("rod_secondary_motion_m"), rods.secondary_m);
  ReportTable& layers = tree.AddTable("rod_layers", {{"layer"},
                                                     {"way", "", -1, "as it is set up"},
                                                     {"strands"},
                                                     {"sampled"},
                                                     {"rod_error", "rod, %", -3, "off its", 100}});
  for (const RodLayerRow& row : rods.layers)
    layers.Add({row.layer, row.way, row.strands, row.sampled, row.error});
  if (rods.layers.empty()) return;
  layers.Add({"rods in steps twice as long", {}, {}, {}, rods.self_error}, Show::kText);
}

double WithinOf(const TipRow& row) { return double(row.within) / double(row.tips); }

// In text the worst layer stands for all of them.
void AddTips(const ScenePrecision& t, ReportTree& tree) {
  ReportTable& ways = tree.AddTable("tips", {{"way"},
                                             {"tips"},
                                             {"p99", "% of length", -3, "99 % of tips off", 100},
                                             {"within", "%", 2, "within its bound", 100},
                                             InText("worst layer's", "% of length", -3),
                                             InText("worst layer")});
  for (const TipRow& row : t.tips) {
    const TipRow* worst = nullptr;
    for (const TipRow& layer : t.layer_tips)
      if (layer.way == row.way && (!worst || layer.p99 > worst->p99)) worst = &layer;
    ways.Add({row.way, row.tips, row.p99, WithinOf(row), 100.0 * worst->p99,
              fmt::format("layer {} {}", worst->layer, worst->name)});
  }
  ReportTable layers{.key = {},
                     .columns = {{"way"}, {"layer"}, {"character"}, {"tips"}, {"p99"}, {"within"}}};
  for (const TipRow& row : t.layer_tips)
    layers.Add({row.way, fmt::format("layer {} {}", row.layer, row.name),
                fmt::format("character {}", row.character), row.tips, row.p99, WithinOf(row)});
  tree.Add(InJson("layer_tips"), std::move(layers));
}

void AddRows(const ScenePrecision& t, ReportTree& tree) {
  ReportTable& rows = tree.AddTable("rows", {InJson("way"),
                                             InJson("family"),
                                             {"label", "", -1, "way"},
                                             InText("front"),
                                             {"frame_ns", "ns", 1, "frame"},
                                             {"frame_of_pbd", "PBD", 2, "of"},
                                             {"simulate_ns", "ns", 1, "simul."},
                                             {"simulate_of_pbd", "PBD", 2, "of"},
                                             {"error", "%", -3, "", 100},
                                             {"own_error", "%", -3, "own", 100},
                                             {"off_m", "mm", 3, "off", 1000},
                                             {"live_share", "%", 0, "live", 100},
                                             InJson("rod_error"),
                                             InJson("simulate_runs"),
                                             InJson("reference_material"),
                                             InJson("simulate_pareto_optimal"),
                                             InJson("frame_pareto_optimal"),
                                             InJson("points_digest")});
  if (!t.rods.layers.empty()) rows.columns.push_back(InText("off its", "rod, %", -3));
  for (const ScenePrecisionRow& row : t.rows) {
    rows.Add({row.way.name, FamilyOf(row.way), row.way.label, Mark(t, row), row.frame_ns,
              row.frame_of_pbd, row.simulate_ns, row.of_pbd, row.error, row.own_error, row.off_m,
              row.live_share, row.rod_error.value_or(std::numeric_limits<double>::quiet_NaN()),
              row.simulate_runs, row.way.OnReferenceMaterial(), t.IsParetoOptimal(row, kSimulate),
              t.IsParetoOptimal(row, kFrame), DigestText(row.points_digest)});
    if (row.rod_error) rows.rows.back().values.push_back(100.0 * *row.rod_error);
  }
  rows.Add({{},
            {},
            fmt::format("reference at {} times the rate", t.options.reference_rate / 2),
            {},
            {},
            {},
            {},
            {},
            t.self_error},
           Show::kText);
  if (t.has_vertex_chains)
    rows.Add({{}, {}, "reference, chains at vertices", {}, {}, {}, {}, {}, {}, t.chain_error},
             Show::kText);
  tree.AddTexts("notes", t.notes);
  AddRods(t.rods, tree);
  AddTips(t, tree);
}

void AddFindings(const ScenePrecision& t, ReportTree& tree) {
  ReportTable& picks = tree.AddTable({}, {InText("picks one"), InText("simulation", "ns", 1),
                                          InText("of PBD", "", 2), InText("wrong", "%", -3)});
  for (const char* name : {"fast", "fine", "best"})
    if (const ScenePrecisionRow* row = t.Find(name))
      picks.Add(
          {fmt::format("--quality {}", name), row->simulate_ns, row->of_pbd, 100.0 * row->error});
  const ScenePrecisionRow *halved = t.Find("fine-halved"), *fast = t.Find("fast");
  tree.BlankLine();
  if (halved && fast)
    tree.Say(fmt::format(
        "Every second frame at the default has steps as long as fast in every frame: {:.1f} ns and "
        "{:.3g} % against {:.1f} ns and {:.3g} %. What a frame costs besides its steps is saved as "
        "well; the poses between are not seen. Carrying strands with the skin in the other frames "
        "is not in its time.",
        halved->simulate_ns, 100.0 * halved->error, fast->simulate_ns, 100.0 * fast->error));
  const ScenePrecisionRow *sleep = t.Find("fine-sleep"), *awake = t.Find("fine");
  if (!sleep || !awake) return;
  tree.Say(fmt::format(
      "Sleeping: {:.3g} s of motion, then {:.3g} s of stillness, which count in its time: {:.0f} % "
      "of the simulation is run.",
      (t.options.frames - t.warm_up) / t.frames_per_second,
      t.options.still_frames / t.frames_per_second,
      100.0 * sleep->simulate_runs / awake->simulate_runs));
  tree.Say(sleep->points_digest == awake->points_digest
               ? "Sleeping gives the same bits as awake in every frame."
               : "Sleeping gives NOT THE SAME BITS as awake.");
}

}  // namespace

ReportTree MakeSceneTree(const SceneReport& report) {
  const ScenePrecision& t = report.table;
  ReportTree tree;
  tree.Add(InJson("format"), kSceneAccuracyFormat);
  AddHead(t, tree);
  AddRows(t, tree);
  AddFindings(t, tree);
  tree.BlankLine();
  AddMachine(report.machine, tree);
  tree.EndLine();
  tree.Add({"isa", "", -1, "one core, kernels"}, IsaName(t.options.isa));
  tree.Add({"rounds", "", -1, "fastest of rounds"}, t.options.rounds);
  tree.Say(
      "ns per strand of the scene and frame; all ways frame by frame in turn; the clock is "
      "read round every stage, about 3 % of the frame");
  tree.Add(InJson("quick"), t.options.quick);
  tree.Add(InJson("reference_rate"), t.options.reference_rate);
  tree.Add(InJson("reference_self_error"), t.self_error);
  tree.Add(InJson("vertex_chain_error"), t.chain_error);
  tree.Add(InJson("secondary_motion_m"), t.secondary_m);
  tree.Add({"error_digest", "", -1, "digest of the errors"}, DigestText(t.error_digest));
  tree.Add({"seconds", "s", 1, "took"}, report.seconds);
  return tree;
}

}  // namespace pelt
