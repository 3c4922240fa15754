#include "bench/command/output_path.hpp"

#include <filesystem>

namespace pelt {

OutputPath OutputPath::Inside(std::string_view name) const {
  return Of((std::filesystem::path(path_) / name).string());
}

void CheckOutput(std::string_view what, const OutputPath& output) {
  TryOutput(what, output.path()).OrThrow();
}

void WriteOutput(std::string_view what, const OutputPath& output,
                 std::span<const std::byte> bytes) {
  WriteFileBytes(what, output.path(), bytes).OrThrow();
}

}  // namespace pelt
