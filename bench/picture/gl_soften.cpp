#include "bench/picture/gl_soften.hpp"

#include "bench/picture/gl_programs.hpp"

namespace pelt {

void Soften(const GlApi& gl, const GlProgram& program, GlLayer from, GlLayer to,
            const glm::ivec2& size, int reach, int turns, float scale) {
  gl.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  const GlTexture there = MakeTextureArray(gl, GL_RGBA16F, size, 1),
                  back = MakeTextureArray(gl, GL_RGBA16F, size, 1);
  gl.Viewport(0, 0, size.x, size.y);
  program.Use();
  program.Set("reach", reach);
  const auto turn = [&](GlLayer source, GlLayer target, const glm::ivec2& along) {
    BindTexture(gl, kSourceUnit, GL_TEXTURE_2D_ARRAY, source.texture);
    gl.FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, target.texture, 0,
                               target.layer);
    program.Set("layer", source.layer);
    program.Set("along", along);
    program.Set("scale", scale);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    scale = 1.0f;
  };
  for (int i = 0; i < turns; ++i) {
    turn(i == 0 ? from : GlLayer{back, 0}, {there, 0}, {1, 0});
    turn({there, 0}, i + 1 == turns ? to : GlLayer{back, 0}, {0, 1});
  }
}

}  // namespace pelt
