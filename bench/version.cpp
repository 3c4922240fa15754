#include "bench/version.hpp"

#include <fmt/format.h>

#include "bench/machine.hpp"
#include "bench/merge_shards.hpp"

namespace pelt {

std::string DescribeVersion() {
  std::string text = fmt::format("pelt {}", PeltVersion());
  for (const auto& [name, value] : FingerprintOfBuild("version"))
    if (name != "command" && name != "version") text += fmt::format("\n{:<17} {}", name, value);
  return text;
}

}  // namespace pelt
