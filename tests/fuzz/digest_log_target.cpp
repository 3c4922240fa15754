// Digest logs: what reads must write and read again as the same log.
#include <cstdlib>

#include "tests/fuzz/fuzz_target.hpp"
#include "traces/diff.hpp"
#include "traces/digest_log.hpp"

namespace pelt::fuzz {

void ReadHostile(std::span<const std::byte> input) {
  const auto log =
      ReadDigestLog({reinterpret_cast<const char*>(input.data()), input.size()}, "fuzz");
  if (!log) {
    if (log.error().find("fuzz") == std::string::npos) std::abort();  // names the file
    return;
  }
  const auto again = ReadDigestLog(WriteDigestLog(*log), "again");
  if (!again || FindDifference(*log, *again)) std::abort();
}

}  // namespace pelt::fuzz
