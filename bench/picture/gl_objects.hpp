// OpenGL's objects as owned values, and programs whose uniforms are set by name.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/shading/gl_context.hpp"
#include "bench/shading/shading.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/outputs.hpp"

namespace pelt {

template <auto kGen, auto kDelete>
class GlName {
 public:
  explicit GlName(const GlApi& gl) : gl_(&gl) { (gl.*kGen)(1, &name_); }
  GlName(GlName&& other) noexcept : gl_(other.gl_), name_(std::exchange(other.name_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlName() {
    if (name_) (gl_->*kDelete)(1, &name_);
  }
  operator GLuint() const { return name_; }

 private:
  const GlApi* gl_;
  GLuint name_ = 0;
};
using GlBuffer = GlName<&GlApi::GenBuffers, &GlApi::DeleteBuffers>;
using GlFramebuffer = GlName<&GlApi::GenFramebuffers, &GlApi::DeleteFramebuffers>;
using GlTexture = GlName<&GlApi::GenTextures, &GlApi::DeleteTextures>;
using GlVertexArray = GlName<&GlApi::GenVertexArrays, &GlApi::DeleteVertexArrays>;

// Of textures that texelFetch reads: neither filtered nor repeated.
GlTexture MakeTexture(const GlApi& gl, GLenum format, GLsizei width, GLsizei height);
GlTexture MakeTextureArray(const GlApi& gl, GLenum format, const glm::ivec2& size, GLsizei layers);
// What strand.glsl reads by Texel(): 16 bytes a texel; a rest that is none is left out.
GlTexture UploadTexels(const GlApi& gl, std::span<const std::byte> bytes);
// 8-bit texels with four channels, or one (GL_R8), mixed and repeated.
GlTexture UploadImage(const GlApi& gl, GLenum format, const glm::ivec2& size, const void* texels);
// One channel of images of one size as the layers of a texture, mixed and repeated; a white texel where there are none.
GlTexture UploadSheets(const GlApi& gl, std::span<const ControlMap* const> sheets);
void BindTexture(const GlApi& gl, GLint unit, GLenum target, GLuint texture);

// Vertices of floats, attribute behind attribute.
struct GlMesh {
  GlVertexArray array;
  GlBuffer vertices;
};
// `floats`: of each attribute, 1 to 4. `divisor`: instances that share a vertex; 0: none, vertices
// are those of a mesh. No vertex array is bound afterwards.
GlMesh UploadMesh(const GlApi& gl, std::span<const std::byte> vertices,
                  std::span<const GLint> floats, GLuint divisor = 0);

class GlProgram {
 public:
  // Of shader texts without their version line. Fails with the driver's words behind `name`.
  static Result<GlProgram> Make(const GlApi& gl, const char* name, const std::string& vertex,
                                const std::string& fragment);
  GlProgram(GlProgram&& other) noexcept
      : gl_(other.gl_), program_(std::exchange(other.program_, 0)) {}
  GlProgram& operator=(GlProgram&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(program_, other.program_);
    return *this;
  }
  ~GlProgram() {
    if (program_) gl_->DeleteProgram(program_);
  }

  // Until another one is used. Names that the program lacks, or does not need, are passed over.
  void Use() const { gl_->UseProgram(program_); }
  void BindBlock(const char* name, GLuint point) const {
    const GLuint block = gl_->GetUniformBlockIndex(program_, name);
    if (block != GL_INVALID_INDEX) gl_->UniformBlockBinding(program_, block, point);
  }
  void Set(const char* name, int value) const { gl_->Uniform1i(At(name), value); }
  void Set(const char* name, uint32_t value) const { Set(name, int(value)); }
  void Set(const char* name, float value) const { gl_->Uniform1f(At(name), value); }
  void Set(const char* name, const glm::ivec2& v) const { gl_->Uniform2i(At(name), v.x, v.y); }
  void Set(const char* name, const glm::vec2& v) const { gl_->Uniform2fv(At(name), 1, &v.x); }
  void Set(const char* name, const glm::vec3& v) const { gl_->Uniform3fv(At(name), 1, &v.x); }
  void Set(const char* name, const glm::vec4& v) const { gl_->Uniform4fv(At(name), 1, &v.x); }
  void Set(const char* name, const glm::mat3& m) const {
    gl_->UniformMatrix3fv(At(name), 1, GL_FALSE, &m[0].x);
  }
  void Set(const char* name, const glm::mat4& m) const {
    gl_->UniformMatrix4fv(At(name), 1, GL_FALSE, &m[0].x);
  }

 private:
  GlProgram(const GlApi& gl, GLuint program) : gl_(&gl), program_(program) {}
  GLint At(const char* name) const { return gl_->GetUniformLocation(program_, name); }

  const GlApi* gl_;
  GLuint program_;
};

// The renderer's programs, from bench/shading/shaders/passes, and the texture units that they share.

// What lies where as long as something is drawn.
enum GlUnit : GLint {
  kVerticesUnit,
  kRootsUnit,
  kLooksUnit,
  kShadowMapsUnit,
  kCharactersUnit,
  kSoftMapsUnit,
  kLightingUnit,
  kSurfaceUnit,
  kSourceUnit,
  kHeightsUnit,
  kStripsUnit,
  kCoversUnit,
  kGrowthUnit,
  kMakingUnit  // where textures are made
};

struct GlPrograms {
  // For each output of strands, in kOutputs' order; once MakeCards was called, as many again for layers with cards.
  std::vector<GlProgram> strand_light, strand_buffered, strand_depth, strand_shadow;
  std::vector<GlProgram> others;

  enum Other {
    kBody,
    kBodyShadow,
    kEye,
    kLighting,
    kSoften,
    kResolve,
    kShell,
    kShellShadow,
    kRelief,
    kFin
  };
  const GlProgram& operator[](Other other) const { return others[other]; }

  static Result<GlPrograms> Make(const GlApi& gl);
  // Unless it was called before. Throws Error with the driver's words.
  void MakeCards(const GlApi& gl);
  // Calls set(program), in use, for each.
  template <class Set>
  void ForEach(const Set& set) const {
    for (const auto* list :
         {&strand_light, &strand_buffered, &strand_depth, &strand_shadow, &others})
      for (const GlProgram& program : *list) {
        program.Use();
        set(program);
      }
  }

 private:
  // Words of the driver, if it refuses; `defines` come before each text.
  std::string AddStrands(const GlApi& gl, std::string_view defines);
  void SetUnits() const;
};

// Sets the uniforms of passes/painted.glsl; of a program in use.
void SetPaint(const GlProgram& program, const PaintLook& paint);

// Blurring on the graphics card.

struct GlLayer {
  GLuint texture;  // an array
  GLint layer;
};

// Running means of 2 `reach` + 1 texels, `turns` times along each side, of `from` times `scale` and at most 1. Both
// are of this size. By GlPrograms' `soften`, into the framebuffer that is bound, which needs no depth.
void Soften(const GlApi& gl, const GlProgram& program, GlLayer from, GlLayer to,
            const glm::ivec2& size, int reach, int turns, float scale);

}  // namespace pelt
