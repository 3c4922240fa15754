#include "bench/picture/gl_renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>

#include "bench/picture/gl_parts.hpp"
#include "bench/picture/shadows.hpp"

namespace pelt {
namespace {

constexpr uint32_t kSamples = 2;

// The block `Look` of frame.glsl, by the rules of std140: vectors of three take the room of four.
struct LookBlock140 {
  std::array<glm::vec4, sizeof(LightSet) / sizeof(glm::vec3)> light;
  HairLook hair;
  float pad[2];
};
static_assert(sizeof(LightSet) == 20 * sizeof(glm::vec3));
static_assert(sizeof(HairLook) == 18 * sizeof(float));

LookBlock140 Look140(const PictureLook& look) {
  LookBlock140 block{.light = {}, .hair = look.hair, .pad = {}};
  std::array<glm::vec3, 20> vectors;
  std::memcpy(vectors.data(), &look.light, sizeof(look.light));
  for (size_t i = 0; i < vectors.size(); ++i) block.light[i] = glm::vec4(vectors[i], 0.0f);
  return block;
}

// What is drawn, as the graphics card has it.
struct Uploaded {
  GlBodies bodies;
  GlRelief relief;
  GlStrands strands;
  GlShells shells;
  GlShadows shadows;

  Uploaded(const GlApi& gl, const GlPrograms& programs, const GlStrips& strips,
           const PictureScene& scene)
      : bodies(gl, scene),
        relief(gl, scene),
        strands(gl, scene, strips.texture()),
        shells(gl, scene),
        shadows(gl, programs, scene, bodies, strands, shells) {}
};

// How the picture looks into the world.
struct Lens {
  glm::vec3 eye, ahead, right, up;  // the last two from the middle to the edges, where ahead is 1 m
  glm::mat4 world_to_clip;
};

Lens LensOf(const Camera& camera, const PictureOptions& options) {
  const glm::vec3 eye = VecOf(camera.eye);
  const float aspect = float(options.width_px) / float(options.height_px);
  const glm::mat4 view = glm::lookAt(eye, VecOf(camera.target), VecOf(camera.up));
  const float height = std::tan(0.5f * camera.vertical_fov_rad);
  const auto row = [&](int r) { return glm::vec3(view[0][r], view[1][r], view[2][r]); };
  return {eye, -row(2), row(0) * (height * aspect), row(1) * height,
          glm::perspective(camera.vertical_fov_rad, aspect, camera.near_m, camera.far_m) * view};
}

// Of passes/relief.frag, in use.
void SetRelief(const GlProgram& program, const ReliefShow& show) {
  program.Set("relief_steps", glm::vec2(show.march.least, show.march.most));
  program.Set("relief_frame", float(show.frame));
  program.Set("relief_wind", show.march.wind);
  program.Set("relief_pan", show.march.pan);
  program.Set("relief_shows_steps", int(show.shows_steps));
}

}  // namespace

struct GlRenderer::State {
  GlContext context;
  GlPrograms programs;
  GlVertexArray no_array;
  GlBuffer look;
  GlStrips strips;

  State(GlContext opened, GlPrograms made)
      : context(std::move(opened)),
        programs(std::move(made)),
        no_array(context.gl()),
        look(context.gl()),
        strips(context.gl()) {}

