// Input logs: read, compared, and replayed: what the reader lets through must be refused by the
// scene or run, and run to finite values.
#include <cstdlib>
#include <vector>

#include "bench/verify/replay.hpp"
#include "core/error.hpp"
#include "core/groom/groom_file.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/jobs/non_finite.hpp"
#include "traces/diff.hpp"
#include "traces/input_log_format.hpp"

namespace pelt::fuzz {
namespace {

constexpr size_t kGroomSizeAt = 32, kGroomHashAt = 40, kGroomHeaderBytes = 48;  // groom_file.hpp

void ReadOnce(std::span<const std::byte> bytes) {
  try {
    const InputLog log = ReadInputLog(bytes, "fuzz").OrThrow();
    FindDifference(log, log);
    SceneOptions options;
    options.memory_budget_bytes = 16 << 20;  // a log may name its groom many times over
    Result<ReplayScene> replay = ReplayScene::Open(log, "fuzz", options);
    if (!replay) return;
    SerialExecutor serial;
    Replay(log, *replay, serial, [&](uint32_t) {
      if (!testing::FindNonFinite(replay->scene()).empty()) std::abort();
    });
  } catch (const Error&) {
  }
}

// The grooms inside have a size and a hash of their own.
void MendGrooms(std::vector<std::byte>& log) {
  using namespace input_log;
  const auto number = [&](size_t at) { return GetNumber<uint32_t>(log.data() + at); };
  size_t at = kHeaderBytes;
  for (int text = 0; text < 2; ++text) {
    if (at + 4 > log.size() || number(at) > log.size() - at - 4) return;
    at += 4 + number(at);
  }
  const uint64_t characters = number(kGroomCountAt + 4);
  if (characters > (log.size() - at) / 4) return;
  at += 4 * characters;
  for (uint32_t g = number(kGroomCountAt); g > 0 && at + 8 <= log.size(); --g) {
    const auto size = GetNumber<uint64_t>(log.data() + at);
    at += 8;
    if (size > log.size() - at) return;
    if (size >= kGroomHeaderBytes) {
      const auto groom = std::span(log).subspan(at, size);
      PutNumberAt(log, at + kGroomSizeAt, size);
      PutNumberAt(log, at + kGroomHashAt, HashGroomBytes(groom.subspan(kGroomHeaderBytes)));
    }
    at += size;
  }
}

}  // namespace

// As it is; with size and hash put right, or nothing would get past them; and with those of the
// grooms inside put right too.
void ReadHostile(std::span<const std::byte> input) {
  using namespace input_log;
  ReadOnce(input);
  if (input.size() < kHeaderBytes) return;
  std::vector<std::byte> mended(input.begin(), input.end());
  PutNumberAt(mended, kFileBytesAt, uint64_t(mended.size()));
  PutNumberAt(mended, kHashAt, HashOf(mended));
  ReadOnce(mended);
  MendGrooms(mended);
  PutNumberAt(mended, kHashAt, HashOf(mended));
  ReadOnce(mended);
}

}  // namespace pelt::fuzz
