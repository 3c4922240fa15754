// `pelt accuracy` and `pelt stress` as commands: files they write, the section of the report that
// reads one of them, exit codes. What is measured is tested in tests/accuracy.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "bench/accuracy/report/accuracy_report.hpp"
#include "bench/command/accuracy_args.hpp"
#include "bench/command/commands.hpp"
#include "core/error.hpp"
#include "core/groom/fur_setup.hpp"
#include "tests/test_folder.hpp"

namespace pelt {
namespace {

using Json = nlohmann::ordered_json;

AccuracyReport SmallReport() {
  AccuracyReport report;
  accuracy::WorkPrecisionOptions options;
  options.links = {3};
  options.rates = {30, 60};
  options.presets = {accuracy::kPresets[1], accuracy::kPresets[2]};
  options.quick = true;
  report.table = accuracy::MeasureWorkPrecision(options);
  report.model_options.families = {accuracy::MotionFamily::kEveryday,
                                   accuracy::MotionFamily::kWind};
  report.model_options.presets = options.presets;
  report.model_options.problems = 1;
  report.model_options.seconds = 0.6;
  report.model_options.isa = options.isa;
  report.model_options.timing = accuracy::TableTiming(true);
  report.model_error = accuracy::MeasureModelError(report.model_options);
  report.pendulum = {{*accuracy::FindSolver("modal-fine"), 1e-3, 10.0, 0.2}};
  report.machine = {"a <processor>", 2, "compiler", "type", "commit"};
  return report;
}
const AccuracyReport& SharedReport() {
  static const AccuracyReport report = SmallReport();
  return report;
}

size_t Count(const std::string& text, const std::string& what) {
  size_t count = 0;
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++count;
  return count;
}

TEST(AccuracyReport, JsonHoldsTheTable) {
  const AccuracyReport& report = SharedReport();
  const Json json = Json::parse(MakeAccuracyTree(report).Json());
  EXPECT_EQ(json["format"], kAccuracyFormat);
  EXPECT_EQ(json["rates"], Json::parse("[30, 60]"));
  EXPECT_EQ(json["problems"], "drawn");
  EXPECT_EQ(json["seed"], accuracy::kDrawnSeed);
  const auto& shipped = report.table.shipped.at(0).rows;
  ASSERT_EQ(json["shipped"][0]["rows"].size(), shipped.size());
  for (size_t r = 0; r < shipped.size(); ++r) {
    const Json &row = json["shipped"][0]["rows"][r], &score = row["scores"][1];
    EXPECT_EQ(row["solver"], shipped[r].solver.name);
    EXPECT_EQ(row["velocities"], shipped[r].solver.velocities);
    EXPECT_EQ(score["rms"], shipped[r].scores[1].error);
    EXPECT_EQ(score["median"], shipped[r].scores[1].Median());
    EXPECT_EQ(score["worst_case"], shipped[r].scores[1].WorstCase());
  }
  ASSERT_EQ(json["panels"].size(), 2u);
  for (size_t p = 0; p < 2; ++p) {
    const accuracy::WorkPrecisionPanel& panel = report.table.panels[p];
    EXPECT_EQ(json["panels"][p]["preset"], p == 0 ? "soft" : "medium");
    ASSERT_EQ(json["panels"][p]["rows"].size(), panel.rows.size());
    for (size_t r = 0; r < panel.rows.size(); ++r) {
      const Json& row = json["panels"][p]["rows"][r];
      EXPECT_EQ(row["solver"], panel.rows[r].solver.name);
      EXPECT_EQ(row["ns"], panel.rows[r].ns);
      EXPECT_EQ(row["scores"][1]["rate"], 60);
      EXPECT_EQ(row["scores"][1]["error"], panel.rows[r].scores[1].error);
      EXPECT_EQ(row["scores"][1]["pareto_optimal"], panel.IsParetoOptimal(panel.rows[r], 1));
    }
  }
}

// Rows of every family, the rivals' and the rod's own among them.
TEST(AccuracyReport, JsonBeginsWithTheRod) {
  const AccuracyReport& report = SharedReport();
  const std::string text = MakeAccuracyTree(report).Json();
  EXPECT_LT(text.find("model_error"), text.find("shipped"));
  const Json json = Json::parse(text);
  ASSERT_EQ(json["model_error"].size(), 2u);
  for (size_t f = 0; f < 2; ++f) {
    const accuracy::ModelErrorPanel& panel = report.model_error.panels[f];
    const Json& rows = json["model_error"][f]["rows"];
    EXPECT_EQ(json["model_error"][f]["motion"], f == 0 ? "everyday" : "wind");
    ASSERT_EQ(rows.size(), panel.rows.size());
    std::set<std::string> movers, models;
    for (size_t r = 0; r < rows.size(); ++r) {
      EXPECT_EQ(rows[r]["pooled"], accuracy::PooledError(panel.rows[r], report.model_options));
      EXPECT_EQ(rows[r]["presets"][1]["median"], panel.rows[r].errors[1][0]);
      EXPECT_EQ(rows[r]["ns"] > 0.0, rows[r]["moved"] != "exactly");
      movers.insert(rows[r]["moved"]);
      models.insert(rows[r]["model"]);
    }
    for (const char* mover : {"exactly", "modal", "modal-fine", "modal-best", "pbd-4", "verlet-4",
                              "textbook-pbd-4", "xpbd-8", "trapezoid-2"})
      EXPECT_TRUE(movers.contains(mover)) << mover;
    for (const char* model : {"3 nodes", "4 nodes", "3 links", "4 links", "rod, 8 nodes"})
      EXPECT_TRUE(models.contains(model)) << model;
  }
}

TEST(AccuracyReport, TextNamesAllThatWasMeasured) {
  const std::string text = MakeAccuracyTree(SharedReport()).Text();
  for (const char* part :
       {"soft, 3 links", "medium, 3 links", "30 Hz", "60 Hz", "modal, best", "a <processor>",
        "commit", "digest", "default layer", "modal, velocities", "drawn from seed 20261123",
        "Off the rod, everyday motions", "Off the rod, wind motions", "rod, half steps"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
  for (const accuracy::WorkPrecisionRow& row : SharedReport().table.panels[0].rows)
    EXPECT_GE(Count(text, row.solver.label), 2u) << row.solver.label;
}

// The length that a setup gives a layer stands in code that knows no setups.
TEST(ShippedLayer, IsThatOfASetupThatSaysNothing) {
  const accuracy::Preset layer = accuracy::DefaultLayer(3);
  const LayerSetup setup;
  EXPECT_FLOAT_EQ(float(layer.length), setup.length.value);
  EXPECT_FLOAT_EQ(float(layer.drag), setup.params.velocity_damping);
  EXPECT_NEAR(layer.frequency, 3.87, 0.01);
}

std::string SectionMessage(const std::string& text) {
  try {
    JsonText json;
    AddAccuracySection(json, text, "a.json");
    return Json::parse(json.text()).is_object() ? "no error" : "not an object";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(AccuracySection, PassesOnWhatThePageDraws) {
  const std::string text = MakeAccuracyTree(SharedReport()).Json();
  JsonText json;
  AddAccuracySection(json, text, "a.json");
  const Json section = Json::parse(json.text()), file = Json::parse(text);
  EXPECT_EQ(section["panels"].size(), 2u);
  EXPECT_EQ(section["shipped"][0]["rows"][2]["scores"][1]["worst_case"],
            file["shipped"][0]["rows"][2]["scores"][1]["worst_case"]);
  EXPECT_EQ(section["panels"][1]["rows"][3]["scores"][0]["error"],
            file["panels"][1]["rows"][3]["scores"][0]["error"]);
  EXPECT_EQ(section["error_digest"], file["error_digest"]);
  EXPECT_EQ(section["processor"], "a <processor>");
  ASSERT_EQ(section["model_error"].size(), file["model_error"].size());
  for (const auto& [key, value] : section["model_error"][1]["rows"][4].items()) {
    if (key != "presets") {
      EXPECT_EQ(value, file["model_error"][1]["rows"][4][key]) << key;
    }
  }
}

// Every member that is taken away or of another type is missed, or was not needed.
TEST(AccuracySection, RefusesOtherFiles) {
  const Json good = Json::parse(MakeAccuracyTree(SharedReport()).Json());
  EXPECT_EQ(SectionMessage(good.dump()), "no error");
  EXPECT_NE(SectionMessage("").find("a.json: not JSON"), std::string::npos);
  EXPECT_NE(SectionMessage("{\"traceEvents\": []}").find("a.json: is not of the format"),
            std::string::npos);
  EXPECT_NE(SectionMessage("[1, 2]").find("is not of the format"), std::string::npos);
  EXPECT_NE(SectionMessage(Json{{"format", kFeatureAccuracyFormat}}.dump())
                .find("a.json: is not of the format 'pelt accuracy 3' or 'pelt scene accuracy 2'"),
            std::string::npos);
  const std::string whole = good.dump();
  for (size_t cut : {size_t{1}, whole.size() / 2, whole.size() - 1})
    EXPECT_NE(SectionMessage(whole.substr(0, cut)).find("not JSON"), std::string::npos) << cut;
  for (const char* needed :
       {"isa", "rates", "panels", "rounds", "commit", "shipped", "seed", "model_error"}) {
    Json less = good;
    less.erase(needed);
    EXPECT_NE(SectionMessage(less.dump()).find(needed), std::string::npos) << needed;
    Json other = good;
    other[needed] = Json::object();
    EXPECT_NE(SectionMessage(other.dump()).find(needed), std::string::npos) << needed;
  }
  Json fewer = good;
  fewer["panels"][0]["rows"][2]["scores"].erase(1);
  EXPECT_NE(SectionMessage(fewer.dump()).find("scores"), std::string::npos);
  Json unnamed = good;
  unnamed["model_error"][1]["rows"][3].erase("moved");
  EXPECT_NE(SectionMessage(unnamed.dump()).find("'moved' is missing"), std::string::npos);
  Json text = good;
  text["panels"][0]["rows"][2]["ns"] = "fast";
  EXPECT_NE(SectionMessage(text.dump()).find("'ns' is not a number"), std::string::npos);
}

// ---- Scenes and features -----------------------------------------------------------------------

SceneReport SmallSceneReport() {
  SceneReport report;
  accuracy::ScenePrecisionOptions options;
  options.frames = 24;
  options.still_frames = 8;
  options.rounds = 1;
  report.table = accuracy::MeasureScenePrecision(LoadScenario("tiny"), options);
  // In the same order, but not what was measured: a busy machine's long numbers leave labels less room than they need
  // in one line.
  double ns = 100.0;
  for (accuracy::ScenePrecisionRow& row : report.table.rows) row.frame_ns = row.simulate_ns = ++ns;
  report.machine = {"a <processor>", 2, "compiler", "type", "commit"};
  return report;
}
const SceneReport& SharedSceneReport() {
  static const SceneReport report = SmallSceneReport();
  return report;
}

TEST(SceneReport, JsonHoldsTheTable) {
  const accuracy::ScenePrecision& table = SharedSceneReport().table;
  const Json json = Json::parse(MakeSceneTree(SharedSceneReport()).Json());
  EXPECT_EQ(json["format"], kSceneAccuracyFormat);
  EXPECT_EQ(json["scene"], "tiny");
  EXPECT_EQ(json["reference_self_error"], table.self_error);
  ASSERT_EQ(json["rows"].size(), table.rows.size());
  for (size_t r = 0; r < table.rows.size(); ++r) {
    const accuracy::ScenePrecisionRow& row = table.rows[r];
    EXPECT_EQ(json["rows"][r]["way"], row.way.name);
    EXPECT_EQ(json["rows"][r]["error"], row.error);
    EXPECT_EQ(json["rows"][r]["rod_error"], row.rod_error ? Json(*row.rod_error) : Json());
    EXPECT_EQ(json["rows"][r]["frame_ns"], row.frame_ns);
    EXPECT_EQ(json["rows"][r]["frame_pareto_optimal"],
              table.IsParetoOptimal(row, &accuracy::ScenePrecisionRow::frame_ns));
  }
}

TEST(SceneReport, HasNoColumnOfRodsWhereThereAreNone) {
  SceneReport report = SharedSceneReport();
  report.table.rods = {};
  for (accuracy::ScenePrecisionRow& row : report.table.rows) row.rod_error.reset();
  const ReportTree tree = MakeSceneTree(report);
  EXPECT_EQ(tree.Text().find("off its\n"), std::string::npos);
  const Json json = Json::parse(tree.Json());
  EXPECT_TRUE(json["rows"][0]["rod_error"].is_null());
  EXPECT_TRUE(json["rod_layers"].empty());
}

TEST(SceneReport, TextGoesFromCheapestToMostExact) {
  const SceneReport& report = SharedSceneReport();
  const std::string text = MakeSceneTree(report).Text();
  size_t at = 0;
  double last_ns = 0.0;
  for (const accuracy::ScenePrecisionRow& row : report.table.rows) {
    const size_t found = text.find("\n" + row.way.label + " ");
    ASSERT_NE(found, std::string::npos) << row.way.label;
    EXPECT_GT(found, at) << row.way.label;
    EXPECT_GE(row.frame_ns, last_ns);
    at = found;
    last_ns = row.frame_ns;
  }
  EXPECT_NE(text.find("off its\n"), std::string::npos);
  // PBD and Verlet, and their halves.
  EXPECT_EQ(Count(text.substr(text.find("\nway ")), "~"), 4u);
  for (const char* part : {"--quality fast", "--quality best", "the same bits as awake", "digest"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

// What the page draws of it; of its diagram, browser_test.sh.
TEST(AccuracySection, PassesOnTheWaysToRunAScene) {
  const std::string text = MakeSceneTree(SharedSceneReport()).Json();
  JsonText json;
  AddAccuracySection(json, text, "a.json");
  const Json section = Json::parse(json.text()), file = Json::parse(text);
  ASSERT_EQ(section["rows"].size(), file["rows"].size());
  for (const auto& [key, value] : section.items()) {
    if (key == "rows") continue;
    EXPECT_EQ(value, file[key]) << key;
  }
  std::set<std::string> families;
  for (size_t r = 0; r < file["rows"].size(); ++r) {
    families.insert(file["rows"][r]["family"]);
    for (const auto& [key, value] : section["rows"][r].items())
      EXPECT_EQ(value, file["rows"][r][key]) << key;
  }
  EXPECT_EQ(families,
            (std::set<std::string>{"no simulation", "LOD", "sleeping", "PBD", "Verlet", "modal"}));
}

// Every member that is passed on has to be there, and of its type.
TEST(AccuracySection, RefusesAFileThatLacksWhatAScenesDiagramNeeds) {
  const Json good = Json::parse(MakeSceneTree(SharedSceneReport()).Json());
  JsonText json;
  AddAccuracySection(json, good.dump(), "a.json");
  const Json shown = Json::parse(json.text());
  const auto expect_needed = [&](const Json& members, const std::string& pointer) {
    for (const auto& [key, value] : members.items()) {
      Json less = good, other = good;
      less.at(Json::json_pointer(pointer)).erase(key);
      EXPECT_NE(SectionMessage(less.dump()).find("a.json: '" + key + "' is missing"),
                std::string::npos)
          << key;
      other.at(Json::json_pointer(pointer))[key] = Json::object();
      EXPECT_NE(SectionMessage(other.dump()).find("a.json: '" + key + "' is n"), std::string::npos)
          << key;
    }
  };
  expect_needed(shown, "");
  expect_needed(shown["rows"][2], "/rows/2");
  Json unknown = good;
  unknown["rows"][1]["error"] = nullptr;  // not finite
  EXPECT_EQ(SectionMessage(unknown.dump()), "no error");
  unknown["rows"][1]["frame_ns"] = nullptr;
  EXPECT_NE(SectionMessage(unknown.dump()).find("'frame_ns' is not a number"), std::string::npos);
  Json notes = good;
  notes["notes"] = {"a note", 1};
  EXPECT_NE(SectionMessage(notes.dump()).find("'notes' is not a list of texts"), std::string::npos);
}

TEST(FeatureReport, HasBothChainsAndMarksPenetration) {
  FeatureReport report = MeasureFeatureReport(BestIsa(), {4}, true);
  ASSERT_EQ(report.chains.size(), 1u);
  const std::vector<accuracy::FeatureError>& rows = report.chains[0].rows;
  ASSERT_EQ(rows.size(), 3 * accuracy::FeatureProblems(4).size());
  const Json json = Json::parse(MakeFeatureTree(report).Json());
  EXPECT_EQ(json["format"], kFeatureAccuracyFormat);
  ASSERT_EQ(json["rows"].size(), rows.size());
  EXPECT_EQ(json["rows"][4]["links"], 4);
  EXPECT_EQ(json["rows"][4]["feature"], rows[4].name);
  EXPECT_EQ(json["rows"][4]["quality"], "fine");
  EXPECT_EQ(json["rows"][4]["error"], rows[4].error);
  EXPECT_EQ(json["rows"][4]["more_ns"], rows[4].nanoseconds);
  // Contact with a sphere has its own reference, that with the surface none.
  for (const Json& row : json["rows"]) {
    const std::string name = row["feature"];
    EXPECT_EQ(row.contains("contact_error"), name.find("sphere") != name.npos ||
                                                 name.find("capsule") != name.npos ||
                                                 name.find("ground") != name.npos)
        << name;
    EXPECT_EQ(row.contains("fastest"), name == "overlap" || name == "root inside") << name;
  }
  for (accuracy::FeatureError& row : report.chains[0].rows) row.penetration = 0.0;
  const std::string text = MakeFeatureTree(report).Text();
  EXPECT_EQ(Count(text, "\n       4  "), rows.size()) << text;
  EXPECT_EQ(Count(text, "\n!"), 0u) << text;
  report.chains[0].rows[4].penetration = 0.02;
  EXPECT_EQ(Count(MakeFeatureTree(report).Text(), "\n!"), 1u);
}

TEST(AccuracyCommand, RunsAScene) {
  const test::TestFolder folder;
  AccuracyArgs args;
  args.scene = {.scene = "tiny"};
  args.frames = 12;
  args.quick = true;
  args.contact = false;
  args.json = OutputPath::Of(folder / "scene.json");
  ASSERT_EQ(MeasureAccuracy(args), 0);
  const Json json = Json::parse(test::ReadText(args.json.path()));
  EXPECT_EQ(json["frames"], 12);
  EXPECT_EQ(json["contact"], false);
  EXPECT_EQ(SectionMessage(test::ReadText(args.json.path())), "no error");
  args.scene = {.scene = "nowhere"};
  EXPECT_THROW(MeasureAccuracy(args), Error);
}

TEST(StressCommand, WritesItsRows) {
  const test::TestFolder folder;
  StressArgs args;
  args.solvers = {"euler-1", "xpbd-8"};
  args.links = {3};
  args.rates = {60};
  args.isas = {BestIsa()};
  args.quick = true;
  args.json = OutputPath::Of(folder / "stress.json");
  EXPECT_EQ(StressSolvers(args), 0);
  const Json json = Json::parse(test::ReadText(args.json.path()));
  EXPECT_EQ(json["broken"], 0);
  ASSERT_GT(json["rows"].size(), 2u * 12);
  double worst = 0.0;
  for (const Json& row : json["rows"]) {
    EXPECT_EQ(row["links"], 3);
    EXPECT_FALSE(row["promised"]);
    if (row["solver"] == "euler-1") {
      EXPECT_LT(double(row["stretch"]), 1e-5);
    } else {
      worst = std::max(worst, double(row["stretch"]));
    }
  }
  EXPECT_GT(worst, 10.0);  // the teleport stretches XPBD
  args.solvers = {"magic"};
  EXPECT_THROW(StressSolvers(args), Error);
}

}  // namespace
}  // namespace pelt
