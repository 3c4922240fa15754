// A share of a long matrix: of `count` processes that each go through the same list of cases, the
// one with number `index` runs every case whose place in the list leaves that remainder.
//
// Cases need no messages, so all that starts processes can carry the matrix: a CI matrix, a Slurm
// array, GNU parallel, mpirun. What says that the shares belong together and leave no gap is the
// merge, not the launcher.
//
// Invariant: the split depends on the place in the list alone. The list depends on the build, the
// instruction sets and the options, all of which are in the fingerprint that a merge compares.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/report/report_tree.hpp"

namespace pelt {

struct Shard {
  uint32_t index = 0, count = 1;

  bool Takes(uint32_t place) const { return place % count == index; }
  bool IsAll() const { return count == 1; }
  bool operator==(const Shard&) const = default;
};

inline constexpr uint32_t kMostShards = 100'000;

using ReadEnvironment = const char* (*)(const char* name);

// "2/8": the third of eight. "env": rank and size of the process as its launcher gives them.
// Throws Error.
Shard ParseShard(std::string_view text, ReadEnvironment read_environment);

// Names and values of what must be equal for shards to be of one run: {"frames", "20"}.
using Fingerprint = std::vector<std::pair<std::string, std::string>>;

// What a merge goes by, into the tree that a shard prints. `places`: length of the list.
void AddShardHeader(const Fingerprint& fingerprint, const Shard& shard, uint32_t places,
                    ReportTree& tree);

// ---- The merge -------------------------------------------------------------------------------

// The one verdict of a matrix that several processes went through, from what each of them printed
// with --json.
//
// What a shard prints is an object with (AddShardHeader)
//
//   "fingerprint"  the run it is part of: build, instruction sets, options, the reference's digest
//   "shard"        {"index": i, "count": n}
//   "places"       length of the whole list of cases
//   "missing"      of verify: what it could not look at, as texts
//   lists          whose entries are cases: {"place": 7, "name": .., "passed": .., "reason": ..}
//
// Invariant: a merge passes only when every place of the list is there exactly once, in the shard
// that the split gives it to, and all of them passed in one and the same run.

// Of one shard's file: far more than the longest matrix prints.
inline constexpr uint64_t kShardBytesLimit = 256u << 20;

struct ShardFile {
  std::string name;  // for messages
  std::string text;
};

struct MergedShards {
  bool passed = true;
  std::vector<std::string> missing;  // what shards could not look at
  // Text: counts, what failed, one verdict line. JSON: to the byte what one process would have
  // printed.
  ReportTree tree;
};

// `command`: what must have printed them ("verify"). Throws Error when they are not the shards of
// one run.
MergedShards MergeShards(std::string_view command, const std::vector<ShardFile>& files);

// What every shard of `command` has in its fingerprint: this build, and the instruction sets that
// this processor has of it.
Fingerprint FingerprintOfBuild(std::string_view command);

}  // namespace pelt
