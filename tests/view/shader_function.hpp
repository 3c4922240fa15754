// A function that C++ and GLSL have by the same name, and how the two are compared.
#pragma once

#include <functional>
#include <glm/glm.hpp>

namespace pelt {

// Random arguments: each component within -1 and 1, u within 0 and 1; d and e are unit vectors.
struct Arguments {
  glm::vec4 d, e, u, v;
};

// With all that lights hair and skin.
inline constexpr const char* kStudioFile = "studio.glsl";

struct Function {
  const char* name;
  const char* text;  // an expression, or statements that end in one, of vec4 d, e, u, v
  std::function<glm::vec4(const Arguments&)> wanted;
  const char* file = kStudioFile;
};

inline glm::vec3 Unit(const glm::vec4& v) { return glm::vec3(v); }
inline glm::vec4 Wide(float x) { return {x, 0.0f, 0.0f, 0.0f}; }
inline glm::vec4 Wide(const glm::vec3& x) { return glm::vec4(x, 0.0f); }

}  // namespace pelt
