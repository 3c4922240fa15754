// The folder that Pelt's sources lie in, without a slash at its end. One object knows it: what a
// compiler makes of every other test file is the same in every clone, and found in ccache.
#pragma once

#include <string>

namespace pelt::test {

const std::string& SourceFolder();

}  // namespace pelt::test