  const GlApi& gl() const { return context.gl(); }
  // What cards of hairs need, if there are any.
  void MakeCards(const PictureScene& scene) {
    const uint32_t own = CountStrips(scene.layers);
    const bool artists = std::ranges::any_of(scene.strips, [](const auto& s) { return bool(s); });
    if (own == 0 && !artists) return;
    programs.MakeCards(gl());
    strips.Make(std::max(own, 1u));
  }
  void SetScene(const PictureScene& scene, const PictureOptions& options, uint32_t samples) const;
  void SetLook(const PictureLook& lit_by) const;
  void DrawActor(const PictureScene& scene, uint32_t actor, const Uploaded& uploaded) const;
  void DrawLayer(const PictureScene& scene, const PictureOptions& options,
                 const std::vector<GlProgram>& lit, size_t layer, const Uploaded& uploaded) const;
  void DrawScene(const PictureScene& scene, const PictureOptions& options,
                 const Uploaded& uploaded) const;
  // Draws all of it, and calls take() while a framebuffer of the picture's pixels is bound, its rows from the top.
  template <class Take>
  void DrawPixels(const PictureScene& scene, const PictureOptions& options, const Take& take);
  void Resolve(const PictureScene& scene, const PictureOptions& options, GLuint drawn,
               GLuint pixels, uint32_t samples) const;
  void CheckErrors() const;
};

GlRenderer::GlRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
GlRenderer::GlRenderer(GlRenderer&&) noexcept = default;
GlRenderer& GlRenderer::operator=(GlRenderer&&) noexcept = default;
GlRenderer::~GlRenderer() = default;

Result<GlRenderer> GlRenderer::Open() {
  Result<GlContext> context = GlContext::Open();
  if (!context) return Failure{context.error()};
  Result<GlPrograms> programs = GlPrograms::Make(context->gl());
  if (!programs)
    return Failure{
        fmt::format("{} does not take the shaders: {}", context->Renderer(), programs.error())};
  return GlRenderer(std::make_unique<State>(*std::move(context), *std::move(programs)));
}

std::string GlRenderer::Device() const { return state_->context.Renderer(); }

void GlRenderer::State::SetScene(const PictureScene& scene, const PictureOptions& options,
                                 uint32_t samples) const {
  const Lens lens = LensOf(scene.camera, options);
  const glm::mat3 axes = SunAxes(scene.look.light.to_sun);
  const ShadowLook& shadow = scene.look.shadow;
  const glm::vec2 size(options.width_px * samples, options.height_px * samples);
  programs.ForEach([&](const GlProgram& program) {
    program.Set("world_to_clip", lens.world_to_clip);
    program.Set("eye", lens.eye);
    program.Set("sun_axes", axes);
    program.Set("shadow_look", glm::vec3(shadow.bias, shadow.falloff, shadow.strength));
    program.Set("map_side", float(kShadowTexels));
    program.Set("target_size", size);
    program.Set("samples_at_1m", 0.5f * size.y / std::tan(0.5f * scene.camera.vertical_fov_rad));
  });
  SetLook(scene.look);
  gl().BindVertexArray(no_array);
}

void GlRenderer::State::SetLook(const PictureLook& lit_by) const {
  const LookBlock140 block = Look140(lit_by);
  gl().BindBufferBase(GL_UNIFORM_BUFFER, 0, look);
  gl().BufferData(GL_UNIFORM_BUFFER, sizeof(block), &block, GL_STREAM_DRAW);
}

// Skin, the relief on it, eyes.
void GlRenderer::State::DrawActor(const PictureScene& scene, uint32_t actor,
                                  const Uploaded& uploaded) const {
  SetLook(scene.body_looks[actor]);
  const auto use = [&](GlPrograms::Other name) -> const GlProgram& {
    const GlProgram& program = programs[name];
    program.Use();
    program.Set("character", actor);
    program.Set("lift", uploaded.shadows.Lift(actor));
    return program;
  };
  const GlProgram& body = use(GlPrograms::kBody);
  SetPaint(body, scene.bodies[actor].paint_look);
  body.Set("depth_floor", scene.body_looks[actor].depth_floor);
  uploaded.bodies.DrawSkin(actor);
  if (uploaded.relief.Has(actor)) {
    gl().DepthFunc(GL_LEQUAL);
    gl().Enable(GL_BLEND);
    gl().BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    const GlProgram& relief = use(GlPrograms::kRelief);
    SetRelief(relief, scene.relief);
    uploaded.relief.Draw(relief, actor, [&](size_t layer) {
      const PictureLook& lit_by = scene.relief_looks[actor][layer];
      SetLook(lit_by);
      relief.Set("depth_floor", lit_by.depth_floor);
    });
    gl().Disable(GL_BLEND);
    gl().DepthFunc(GL_LESS);
    SetLook(scene.body_looks[actor]);
  }
  gl().BindVertexArray(no_array);
  uploaded.bodies.DrawEyes(use(GlPrograms::kEye), scene.bodies[actor].eyes);
}

void GlRenderer::State::DrawLayer(const PictureScene& scene, const PictureOptions& options,
                                  const std::vector<GlProgram>& lit, size_t layer,
                                  const Uploaded& uploaded) const {
  const uint32_t actor = scene.actors[layer];
  SetLook(scene.layer_looks[layer]);
  gl().Enable(GL_BLEND);
  gl().BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  if (uploaded.shells.Has(layer)) {
    const GlProgram& shell = programs[GlPrograms::kShell];
    shell.Use();
    shell.Set("character", actor);
    shell.Set("lift", uploaded.shadows.Lift(actor));
    uploaded.shells.Draw(shell, layer, scene.draws[layer].shells.shell, options.shells_one_by_one);
  }
  gl().DepthMask(GL_FALSE);
  if (uploaded.shells.HasFins(layer)) {
    const GlProgram& fin = programs[GlPrograms::kFin];
    fin.Use();
    fin.Set("character", actor);
    fin.Set("lift", uploaded.shadows.Lift(actor));
    uploaded.shells.DrawFins(fin, layer, scene.draws[layer].shells);
  }
  for (const GlProgram& program : lit) {
    program.Use();
    program.Set("depth_floor",
                DepthFloor(scene.bodies[actor].mean_covered, scene.layer_looks[layer].depth_floor));
  }
  uploaded.strands.DrawStrips(lit, layer);
  gl().Disable(GL_BLEND);
  gl().DepthMask(GL_TRUE);
}

// Into the framebuffer that is bound.
void GlRenderer::State::DrawScene(const PictureScene& scene, const PictureOptions& options,
                                  const Uploaded& uploaded) const {
  constexpr float kNothing[4] = {}, kFar = 1.0f;
  gl().DepthMask(GL_TRUE);
  gl().ClearBufferfv(GL_COLOR, 0, kNothing);
  gl().ClearBufferfv(GL_DEPTH, 0, &kFar);
  gl().Enable(GL_DEPTH_TEST);
  gl().DepthFunc(GL_LESS);
  for (uint32_t a = 0; a < scene.bodies.size(); ++a) DrawActor(scene, a, uploaded);
  const std::vector<GlProgram>& lit =
      options.lighting_buffer ? programs.strand_buffered : programs.strand_light;
  for (size_t layer = 0; layer < uploaded.strands.layers(); ++layer) {
    DrawLayer(scene, options, lit, layer, uploaded);
    if (layer + 1 == uploaded.strands.layers()) break;
    gl().ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    uploaded.strands.DrawStrips(programs.strand_depth, layer);
    gl().ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
  gl().Disable(GL_DEPTH_TEST);
}

void GlRenderer::State::Resolve(const PictureScene& scene, const PictureOptions& options,
                                GLuint drawn, GLuint pixels, uint32_t samples) const {
  const Lens lens = LensOf(scene.camera, options);
  const GLsizei width = GLsizei(options.width_px), height = GLsizei(options.height_px);
  gl().FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
  gl().FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, pixels, 0);
  gl().Viewport(0, 0, width, height);
  const GlProgram& program = programs[GlPrograms::kResolve];
  program.Use();
  BindTexture(gl(), kSourceUnit, GL_TEXTURE_2D, drawn);
  program.Set("samples", samples);
  program.Set("ray_ahead", lens.ahead);
  program.Set("ray_right", lens.right);
  program.Set("ray_up", lens.up);
  program.Set("character_count", int(scene.bodies.size()));
  program.Set("room_light", scene.look.room);
  gl().DrawArrays(GL_TRIANGLES, 0, 3);
}

void GlRenderer::State::CheckErrors() const {
  if (const GLenum error = gl().GetError(); error != GL_NO_ERROR)
    throw Error(fmt::format("picture: {} reports OpenGL's error {:#x}", context.Renderer(), error));
}

template <class Take>
void GlRenderer::State::DrawPixels(const PictureScene& scene, const PictureOptions& options,
                                   const Take& take) {
  const GlApi& gl = this->gl();
  const uint32_t samples = options.samples ? options.samples : kSamples;
  const GLsizei width = GLsizei(options.width_px * samples),
                height = GLsizei(options.height_px * samples);
  GLint most = 0, most_maps = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  gl.GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most_maps);
  if (scene.bodies.size() > size_t(most_maps))
    throw Error(fmt::format("picture: {} draws at most {} characters, and there are {}",
                            context.Renderer(), most_maps, scene.bodies.size()));
  if (std::max(width, height) > most)
    throw Error(
        fmt::format("picture: {} draws at most {} samples a side, and {} x {} pixels of {} x {} "
                    "samples are {} x {}",
                    context.Renderer(), most, options.width_px, options.height_px, samples, samples,
                    width, height));
  MakeCards(scene);
  SetScene(scene, options, samples);
  const Uploaded uploaded(gl, programs, strips, scene);
  std::optional<GlLighting> lighting;
  if (options.lighting_buffer)
    lighting.emplace(gl, programs, scene, uploaded.bodies, uploaded.shadows, options);
  gl.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  const GlTexture drawn = MakeTexture(gl, GL_RGBA16F, width, height);
  const GlTexture depth = MakeTexture(gl, GL_DEPTH_COMPONENT32F, width, height);
  const GlFramebuffer target(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, drawn, 0);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(fmt::format("picture: {} does not draw into half floats", context.Renderer()));
  gl.Viewport(0, 0, width, height);
  DrawScene(scene, options, uploaded);
  gl.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  const GlTexture pixels =
      MakeTexture(gl, GL_RGBA8, GLsizei(options.width_px), GLsizei(options.height_px));
  Resolve(scene, options, drawn, pixels, samples);
  take();
  CheckErrors();
}

