#include "bench/command/version.hpp"

#include <fmt/format.h>

#include "bench/report/machine.hpp"
#include "bench/verify/merge_shards.hpp"

namespace pelt {

std::string DescribeVersion() {
  std::string text = fmt::format("pelt {}", PeltVersion());
  for (const auto& [name, value] : FingerprintOfBuild("version"))
    if (name != "command" && name != "version") text += fmt::format("\n{:<17} {}", name, value);
  return text;
}

}  // namespace pelt
