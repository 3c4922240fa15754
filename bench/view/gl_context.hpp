// OpenGL 3.3 core without a window, a display or a GPU: EGL's surfaceless platform. The library is looked for when a
// context is asked for, so that nothing needs it to build Pelt, or to run what does not draw with it.
//
//   Result<GlContext> context = GlContext::Open();
//   if (!context) return Skip(context.error());   // names what is missing
//   const GlApi& gl = context->gl();
//   gl.Clear(GL_COLOR_BUFFER_BIT);
//
// A context is current on the thread that opened it, and belongs to it.
#pragma once

#include <GL/glcorearb.h>

#include <memory>
#include <string>

#include "core/error.hpp"

// Each function that is called, once: the name behind "gl", and the same in capitals for its type.
#define PELT_GL_FUNCTIONS(F)                        \
  F(ActiveTexture, ACTIVETEXTURE)                   \
  F(AttachShader, ATTACHSHADER)                     \
  F(BindFramebuffer, BINDFRAMEBUFFER)               \
  F(BindTexture, BINDTEXTURE)                       \
  F(BindVertexArray, BINDVERTEXARRAY)               \
  F(CheckFramebufferStatus, CHECKFRAMEBUFFERSTATUS) \
  F(CompileShader, COMPILESHADER)                   \
  F(CreateProgram, CREATEPROGRAM)                   \
  F(CreateShader, CREATESHADER)                     \
  F(DeleteFramebuffers, DELETEFRAMEBUFFERS)         \
  F(DeleteProgram, DELETEPROGRAM)                   \
  F(DeleteShader, DELETESHADER)                     \
  F(DeleteTextures, DELETETEXTURES)                 \
  F(DeleteVertexArrays, DELETEVERTEXARRAYS)         \
  F(DrawArrays, DRAWARRAYS)                         \
  F(FramebufferTexture2D, FRAMEBUFFERTEXTURE2D)     \
  F(GenFramebuffers, GENFRAMEBUFFERS)               \
  F(GenTextures, GENTEXTURES)                       \
  F(GenVertexArrays, GENVERTEXARRAYS)               \
  F(GetError, GETERROR)                             \
  F(GetProgramInfoLog, GETPROGRAMINFOLOG)           \
  F(GetProgramiv, GETPROGRAMIV)                     \
  F(GetShaderInfoLog, GETSHADERINFOLOG)             \
  F(GetShaderiv, GETSHADERIV)                       \
  F(GetString, GETSTRING)                           \
  F(GetUniformLocation, GETUNIFORMLOCATION)         \
  F(LinkProgram, LINKPROGRAM)                       \
  F(ReadPixels, READPIXELS)                         \
  F(ShaderSource, SHADERSOURCE)                     \
  F(TexImage2D, TEXIMAGE2D)                         \
  F(TexParameteri, TEXPARAMETERI)                   \
  F(Uniform1i, UNIFORM1I)                           \
  F(UseProgram, USEPROGRAM)                         \
  F(Viewport, VIEWPORT)

namespace pelt {

struct GlApi {
#define PELT_GL_MEMBER(name, type) PFNGL##type##PROC name = nullptr;
  PELT_GL_FUNCTIONS(PELT_GL_MEMBER)
#undef PELT_GL_MEMBER
};

class GlContext {
 public:
  // Fails where no libEGL, no driver for it or no OpenGL 3.3 is here, and says which.
  static Result<GlContext> Open();
  GlContext(GlContext&&) noexcept;
  GlContext& operator=(GlContext&&) noexcept;
  ~GlContext();

  const GlApi& gl() const;
  // Of the driver, as "llvmpipe (LLVM 15.0.6, 256 bits)".
  std::string Renderer() const;

 private:
  struct State;
  explicit GlContext(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pelt
