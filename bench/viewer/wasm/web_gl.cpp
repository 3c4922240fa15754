// gl_context.hpp in a page: each function is an import of the module, and the page's context is WebGL2
// (bench/viewer/webgl.js). There is one, that of the canvas which the page handed over.
#include <type_traits>

#include "bench/shading/gl_context.hpp"

namespace pelt {
namespace {

#define PELT_GL_IMPORT(name, type)                                    \
  extern "C" __attribute__((import_module("gl"), import_name(#name))) \
  std::remove_pointer_t<PFNGL##type##PROC>                            \
      web_gl_##name;
PELT_GL_FUNCTIONS(PELT_GL_IMPORT)
#undef PELT_GL_IMPORT

}  // namespace

struct GlContext::State {
  GlApi gl;
};

Result<GlContext> GlContext::Open() {
  auto state = std::make_shared<State>();
#define PELT_GL_TAKE(name, type) state->gl.name = web_gl_##name;
  PELT_GL_FUNCTIONS(PELT_GL_TAKE)
#undef PELT_GL_TAKE
  return GlContext(std::move(state));
}

std::string_view GlContext::ShaderVersion() { return "#version 300 es\n"; }

const GlApi& GlContext::gl() const { return state_->gl; }

std::string GlContext::Renderer() const { return "WebGL2"; }

}  // namespace pelt
