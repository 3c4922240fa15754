// `pelt golden`: digests that were computed once and are kept (traces/golden). They catch what
// comparing a build with itself cannot: a change of the bits from one compiler, version or commit
// to the next.
//
// Invariant: a check that passes compared every line of every frame of every log it names; a log
// of another chunk capacity is said to be skipped.
#include <fmt/format.h>

#include <algorithm>

#include "bench/commands.hpp"
#include "bench/stage_digests.hpp"
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
  uint32_t strand_budget;  // 0: without LOD
};
constexpr Golden kGoldens[] = {{"tiny", "tiny", 20, 0},
                               {"tiny.lod", "tiny", 20, 400},
                               {"monster", "monster", 10, 0},
                               {"eyepet", "eyepet", 10, 0},
                               {"cast", "cast", 3, 0}};

DigestLog RunGolden(const Golden& golden) {
  RunArgs args;
  args.request.scene = golden.scene;
  args.options.executor = ExecutorKind::kSerial;
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

std::string PathOf(const std::string& folder, const Golden& golden) {
  return fmt::format("{}/{}.digests", folder, golden.name);
}

// Stricter than a diff of two runs: what a log is of, and which lines it has, is golden too.
std::optional<std::string> FindGoldenFault(const DigestLog& stored, const DigestLog& now) {
  if (const auto found = FindDifference(stored, now)) return DescribeDifference(*found);
  if (stored.settings != now.settings)
    return fmt::format("settings: '{}' and '{}'", stored.settings, now.settings);
  if (stored.columns != now.columns) return "the frames have other lines";
  return std::nullopt;
}

bool Check(const Golden& golden, const std::string& folder) {
  const DigestLog stored = ReadDigestLogFile(PathOf(folder, golden));
  if (stored.chunk_strands != kStrandsPerChunk) {
    fmt::print("{}: skipped, it is of {} strands a chunk and this build has {}\n", golden.name,
               stored.chunk_strands, kStrandsPerChunk);
    return true;
  }
  const DigestLog now = RunGolden(golden);
  if (const auto fault = FindGoldenFault(stored, now)) {
    fmt::print(
        "{}: DIFFERENT, kept and computed: {}\n"
        "  if the change is meant: pelt golden --renew {} says all that changed\n",
        golden.name, *fault, folder);
    return false;
  }
  fmt::print("{}: same, {} frames of {} lines\n", golden.name, now.FrameCount(),
             now.columns.size());
  return true;
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

void Renew(const Golden& golden, const std::string& folder) {
  const std::string path = PathOf(folder, golden);
  std::string error;
  const std::optional<DigestLog> old = TryReadDigestLogFile(path, error);
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
    fmt::print("{}: new ({})\n", golden.name, error);
  }
  WriteDigestLogFile(now, path);
}

}  // namespace

int CheckOrRenewGolden(const GoldenArgs& args) {
  if (!args.renew.empty() && kStrandsPerChunk != kGoldenChunkStrands)
    throw Error(fmt::format("golden digests are kept for {} strands a chunk; this build has {}",
                            kGoldenChunkStrands, kStrandsPerChunk));
  bool passed = true;
  for (const Golden& golden : kGoldens) {
    if (!args.scene.empty() && golden.scene != args.scene) continue;
    if (args.renew.empty()) {
      passed &= Check(golden, args.check);
    } else {
      Renew(golden, args.renew);
    }
  }
  return passed ? 0 : 1;
}

}  // namespace pelt
