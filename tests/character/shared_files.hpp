// Where the real characters lie: $PELT_SHARED, or ../shared beside the sources.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/source_folder.hpp"

namespace pelt::test {

// Empty where the file is absent: skip the test, visibly.
inline std::string FindShared(const std::string& file, const std::string& folder_of = "assets") {
  const char* from = std::getenv("PELT_SHARED");
  const std::filesystem::path folder =
      from ? std::filesystem::path(from) : std::filesystem::path(SourceFolder()) / "../shared";
  const std::filesystem::path path = folder / folder_of / file;
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) ? path.string() : std::string();
}

}  // namespace pelt::test
