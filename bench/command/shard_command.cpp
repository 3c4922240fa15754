// What --shard and --merge need of this build and its files.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/command/commands.hpp"
#include "bench/report/machine.hpp"
#include "bench/verify/shard.hpp"
#include "core/chunk.hpp"
#include "core/file_bytes.hpp"
#include "core/kernels/frame_table.hpp"

namespace pelt {

Fingerprint FingerprintOfBuild(std::string_view command) {
  const Machine machine = DescribeMachine();
  std::vector<std::string_view> isas;
  for (const Isa isa : kAllIsas)
    if (FindKernels(isa)) isas.push_back(IsaName(isa));
  return {{"command", std::string(command)},
          {"version", std::string(PeltVersion())},
          {"commit", machine.commit},
          {"compiler", machine.compiler},
          {"build_type", machine.build_type},
          {"chunk_strands", fmt::format("{}", kStrandsPerChunk)},
          {"instruction_sets", fmt::format("{}", fmt::join(isas, " "))}};
}

ExitCode PrintMergedShards(std::string_view command, const std::vector<std::string>& paths,
                           bool json) {
  std::vector<ShardFile> files;
  for (const std::string& path : paths)
    files.push_back(
        {path, std::string(AsText(ReadFileBytes("shard", path, kShardBytesLimit).OrThrow()))});
  const MergedShards merged = MergeShards(command, files);
  merged.tree.Print(json);
  if (merged.passed && !merged.missing.empty()) return kIncomplete;
  return AnswerOf(merged.passed);
}

}  // namespace pelt
