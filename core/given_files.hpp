// Files of a program that has none of its own, WebAssembly in a page: whoever runs it hands over their bytes, and
// core/file_bytes.hpp finds them by the same path.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace pelt {

// In place of what was given by this path before.
void GiveFile(const std::string& path, std::vector<std::byte> bytes);

}  // namespace pelt
