// OpenGL 3.3 core without a window, a display or a GPU: EGL's surfaceless platform. The library is looked for when a
// context is asked for, so that nothing needs it to build Pelt, or to run what does not draw with it.
//
// In WebAssembly the same functions are WebGL2's, which the page hands over (bench/viewer).
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
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.hpp"

// Each function that is called, once: the name behind "gl", and the same in capitals for its type.
#define PELT_GL_FUNCTIONS(F)                          \
  F(ActiveTexture, ACTIVETEXTURE)                     \
  F(AttachShader, ATTACHSHADER)                       \
  F(BindBuffer, BINDBUFFER)                           \
  F(BindBufferBase, BINDBUFFERBASE)                   \
  F(BindFramebuffer, BINDFRAMEBUFFER)                 \
  F(BindTexture, BINDTEXTURE)                         \
  F(BindVertexArray, BINDVERTEXARRAY)                 \
  F(BlendEquationSeparate, BLENDEQUATIONSEPARATE)     \
  F(BlendFunc, BLENDFUNC)                             \
  F(BlitFramebuffer, BLITFRAMEBUFFER)                 \
  F(BufferData, BUFFERDATA)                           \
  F(CheckFramebufferStatus, CHECKFRAMEBUFFERSTATUS)   \
  F(Clear, CLEAR)                                     \
  F(ClearBufferfv, CLEARBUFFERFV)                     \
  F(ColorMask, COLORMASK)                             \
  F(CompileShader, COMPILESHADER)                     \
  F(CreateProgram, CREATEPROGRAM)                     \
  F(CreateShader, CREATESHADER)                       \
  F(DeleteBuffers, DELETEBUFFERS)                     \
  F(DeleteFramebuffers, DELETEFRAMEBUFFERS)           \
  F(DeleteProgram, DELETEPROGRAM)                     \
  F(DeleteShader, DELETESHADER)                       \
  F(DeleteTextures, DELETETEXTURES)                   \
  F(DeleteVertexArrays, DELETEVERTEXARRAYS)           \
  F(DepthFunc, DEPTHFUNC)                             \
  F(DepthMask, DEPTHMASK)                             \
  F(Disable, DISABLE)                                 \
  F(DrawArrays, DRAWARRAYS)                           \
  F(DrawArraysInstanced, DRAWARRAYSINSTANCED)         \
  F(Enable, ENABLE)                                   \
  F(EnableVertexAttribArray, ENABLEVERTEXATTRIBARRAY) \
  F(Finish, FINISH)                                   \
  F(FramebufferTexture2D, FRAMEBUFFERTEXTURE2D)       \
  F(FramebufferTextureLayer, FRAMEBUFFERTEXTURELAYER) \
  F(GenBuffers, GENBUFFERS)                           \
  F(GenFramebuffers, GENFRAMEBUFFERS)                 \
  F(GenTextures, GENTEXTURES)                         \
  F(GenVertexArrays, GENVERTEXARRAYS)                 \
  F(GetError, GETERROR)                               \
  F(GetIntegerv, GETINTEGERV)                         \
  F(GetProgramInfoLog, GETPROGRAMINFOLOG)             \
  F(GetProgramiv, GETPROGRAMIV)                       \
  F(GetShaderInfoLog, GETSHADERINFOLOG)               \
  F(GetShaderiv, GETSHADERIV)                         \
  F(GetString, GETSTRING)                             \
  F(GetUniformBlockIndex, GETUNIFORMBLOCKINDEX)       \
  F(GetUniformLocation, GETUNIFORMLOCATION)           \
  F(LinkProgram, LINKPROGRAM)                         \
  F(PixelStorei, PIXELSTOREI)                         \
  F(ReadPixels, READPIXELS)                           \
  F(ShaderSource, SHADERSOURCE)                       \
  F(TexImage2D, TEXIMAGE2D)                           \
  F(TexImage3D, TEXIMAGE3D)                           \
  F(TexParameteri, TEXPARAMETERI)                     \
  F(TexSubImage2D, TEXSUBIMAGE2D)                     \
  F(Uniform1f, UNIFORM1F)                             \
  F(Uniform1i, UNIFORM1I)                             \
  F(Uniform2i, UNIFORM2I)                             \
  F(Uniform2fv, UNIFORM2FV)                           \
  F(Uniform3fv, UNIFORM3FV)                           \
  F(Uniform4fv, UNIFORM4FV)                           \
  F(UniformBlockBinding, UNIFORMBLOCKBINDING)         \
  F(UniformMatrix3fv, UNIFORMMATRIX3FV)               \
  F(UniformMatrix4fv, UNIFORMMATRIX4FV)               \
  F(UseProgram, USEPROGRAM)                           \
  F(VertexAttribDivisor, VERTEXATTRIBDIVISOR)         \
  F(VertexAttribPointer, VERTEXATTRIBPOINTER)         \
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
  GlContext(GlContext&&) noexcept = default;
  GlContext& operator=(GlContext&&) noexcept = default;

  const GlApi& gl() const;
  // The first line of each shader.
  static std::string_view ShaderVersion();
  // Of the driver, as "llvmpipe (LLVM 15.0.6, 256 bits)".
  std::string Renderer() const;

 private:
  struct State;
  explicit GlContext(std::shared_ptr<State> state) : state_(std::move(state)) {}
  // Of one owner: a unique_ptr could not end what is only declared here.
  std::shared_ptr<State> state_;
};

// The files of bench/shading/shaders, by name, as CMakeLists.txt put them into the program, so that the command runs
// from anywhere; and programs of them for a graphics card.

struct ShaderFile {
  std::string_view name, text;
};

std::span<const ShaderFile> EmbeddedShaders();

// The file's text behind those that it names in lines "// After:", without a version line; empty where there is no
// such file.
std::string ShaderText(std::string_view file);
// The file's alone.
std::string_view OwnText(std::string_view file);

// A linked program; the caller deletes it. Fails with the driver's words. The texts get "#version 330 core" first.
Result<GLuint> MakeProgram(const GlApi& gl, const std::string& vertex, const std::string& fragment);

}  // namespace pelt
