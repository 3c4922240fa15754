#include "bench/accuracy/report/accuracy_scene.hpp"

#include <fmt/format.h>

#include "bench/accuracy/report/accuracy_report.hpp"
#include "bench/report/json_text.hpp"

namespace pelt {

using namespace accuracy;

namespace {

void AddHead(const ScenePrecision& t, std::string& text) {
  const ScenePrecisionOptions& o = t.options;
  text += fmt::format(
      "Scene {}: {} strands in {} layers, {} frames at {:.4g} a second, {} of them to warm up; "
      "dry, "
      "nothing culled{}.\n"
      "Error: part of the secondary motion that is wrong, over all strands, points and frames; "
      "100 %: no better than\nno simulation. Measured against modal best at {} times the rate. The "
      "secondary motion is {:.2f} mm (RMS).\n"
      "*: no way as cheap (the whole frame; the simulation: wind and solver) is more exact.\n"
      "~: another material, the artist's PBD or Verlet parameters as they stand: the figure says "
      "how different the\nmotion is, not how wrong, and takes no part in the front; nor does "
      "sleeping, "
      "which goes with every way.\n",
      o.scene, t.strands, t.layers, o.frames, t.frames_per_second, t.warm_up,
      o.contact ? "" : ", without contacts", o.reference_rate, 1e3 * t.secondary_m);
}

void AddRows(const ScenePrecision& t, std::string& text) {
  constexpr SceneTime kFrame = &ScenePrecisionRow::frame_ns;
  constexpr SceneTime kSimulate = &ScenePrecisionRow::simulate_ns;
  text += fmt::format("\n  {:<40} {:>9} {:>7} {:>11} {:>7} {:>9} {:>9} {:>10}\n", "", "frame, ns",
                      "of PBD", "simul., ns", "of PBD", "error, %", "off, mm", "strands, %");
  for (const ScenePrecisionRow& row : t.rows)
    text += fmt::format(
        "  {:<40} {:>8.1f}{} {:>7.2f} {:>10.1f}{} {:>7.2f} {:>8}{} {:>9.3f} {:>10.0f}\n",
        row.way.label, row.frame_ns, t.OnFront(row, kFrame) ? '*' : ' ', row.frame_of_pbd,
        row.simulate_ns, t.OnFront(row, kSimulate) ? '*' : ' ', row.of_pbd, PercentText(row.error),
        row.way.OnReferenceMaterial() ? ' ' : '~', 1e3 * row.off_m, 100.0 * row.live_share);
  text +=
      fmt::format("  {:<40} {:>9} {:>7} {:>11} {:>7} {:>8}\n",
                  fmt::format("the reference at {} times the rate", t.options.reference_rate / 2),
                  "", "", "", "", PercentText(t.self_error));
  for (const std::string& note : t.notes) text += fmt::format("  {}\n", note);
}

void AddFindings(const ScenePrecision& t, std::string& text) {
  text += "\n--quality picks one:\n";
  for (const char* name : {"fast", "default", "best"})
    if (const ScenePrecisionRow* row = t.Find(name))
      text += fmt::format("  --quality {:<8} {:>6.1f} ns, {} of PBD, {:>6} % wrong\n", name,
                          row->simulate_ns, fmt::format("{:.2f}", row->of_pbd),
                          PercentText(row->error));
  const ScenePrecisionRow *halved = t.Find("default-halved"), *fast = t.Find("fast");
  if (halved && fast)
    text += fmt::format(
        "Every second frame at the default has steps as long as fast in every frame: {:.1f} ns and "
        "{} "
        "% against {:.1f} ns\nand {} %. What a frame costs besides its steps is saved as well; the "
        "poses between are not seen. Carrying strands\nwith the skin in the other frames is not in "
        "its time.\n",
        halved->simulate_ns, PercentText(halved->error), fast->simulate_ns,
        PercentText(fast->error));
  const ScenePrecisionRow *sleep = t.Find("default-sleep"), *awake = t.Find("default");
  if (sleep && awake)
    text += fmt::format(
        "Sleeping: {:.3g} s of motion, then {:.3g} s of stillness, which count in its time: {:.0f} "
        "% "
        "of the simulation is run,\nwith {}.\n",
        (t.options.frames - t.warm_up) / t.frames_per_second,
        t.options.still_frames / t.frames_per_second,
        100.0 * sleep->simulate_runs / awake->simulate_runs,
        sleep->points_digest == awake->points_digest ? "the same bits as awake in every frame"
                                                     : "NOT THE SAME BITS as awake");
}

}  // namespace

std::string SceneText(const SceneReport& report) {
  const ScenePrecision& t = report.table;
  std::string text;
  AddHead(t, text);
  AddRows(t, text);
  AddFindings(t, text);
  text += fmt::format(
      "\nmachine   {} ({} cores), {}, {}\ncommit    {}\ntimes     {} kernels, one core, ns a "
      "strand of the scene and frame; all ways frame by frame in turn, of each\n          frame "
      "the "
      "fastest of {} rounds; the clock is read round every stage, about 3 % of the frame\n"
      "digest    {:016x} of the errors\ntook      {:.1f} s\n",
      report.machine.processor, report.machine.cores, report.machine.compiler,
      report.machine.build_type, report.machine.commit, IsaName(t.options.isa), t.options.rounds,
      t.error_digest, report.seconds);
  return text;
}

std::string SceneJson(const SceneReport& report) {
  const ScenePrecision& t = report.table;
  JsonText json;
  json.BeginObject();
  json.Add("format", kSceneAccuracyFormat);
  AddMachine(report.machine, json);
  json.Add("isa", IsaName(t.options.isa));
  json.Add("quick", t.options.quick);
  json.Add("scene", t.options.scene);
  json.Add("contact", t.options.contact);
  json.Add("strands", t.strands);
  json.Add("layers", t.layers);
  json.Add("frames", t.options.frames);
  json.Add("warm_up_frames", t.warm_up);
  json.Add("still_frames", t.options.still_frames);
  json.Add("frames_per_second", t.frames_per_second);
  json.Add("rounds", t.options.rounds);
  json.Add("reference_rate", t.options.reference_rate);
  json.Add("reference_self_error", t.self_error);
  json.Add("secondary_motion_m", t.secondary_m);
  json.AddDigest("error_digest", t.error_digest);
  json.Add("seconds", report.seconds);
  json.BeginArray("rows");
  for (const ScenePrecisionRow& row : t.rows) {
    json.BeginObject();
    json.Add("way", row.way.name);
    json.Add("label", row.way.label);
    json.Add("simulate_ns", row.simulate_ns);
    json.Add("simulate_of_pbd", row.of_pbd);
    json.Add("frame_ns", row.frame_ns);
    json.Add("frame_of_pbd", row.frame_of_pbd);
    json.Add("error", row.error);
    json.Add("off_m", row.off_m);
    json.Add("live_share", row.live_share);
    json.Add("simulate_runs", row.simulate_runs);
    json.Add("reference_material", row.way.OnReferenceMaterial());
    json.Add("simulate_on_front", t.OnFront(row, &ScenePrecisionRow::simulate_ns));
    json.Add("frame_on_front", t.OnFront(row, &ScenePrecisionRow::frame_ns));
    json.AddDigest("points_digest", row.points_digest);
    json.EndObject();
  }
  json.EndArray();
  json.BeginArray("notes");
  for (const std::string& note : t.notes) json.Add("", note);
  json.EndArray();
  json.EndObject();
  return json.text();
}

}  // namespace pelt
