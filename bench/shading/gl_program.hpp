// Shaders of bench/shading/shaders as programs for a graphics card: the texts are part of the program, so that the
// command runs from anywhere.
#pragma once

#include <string>
#include <string_view>

#include "bench/shading/gl_context.hpp"

namespace pelt {

// The file's text behind those that it names in lines "// After:", without a version line; empty where there is no
// such file.
std::string ShaderText(std::string_view file);
// The file's alone.
std::string_view OwnText(std::string_view file);

// A linked program; the caller deletes it. Fails with the driver's words. The texts get "#version 330 core" first.
Result<GLuint> MakeProgram(const GlApi& gl, const std::string& vertex, const std::string& fragment);

}  // namespace pelt
