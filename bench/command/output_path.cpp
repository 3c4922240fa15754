#include "bench/command/output_path.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "core/error.hpp"

namespace pelt {

OutputPath OutputPath::Inside(std::string_view name) const {
  return Of((std::filesystem::path(path_) / name).string());
}

void MakeFolder(const OutputPath& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder.path(), error);
  if (error)
    throw Error(fmt::format("cannot make the folder {}: {}", folder.path(), error.message()));
}

void CheckOutput(std::string_view what, const OutputPath& output) {
  TryOutput(what, output.path()).OrThrow();
}

void WriteOutput(std::string_view what, const OutputPath& output,
                 std::span<const std::byte> bytes) {
  WriteFileBytes(what, output.path(), bytes).OrThrow();
}

}  // namespace pelt
