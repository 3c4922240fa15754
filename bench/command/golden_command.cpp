// `pelt golden`: digests that were computed once and are kept (traces/golden). They catch what
// comparing a build with itself cannot: a change of the bits from one compiler, version or commit
// to the next.
//
// Invariant: a check that passes compared every line of every frame of every log it names; a log
// of another chunk capacity is said to be skipped.
#include <fmt/format.h>

#include <algorithm>

#include "bench/command/commands.hpp"
#include "bench/verify/shard.hpp"
#include "bench/verify/stage_digests.hpp"
#include "core/error.hpp"
#include "traces/diff.hpp"
#include "traces/digest_log.hpp"

namespace pelt {
namespace {

// The capacity that golden logs are kept for.
constexpr uint32_t kGoldenChunkStrands = 128;

struct Golden {
  std::string_view name;  // of the file, before ".digests"
  std::string_view scene;
  uint32_t frames;
  uint32_t strand_budget = 0;           // 0: without LOD
  std::optional<Solver> original = {};  // the original's, instead of the setup's
};
constexpr Golden kGoldens[] = {
    {"tiny", "tiny", 20},
    {"tiny.lod", "tiny", 20, 400},
    {"monster", "monster", 10},
    {"monster.pbd", "monster", 10, 0, Solver::kPbd},
    {"eyepet", "eyepet", 10},
    {"eyepet.verlet", "eyepet", 10, 0, Solver::kVerlet},
    {"stage", "stage", 6},
    {"cast", "cast", 3},
    {"cast.pbd", "cast", 3, 0, Solver::kPbd},
    {"scorpion", "scorpion", 10},
    {"everything", "everything", 25},
    {"everything.lod", "everything", 22, 600},
};

DigestLog RunGolden(const Golden& golden) {
  RunArgs args;
  args.request.scene = golden.scene;
  args.request.solver = golden.original;
  args.options.executor = "serial";
  args.options.frames = golden.frames;
  args.options.digest = false;
  args.options.skip.lod = golden.strand_budget != 0;
  args.options.lod.strand_budget = golden.strand_budget;
  Scenario scenario = LoadForRun(args, nullptr);
  RunningScenario running(scenario, args.options.scene);
  const StageDigests stages(running.scene());
  DigestLog log =
      stages.Begin(scenario.name, DescribeSettings(args), args.options.scene.vertex_order);
  args.options.after_frame = [&](uint32_t, const FurScene& scene) { stages.AddFrame(scene, log); };
  RunFrames(scenario, running, args.options);
  return log;
}

std::string FileName(const Golden& golden) { return fmt::format("{}.digests", golden.name); }

// Stricter than a diff of two runs: what a log is of, and which lines it has, is golden too.
std::optional<std::string> FindGoldenFault(const DigestLog& stored, const DigestLog& now) {
  if (const auto found = FindDifference(stored, now)) return DescribeDifference(*found);
  if (stored.settings != now.settings)
    return fmt::format("settings: '{}' and '{}'", stored.settings, now.settings);
  if (stored.columns != now.columns) return "the frames have other lines";
  return std::nullopt;
}

struct GoldenResult {
  const Golden* golden = nullptr;
  uint32_t place = 0;  // in the list that shards split
  bool passed = true;
  bool compared = true;     // else of another chunk capacity
  std::string reason = {};  // what was found
};

GoldenResult Check(const Golden& golden, const std::string& folder) {
  GoldenResult result{.golden = &golden};
  const DigestLog stored =
      ReadDigestLogFile(fmt::format("{}/{}", folder, FileName(golden))).OrThrow();
  if (stored.chunk_strands != kStrandsPerChunk) {
    result.compared = false;
    result.reason = fmt::format("skipped, it is of {} strands per chunk and this build has {}",
                                stored.chunk_strands, kStrandsPerChunk);
    return result;
  }
  const DigestLog now = RunGolden(golden);
  const auto fault = FindGoldenFault(stored, now);
  result.passed = !fault;
  result.reason =
      fault ? "DIFFERENT, kept and computed: " + *fault
            : fmt::format("same, {} frames of {} lines", now.FrameCount(), now.columns.size());
  return result;
}

Fingerprint FingerprintOf(const GoldenArgs& args) {
  Fingerprint all = FingerprintOfBuild("golden");
  all.emplace_back("scene", args.scene.empty() ? "all" : args.scene);
  return all;
}

ReportTree MakeTree(const GoldenArgs& args, const std::vector<GoldenResult>& results,
                    uint32_t places, bool passed) {
  ReportTree tree;
  AddShardHeader(FingerprintOf(args), args.shard, places, tree);
  tree.Add(InJson("passed"), passed);
  ReportTable& logs = tree.AddTable("logs", {InJson("place"), InJson("name"), InJson("passed"),
                                             InJson("compared"), InJson("reason")});
  for (const GoldenResult& r : results) {
    logs.Add({r.place, r.golden->name, r.passed, r.compared, r.reason});
    tree.Say(fmt::format("{}: {}", r.golden->name, r.reason));
    if (!r.passed)
      tree.Say(fmt::format("  if the change is meant: pelt golden --renew {} says all that changed",
                           args.check));
  }
  return tree;
}

// The digest of a line, or nothing when the log does not have it.
std::optional<uint64_t> Find(const DigestLog& log, uint32_t frame, const DigestColumn& column) {
  const auto found = std::find(log.columns.begin(), log.columns.end(), column);
  if (frame >= log.FrameCount() || found == log.columns.end()) return std::nullopt;
  return log.Frame(frame)[size_t(found - log.columns.begin())];
}

std::string ShowDigest(const std::optional<uint64_t>& digest) {
  return digest ? fmt::format("{:016x}", *digest) : std::string("none");
}

// Prints every line that is new, gone or different; the number of them.
size_t PrintChanges(const Golden& golden, const DigestLog& old, const DigestLog& now) {
  size_t changes = 0;
  const auto print = [&](uint32_t frame, const DigestColumn& column) {
    const auto before = Find(old, frame, column), after = Find(now, frame, column);
    if (before == after) return;
    ++changes;
    fmt::print("{} frame {} stage {} stream {}: {} -> {}\n", golden.name, frame, column.stage,
               column.stream, ShowDigest(before), ShowDigest(after));
  };
  for (uint32_t f = 0; f < std::max(old.FrameCount(), now.FrameCount()); ++f) {
    for (const DigestColumn& column : now.columns) print(f, column);
    for (const DigestColumn& column : old.columns)
      if (!Find(now, 0, column)) print(f, column);
  }
  return changes;
}

void Renew(const Golden& golden, const OutputPath& path) {
  const Result<DigestLog> old = ReadDigestLogFile(path.path());
  const DigestLog now = RunGolden(golden);
  const std::string text = WriteDigestLog(now);
  if (old && WriteDigestLog(*old) == text) {
    fmt::print("{}: nothing changed\n", golden.name);
    return;
  }
  if (old) {
    const size_t changes = PrintChanges(golden, *old, now);
    fmt::print("{}: {} lines changed\n", golden.name, changes);
  } else {
    fmt::print("{}: new ({})\n", golden.name, old.error());
  }
  WriteOutput("digest log", path, text);
}

}  // namespace

ExitCode CheckOrRenewGolden(const GoldenArgs& args) {
  if (!args.merge.empty()) return PrintMergedShards("golden", args.merge, args.json);
  if (!args.renew.empty() && kStrandsPerChunk != kGoldenChunkStrands)
    throw Error(fmt::format("golden digests are kept for {} strands per chunk; this build has {}",
                            kGoldenChunkStrands, kStrandsPerChunk));
  if (!args.renew.empty())
    for (const Golden& golden : kGoldens)
      if (args.scene.empty() || golden.scene == args.scene)
        CheckOutput("digest log", args.renew.Inside(FileName(golden)));
  std::vector<GoldenResult> results;
  uint32_t places = 0;
  bool passed = true;
  for (const Golden& golden : kGoldens) {
    if (!args.scene.empty() && golden.scene != args.scene) continue;
    const uint32_t place = places++;
    if (!args.shard.Takes(place)) continue;
    if (!args.renew.empty()) {
      Renew(golden, args.renew.Inside(FileName(golden)));
      continue;
    }
    results.push_back(Check(golden, args.check));
    results.back().place = place;
    passed &= results.back().passed;
  }
  if (args.renew.empty()) MakeTree(args, results, places, passed).Print(args.json);
  return AnswerOf(passed);
}

}  // namespace pelt
