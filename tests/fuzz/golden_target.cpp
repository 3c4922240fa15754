// Golden digests: a hostile file in the place of kept ones, compared with those of `tiny`. A log
// that is found the same must hold the same digests.
#include <cstdlib>

#include "tests/fuzz/fuzz_target.hpp"
#include "tests/source_folder.hpp"
#include "traces/diff.hpp"
#include "traces/digest_log.hpp"

namespace pelt::fuzz {

void ReadHostile(std::span<const std::byte> input) {
  static const DigestLog kTiny =
      ReadDigestLogFile(test::SourceFolder() + "/traces/golden/tiny.digests").OrThrow();
  const auto stored =
      ReadDigestLog({reinterpret_cast<const char*>(input.data()), input.size()}, "fuzz");
  if (!stored) return;
  const auto difference = FindDifference(*stored, kTiny);
  if (difference) {
    DescribeDifference(*difference);
  } else if (stored->columns == kTiny.columns && stored->digests != kTiny.digests) {
    std::abort();
  }
}

}  // namespace pelt::fuzz
