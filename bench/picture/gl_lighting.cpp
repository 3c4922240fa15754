#include "bench/picture/gl_lighting.hpp"

#include <algorithm>

#include "bench/picture/gl_soften.hpp"

namespace pelt {

GlLighting::GlLighting(const GlApi& gl, const GlPrograms& programs, const PictureScene& scene,
                       const GlBodies& bodies, const GlShadows& shadows,
                       const PictureOptions& options)
    : coefficients_(gl) {
  constexpr float kBehind[4] = {0.5f, 0.5f, 1.0f, 1.0f}, kFar = 1.0f;
  constexpr uint32_t kHeightsOfBlur = 90;  // a blur reaches so much of the picture's height
  const glm::ivec2 size(std::max(options.width_px / 2, 1u), std::max(options.height_px / 2, 1u));
  gl.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  const GlTexture sharp = MakeTextureArray(gl, GL_RGBA16F, size, 1);
  const GlTexture depth = MakeTexture(gl, GL_DEPTH_COMPONENT32F, size.x, size.y);
  coefficients_ = MakeTextureArray(gl, GL_RGBA16F, size, 1);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, filter, GL_LINEAR);
  const GlFramebuffer target(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target);
  gl.FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, sharp, 0, 0);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
  gl.Viewport(0, 0, size.x, size.y);
  gl.ClearBufferfv(GL_COLOR, 0, kBehind);
  gl.ClearBufferfv(GL_DEPTH, 0, &kFar);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LESS);
  const GlProgram& program = programs[GlPrograms::kLighting];
  program.Use();
  for (uint32_t a = 0; a < scene.bodies.size(); ++a) {
    program.Set("character", a);
    program.Set("lift", shadows.Lift(a));
    bodies.DrawSkin(a);
  }
  gl.Disable(GL_DEPTH_TEST);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
  const int reach = int(std::max(options.height_px / 2 / kHeightsOfBlur, 1u));
  Soften(gl, programs[GlPrograms::kSoften], {sharp, 0}, {coefficients_, 0}, size, reach, 2, 1.0f);
  BindTexture(gl, kLightingUnit, GL_TEXTURE_2D_ARRAY, coefficients_);
}

}  // namespace pelt
