#include <algorithm>

#include "bench/picture/gl_objects.hpp"
#include "bench/picture/gl_parts.hpp"
#include "bench/picture/shadows.hpp"
#include "core/character/mesh_repair.hpp"

namespace pelt {
namespace {

constexpr GLsizei kMapSide = GLsizei(kShadowTexels);

}  // namespace

glm::mat3 SunAxes(const glm::vec3& to_sun) {
  const glm::vec3 x(PickTangent(glm::dvec3(to_sun)));
  return {x, glm::cross(to_sun, x), to_sun};
}

GlShadows::GlShadows(const GlApi& gl, const GlPrograms& programs, const PictureScene& scene,
                     const GlBodies& bodies, const GlStrands& strands, const GlShells& shells)
    : gl_(gl),
      balls_(BoundActors(scene)),
      maps_(MakeTextureArray(gl, GL_RGBA32F, glm::ivec2(kMapSide), GLsizei(balls_.size()))),
      soft_(MakeTextureArray(gl, GL_RGBA16F, glm::ivec2(kMapSide), GLsizei(balls_.size()))),
      characters_(UploadCharacters(scene.look.light.to_sun)),
      target_(gl) {
  BindTexture(gl_, kCharactersUnit, GL_TEXTURE_2D, characters_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, target_);
  gl_.Viewport(0, 0, kMapSide, kMapSide);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Enable(GL_BLEND);
  gl_.BlendEquationSeparate(GL_MIN, GL_FUNC_ADD);
  gl_.BlendFunc(GL_ONE, GL_ONE);
  for (uint32_t a = 0; a < balls_.size(); ++a) DrawMap(programs, scene, bodies, strands, shells, a);
  gl_.Disable(GL_BLEND);
  gl_.BlendEquationSeparate(GL_FUNC_ADD, GL_FUNC_ADD);
  for (GLint a = 0; a < GLint(balls_.size()); ++a)
    Soften(gl_, programs[GlPrograms::kSoften], {maps_, a}, {soft_, a}, glm::ivec2(kMapSide),
           kSoftTexels, 2, 1.0f / 255.0f);
  BindTexture(gl_, kShadowMapsUnit, GL_TEXTURE_2D_ARRAY, maps_);
  BindTexture(gl_, kSoftMapsUnit, GL_TEXTURE_2D_ARRAY, soft_);
}

float GlShadows::Lift(uint32_t actor) const {
  return kLiftTexels * 2.0f * balls_[actor].radius / float(kShadowTexels);
}

// A row for each, as shadow_maps.glsl reads it.
GlTexture GlShadows::UploadCharacters(const glm::vec3& to_sun) const {
  const size_t count = balls_.size(), columns = 2 + count;
  std::vector<glm::vec4> texels(count * columns, glm::vec4(0.0f));
  for (size_t a = 0; a < count; ++a) {
    glm::vec4* row = &texels[a * columns];
    row[0] = {balls_[a].centre, balls_[a].radius};
    int maps = 0;
    for (size_t b = 0; b < count; ++b)
      if (a == b || ShadowMeets(balls_[a], balls_[b], to_sun)) row[2 + maps++].x = float(b);
    row[1].x = float(maps);
  }
  gl_.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  GlTexture texture = MakeTexture(gl_, GL_RGBA32F, GLsizei(columns), GLsizei(count));
  gl_.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, GLsizei(columns), GLsizei(count), GL_RGBA, GL_FLOAT,
                    texels.data());
  return texture;
}

void GlShadows::Attach(GLuint texture, uint32_t layer) const {
  gl_.FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture, 0, GLint(layer));
}

void GlShadows::DrawMap(const GlPrograms& programs, const PictureScene& scene,
                        const GlBodies& bodies, const GlStrands& strands, const GlShells& shells,
                        uint32_t actor) const {
  constexpr float kNothing[4] = {1e9f, 1e9f, 1e9f, 0.0f};
  Attach(maps_, actor);
  gl_.ClearBufferfv(GL_COLOR, 0, kNothing);
  const GlProgram& skin = programs[GlPrograms::kBodyShadow];
  skin.Use();
  skin.Set("character", actor);
  bodies.DrawSkin(actor);
  for (size_t layer = 0; layer < strands.layers(); ++layer)
    if (scene.actors[layer] == actor) strands.DrawShadows(programs.strand_shadow, layer);
  const GlProgram& shell = programs[GlPrograms::kShellShadow];
  shell.Use();
  shell.Set("character", actor);
  for (size_t layer = 0; layer < scene.draws.size(); ++layer)
    if (scene.actors[layer] == actor && shells.Has(layer)) shells.DrawShadow(shell, layer);
}

std::vector<glm::vec4> GlShadows::Read(uint32_t actor) const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, target_);
  Attach(maps_, actor);
  std::vector<glm::vec4> texels(size_t(kMapSide) * kMapSide);
  gl_.ReadPixels(0, 0, kMapSide, kMapSide, GL_RGBA, GL_FLOAT, texels.data());
  return texels;
}

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
