// Input logs: read, compared, and replayed: what the reader lets through must be refused by the
// scene or run.
#include <vector>

#include "bench/replay.hpp"
#include "core/error.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "traces/diff.hpp"
#include "traces/input_log_format.hpp"

namespace pelt::fuzz {
namespace {

void ReadOnce(std::span<const std::byte> bytes) {
  try {
    const InputLog log = ReadInputLog(bytes, "fuzz");
    FindDifference(log, log);
    SceneOptions options;
    options.memory_budget_bytes = 16 << 20;  // a log may name its groom many times over
    ReplayScene replay(log, "fuzz", options);
    SerialExecutor serial;
    Replay(log, replay, serial);
  } catch (const Error&) {
  }
}

}  // namespace

// As it is; and again with size and hash put right, or nothing would get past them.
void ReadHostile(std::span<const std::byte> input) {
  using namespace input_log;
  ReadOnce(input);
  if (input.size() < kHeaderBytes) return;
  std::vector<std::byte> mended(input.begin(), input.end());
  PutNumberAt(mended, kFileBytesAt, uint64_t(mended.size()));
  PutNumberAt(mended, kHashAt, HashOf(mended));
  ReadOnce(mended);
}

}  // namespace pelt::fuzz
