#include "bench/verify/shard.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "core/error.hpp"

namespace pelt {
namespace {

// Where a launcher says which of how many processes this one is.
struct Launcher {
  const char* rank;
  const char* first;  // variable with the least rank; null: `base`
  uint32_t base;
  const char* size;
};
// Processes of one job. mpirun inside a Slurm allocation sets its own beside Slurm's, which then
// count nodes: it comes first.
constexpr Launcher kProcesses[] = {{"OMPI_COMM_WORLD_RANK", nullptr, 0, "OMPI_COMM_WORLD_SIZE"},
                                   {"PMI_RANK", nullptr, 0, "PMI_SIZE"},
                                   {"SLURM_PROCID", nullptr, 0, "SLURM_NTASKS"}};
// Jobs beside each other.
constexpr Launcher kJobs[] = {
    {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", 0, "SLURM_ARRAY_TASK_COUNT"},
    {"CI_NODE_INDEX", nullptr, 1, "CI_NODE_TOTAL"},  // GitLab
    {"CIRCLE_NODE_INDEX", nullptr, 0, "CIRCLE_NODE_TOTAL"},
    {"BUILDKITE_PARALLEL_JOB", nullptr, 0, "BUILDKITE_PARALLEL_JOB_COUNT"}};

std::optional<uint32_t> ParseNumber(std::string_view text) {
  uint32_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

uint32_t ReadNumber(const char* name, ReadEnvironment read) {
  const char* text = read(name);
  if (!text) throw Error(fmt::format("--shard env: {} is not set", name));
  if (const auto value = ParseNumber(text)) return *value;
  throw Error(fmt::format("--shard env: {} is '{}', not a number from 0 on", name, text));
}

void CheckCount(uint64_t count, std::string_view from) {
  if (count == 0 || count > kMostShards)
    throw Error(fmt::format("{}: {} shards, not 1 to {}", from, count, kMostShards));
}

// The first launcher of a list that says anything.
template <size_t N>
std::optional<Shard> FindShard(const Launcher (&launchers)[N], ReadEnvironment read) {
  for (const Launcher& launcher : launchers) {
    if (!read(launcher.rank)) continue;
    const uint32_t first = launcher.first ? ReadNumber(launcher.first, read) : launcher.base;
    const uint32_t rank = ReadNumber(launcher.rank, read);
    const uint32_t count = ReadNumber(launcher.size, read);
    CheckCount(count, launcher.size);
    // A Slurm array with steps (--array=0-8:4) has ranks beyond its count.
    if (rank < first || rank - first >= count)
      throw Error(fmt::format("--shard env: {} is {}, and {} says {} from {} on", launcher.rank,
                              rank, launcher.size, count, first));
    return Shard{rank - first, count};
  }
  return std::nullopt;
}

// An array of jobs of several processes each is split by both.
Shard ShardOfEnvironment(ReadEnvironment read) {
  const auto processes = FindShard(kProcesses, read);
  const auto jobs = FindShard(kJobs, read);
  if (!processes && !jobs)
    throw Error(
        "--shard env: no launcher says which process this is (OMPI_COMM_WORLD_RANK, PMI_RANK, "
        "SLURM_PROCID, SLURM_ARRAY_TASK_ID, CI_NODE_INDEX, CIRCLE_NODE_INDEX and "
        "BUILDKITE_PARALLEL_JOB are not set); give i/n");
  const Shard inner = processes.value_or(Shard{}), outer = jobs.value_or(Shard{});
  CheckCount(uint64_t{inner.count} * outer.count, "--shard env");
  return {outer.index * inner.count + inner.index, outer.count * inner.count};
}

}  // namespace

Shard ParseShard(std::string_view text, ReadEnvironment read_environment) {
  if (text == "env") return ShardOfEnvironment(read_environment);
  const size_t slash = text.find('/');
  const auto index = ParseNumber(text.substr(0, slash));
  const auto count = slash == text.npos ? std::nullopt : ParseNumber(text.substr(slash + 1));
  if (!index || !count)
    throw Error(fmt::format("--shard: '{}' is neither i/n (0/3, 1/3, 2/3) nor env", text));
  CheckCount(*count, "--shard");
  if (*index >= *count)
    throw Error(fmt::format("--shard: {} of {}; they count from 0/{} to {}/{}", *index, *count,
                            *count, *count - 1, *count));
  return {*index, *count};
}

void AddShardHeader(const Fingerprint& fingerprint, const Shard& shard, uint32_t places,
                    ReportTree& tree) {
  ReportTree& of = tree.AddSection("fingerprint");
  for (const auto& [name, value] : fingerprint) of.Add(InJson(name), value);
  tree.AddSection("shard").Add(InJson("index"), shard.index).Add(InJson("count"), shard.count);
  tree.Add(InJson("places"), places);
}

}  // namespace pelt
