// `pelt trace`: record what a scene is given, replay it anywhere, show what a recording holds.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/report/report_tree.hpp"
#include "bench/verify/lockstep.hpp"
#include "bench/verify/replay.hpp"
#include "bench/verify/stage_digests.hpp"
#include "core/error.hpp"
#include "core/format.hpp"
#include "core/groom/groom_file.hpp"

namespace pelt {
namespace {

void CheckRecorded(const char* fault) {
  if (fault) throw Error(fmt::format("recording: {}", fault));
}

void BeginRecording(const Scenario& scenario, const RunArgs& args, bool velocities,
                    std::span<const std::byte> snapshot, InputLogWriter& writer) {
  std::vector<std::vector<std::byte>> grooms;
  for (const Groom& groom : scenario.grooms) grooms.push_back(WriteGroom(groom).OrThrow());
  std::vector<std::span<const std::byte>> each;
  for (const Actor& actor : scenario.actors) each.emplace_back(grooms[actor.groom]);
  const bool index_buffer = args.options.scene.vertex_order == VertexOrder::kIndexBuffer;
  CheckRecorded(writer.Begin(
      {scenario.name, DescribeSettings(args), index_buffer, velocities, scenario.origins}, each,
      snapshot));
}

// Poses that are the same as in the frame before.
uint64_t CountUnchangedPoses(const InputLog& log) {
  return uint64_t(log.FrameCount()) * log.CharacterCount() - log.poses.size();
}

// A groom file that this program cannot read is still named and measured.
std::string DescribeGroom(const InputLog& log, size_t index) {
  const auto users =
      std::count(log.character_groom.begin(), log.character_groom.end(), uint32_t(index));
  std::string text =
      fmt::format("groom {}: {} bytes, of {} characters", index, log.grooms[index].size(), users);
  const auto groom = ReadGroom(log.grooms[index], fmt::format("groom {} of the log", index));
  if (!groom) return text + "; cannot be read: " + groom.error();
  uint64_t strands = 0;
  for (const GroomLayer& layer : groom->layers) strands += layer.strand_count;
  return text + fmt::format("; {} layers, {} strands, {} joints", groom->layers.size(), strands,
                            groom->joint_count);
}

ReportTree MakeShowTree(const InputLog& log) {
  ReportTree tree;
  tree.Add({"scene"}, log.about.scene).Add({"bytes"}, log.file_bytes).EndLine();
  tree.Add({.key = "note", .show = log.about.note.empty() ? Show::kJson : Show::kBoth},
           log.about.note);
  tree.EndLine();
  tree.Add({"chunk_strands", "", -1, "recorded with strands per chunk"}, log.chunk_strands);
  tree.Add({"vertex_order"}, VertexOrderName(log.about.index_buffer ? VertexOrder::kIndexBuffer
                                                                    : VertexOrder::kSorted));
  std::vector<size_t> groom_bytes;
  for (size_t g = 0; g < log.grooms.size(); ++g) {
    groom_bytes.push_back(log.grooms[g].size());
    tree.Say(DescribeGroom(log, g));
  }
  tree.Add(InJson("grooms"), groom_bytes).Add(InJson("character_groom"), log.character_groom);
  if (!log.snapshot.empty())
    tree.Add({"snapshot_bytes", "", -1, "begins with a snapshot of bytes"}, log.snapshot.size())
        .EndLine();
  tree.Add(InText("frames"), log.FrameCount()).Add(InText("characters"), log.CharacterCount());
  tree.Add({"poses_unchanged", "", -1, "poses that are as in the frame before"},
           CountUnchangedPoses(log));
  tree.Add(InText("of"), uint64_t(log.FrameCount()) * log.CharacterCount());
  ReportTable& frames = tree.AddTable(
      "frames", {InText("frame"), {"time_s", "s", 4, "time"}, {"dt_s", "s", 5, "dt"}, {"digest"}});
  for (const InputLogFrame& frame : log.frames)
    frames.Add(
        {frames.rows.size(), frame.input.time_s, frame.input.dt_s, DigestText(frame.digest)});
  return tree;
}

ReportTree MakeReplayTree(const ReplayResult& result) {
  ReportTree tree;
  tree.Say("verdict: " + DescribeReplay(result));
  tree.Add(InJson("same"), result.Same()).Add(InJson("frames"), result.frames);
  tree.Add(InJson("mismatches"), result.mismatches);
  tree.Add(InJson("digest"), DigestText(result.digest));
  if (!result.first) return tree;
  ReportTree& first = tree.AddSection("first");
  first.Add(InJson("frame"), result.first->frame);
  first.Add(InJson("recorded"), DigestText(result.first->recorded));
  first.Add(InJson("found"), DigestText(result.first->found));
  first.Add(InJson("refused"), result.first->refused);
  return tree;
}

}  // namespace

std::string DescribeSettings(const RunArgs& args) {
  std::vector<std::string> all;
  if (args.request.seed) all.push_back(fmt::format("seed {}", args.request.seed));
  if (!args.request.clip.empty()) all.push_back("clip " + Printable(args.request.clip));
  if (args.request.once) all.push_back("clips once");
  const auto say = [&](auto LayerParams::*param, const auto& value) {
    const auto& entry = LayerParamEntryOf(param);
    if (value) all.push_back(fmt::format("{} {}", entry.key, entry.words[size_t(*value)]));
  };
  say(&LayerParams::solver, args.request.solver);
  say(&LayerParams::quality, args.request.quality);
  // Files not by their folders, which are others on another machine.
  if (!args.request.plan.empty())
    all.push_back("plan " + std::filesystem::path(args.request.plan).filename().string());
  if (!args.request.lights.empty())
    all.push_back("lights " + std::filesystem::path(args.request.lights).filename().string());
  if (!args.haircut.empty())
    all.push_back("haircut " + std::filesystem::path(args.haircut).filename().string());
  if (args.fps > 0.0) all.push_back(fmt::format("{} fps", args.fps));
  if (args.weather)
    all.push_back(fmt::format("wetness {}, dirt {} from frame {}", args.weather->wetness,
                              args.weather->dirt, args.weather->from_frame));
  if (!args.camera.orbit.empty())
    all.push_back(fmt::format("camera {}", fmt::join(args.camera.orbit, ",")));
  if (!args.camera.target_m.empty())
    all.push_back(fmt::format("camera target {}", fmt::join(args.camera.target_m, ",")));
  if (args.camera.turntable) all.push_back("turntable");
  for (uint32_t c = 0; c < kPaintChannels; ++c)
    if (args.paint[c] > 0.0f)
      all.push_back(fmt::format("{} {}", kPaintChannelNames[c], args.paint[c]));
  if (args.options.skip.lod) all.push_back("lod");
  if (args.options.skip.lod && args.options.lod.strand_budget)
    all.push_back(fmt::format("strand budget {}", args.options.lod.strand_budget));
  if (args.options.skip.lod && args.options.lod.least_chains != LodSettings{}.least_chains)
    all.push_back(fmt::format("at least {} of the chains", args.options.lod.least_chains));
  if (args.options.lod.fast_quality_px != LodSettings{}.fast_quality_px)
    all.push_back(fmt::format("fast quality up to {} px", args.options.lod.fast_quality_px));
  if (!args.options.skip.cull) all.push_back("no culling");
  if (args.options.scene.velocities) all.push_back("velocities");
  if (args.options.scene.origins) all.push_back("origins");
  return fmt::format("{}", fmt::join(all, ", "));
}

ExitCode Record(const RecordArgs& args) {
  Scenario scenario = LoadForRun(args.run, stdout);
  RunOptions options = args.run.options;
  options.digest = false;
  options.scene.plan.must_fit = options.executor->local_store;
  RunningScenario running(scenario, options.scene);
  InputLogWriter writer;
  const PoseRateBlock* const rates = running.scene().PoseRates(0);
  const double* const origins = running.scene().Origin(0);
  if (options.frames == 0) options.frames = scenario.default_frames;
  if (args.from >= options.frames)
    throw Error(
        fmt::format("--from {}: the run has frames 0 to {}", args.from, options.frames - 1));
  if (args.from == 0) BeginRecording(scenario, args.run, rates != nullptr, {}, writer);
  options.after_frame = [&](uint32_t frame, const FurScene& scene) {
    if (frame + 1 == args.from) {
      std::vector<std::byte> snapshot(scene.SnapshotBytes());
      CheckRecorded(scene.Snapshot(snapshot));
      BeginRecording(scenario, args.run, rates != nullptr, snapshot, writer);
    }
    if (frame < args.from) return;
    // The frame's input again: it depends on the frame's number alone.
    FrameInput input = scenario.PrepareFrame(frame, running.scene());
    input.skip = options.skip;
    input.lod = options.lod;
    const uint32_t characters = scene.shape().character_count;
    CheckRecorded(writer.AddFrame(input, {&running.scene().Pose(0), characters},
                                  scene.DigestFrame(), {rates, rates ? characters : 0},
                                  {origins, origins ? 3 * characters : 0}));
  };
  {
    Progress progress("record", options.frames);
    options.progress = [&](uint32_t done, uint32_t) { progress.Show(done); };
    RunFrames(scenario, running, options);
  }
  const std::vector<std::byte> bytes = writer.Finish();
  WriteOutput("input log", args.out, bytes);
  fmt::print("{}: {} frames of scene {}, {} bytes\n", args.out.path(), writer.FrameCount(),
             scenario.name, bytes.size());
  return kDone;
}

ExitCode ReplayRecording(const ReplayArgs& args) {
  const InputLog log = ReadInputLogFile(args.path).OrThrow();
  ReplayScene replay = ReplayScene::Open(log, args.path, SceneOptionsOf(args.as)).OrThrow();
  const std::unique_ptr<WatchedExecutor> executor = MakeExecutor(args.as);
  const StageDigests stage_digests(replay.scene());
  DigestLog digests =
      stage_digests.Begin(log.about.scene, log.about.note, replay.options().vertex_order);
  ReplayResult result;
  {
    Progress progress("replay", log.FrameCount());
    result = Replay(log, replay, *executor, [&](uint32_t frame) {
      progress.Show(frame + 1);
      if (!args.digest_log.empty()) stage_digests.AddFrame(replay.scene(), digests);
    });
  }
  const std::vector<std::string> faults = executor->Faults();
  ReportTree tree = MakeReplayTree(result);
  if (!faults.empty())
    tree.Say(
        fmt::format("{} faults of the executor, the first: {}", faults.size(), faults.front()));
  tree.Print(args.json);
  if (!args.digest_log.empty()) WriteOutput("digest log", args.digest_log, WriteDigestLog(digests));
  return AnswerOf(result.Same() && faults.empty());
}

ExitCode ShowRecording(const ShowArgs& args) {
  MakeShowTree(ReadInputLogFile(args.path).OrThrow()).Print(args.json);
  return kDone;
}

}  // namespace pelt
