// The one verdict of a matrix that several processes went through, from what each of them printed
// with --json.
//
// What a shard prints is an object with (AddShardHeader, bench/verify/shard.hpp)
//
//   "fingerprint"  the run it is part of: build, instruction sets, options, the reference's digest
//   "shard"        {"index": i, "count": n}
//   "places"       length of the whole list of cases
//   "missing"      of verify: what it could not look at, as texts
//   lists          whose entries are cases: {"place": 7, "name": .., "passed": .., "reason": ..}
//
// Invariant: a merge passes only when every place of the list is there exactly once, in the shard
// that the split gives it to, and all of them passed in one and the same run.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bench/verify/shard.hpp"

namespace pelt {

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
