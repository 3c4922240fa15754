// Blurring on the graphics card.
#pragma once

#include "bench/picture/gl_objects.hpp"

namespace pelt {

struct GlLayer {
  GLuint texture;  // an array
  GLint layer;
};

// Running means of 2 `reach` + 1 texels, `turns` times along each side, of `from` times `scale` and at most 1. Both
// are of this size. By GlPrograms' `soften`, into the framebuffer that is bound, which needs no depth.
void Soften(const GlApi& gl, const GlProgram& program, GlLayer from, GlLayer to,
            const glm::ivec2& size, int reach, int turns, float scale);

}  // namespace pelt
