// The files of bench/shading/shaders, by name, as CMakeLists.txt put them into the program.
#pragma once

#include <span>
#include <string_view>

namespace pelt {

struct ShaderFile {
  std::string_view name, text;
};

std::span<const ShaderFile> EmbeddedShaders();

}  // namespace pelt
