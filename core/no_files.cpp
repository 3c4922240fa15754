// core/file_bytes.hpp where programs have no files: in WebAssembly, whose caller hands over bytes.
#include "core/file_bytes.hpp"
#include "core/format.hpp"
#include "core/printable.hpp"

namespace pelt {
namespace {

constexpr std::string_view kReason = "there are no files here";

Failure Named(std::string_view what, const std::string& path) {
  return Failure{Printable(Format("{} '{}': {}", what, path, kReason))};
}

}  // namespace

Result<std::vector<std::byte>> ReadWhole(const std::string&, uint64_t) {
  return Failure{std::string(kReason)};
}

Result<std::vector<std::byte>> ReadToEnd(std::FILE*, uint64_t) {
  return Failure{std::string(kReason)};
}

Result<std::vector<std::byte>> ReadFileBytes(std::string_view what, const std::string& path,
                                             uint64_t) {
  return Named(what, path);
}

Result<> WriteFileBytes(std::string_view what, const std::string& path,
                        std::span<const std::byte>) {
  return Named(what, path);
}

Result<> TryOutput(std::string_view what, const std::string& path) { return Named(what, path); }

}  // namespace pelt