std::vector<uint8_t> GlRenderer::Draw(const PictureScene& scene, const PictureOptions& options) {
  std::vector<uint8_t> rgb(size_t(options.width_px) * options.height_px * 3);
  state_->DrawPixels(scene, options, [&] {
    state_->gl().PixelStorei(GL_PACK_ALIGNMENT, 1);
    state_->gl().ReadPixels(0, 0, GLsizei(options.width_px), GLsizei(options.height_px), GL_RGB,
                            GL_UNSIGNED_BYTE, rgb.data());
  });
  return rgb;
}

void GlRenderer::Show(const PictureScene& scene, const PictureOptions& options) {
  const GLint width = GLint(options.width_px), height = GLint(options.height_px);
  state_->DrawPixels(scene, options, [&] {
    // What is bound for reading stays the picture.
    state_->gl().BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    state_->gl().BlitFramebuffer(0, 0, width, height, 0, height, width, 0, GL_COLOR_BUFFER_BIT,
                                 GL_NEAREST);
  });
}

std::vector<glm::vec4> GlRenderer::DrawShadowMap(const PictureScene& scene, uint32_t actor) {
  state_->MakeCards(scene);
  state_->SetScene(scene, {}, kSamples);
  const Uploaded uploaded(state_->gl(), state_->programs, state_->strips, scene);
  std::vector<glm::vec4> texels = uploaded.shadows.Read(actor);
  state_->CheckErrors();
  return texels;
}

}  // namespace pelt
