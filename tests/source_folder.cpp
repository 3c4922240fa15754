#include "tests/source_folder.hpp"

namespace pelt::test {

const std::string& SourceFolder() {
  static const std::string folder = PELT_SOURCE_DIR;
  return folder;
}

}  // namespace pelt::test
