#include "bench/shading/gl_context.hpp"

#define EGL_NO_X11
#define EGL_NO_PLATFORM_SPECIFIC_TYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <string_view>

namespace pelt {
namespace {

constexpr std::string_view kPackages = "(Debian: apt-get install libegl1 libgl1-mesa-dri)";

// What of EGL is called, from a library that was opened.
struct EglApi {
  PFNEGLGETPROCADDRESSPROC GetProcAddress = nullptr;
  PFNEGLGETPLATFORMDISPLAYEXTPROC GetPlatformDisplay = nullptr;
  PFNEGLINITIALIZEPROC Initialize = nullptr;
  PFNEGLTERMINATEPROC Terminate = nullptr;
  PFNEGLBINDAPIPROC BindApi = nullptr;
  PFNEGLCHOOSECONFIGPROC ChooseConfig = nullptr;
  PFNEGLCREATECONTEXTPROC CreateContext = nullptr;
  PFNEGLDESTROYCONTEXTPROC DestroyContext = nullptr;
  PFNEGLMAKECURRENTPROC MakeCurrent = nullptr;

  template <class Function>
  bool Find(Function& function, const char* name) {
    function = reinterpret_cast<Function>(GetProcAddress(name));
    return function != nullptr;
  }
  bool Load(void* library) {
    GetProcAddress =
        reinterpret_cast<PFNEGLGETPROCADDRESSPROC>(dlsym(library, "eglGetProcAddress"));
    return GetProcAddress && Find(GetPlatformDisplay, "eglGetPlatformDisplayEXT") &&
           Find(Initialize, "eglInitialize") && Find(Terminate, "eglTerminate") &&
           Find(BindApi, "eglBindAPI") && Find(ChooseConfig, "eglChooseConfig") &&
           Find(CreateContext, "eglCreateContext") && Find(DestroyContext, "eglDestroyContext") &&
           Find(MakeCurrent, "eglMakeCurrent");
  }
};

}  // namespace

struct GlContext::State {
  void* library = nullptr;
  EglApi egl;
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  GlApi gl;

  ~State() {
    if (context != EGL_NO_CONTEXT) {
      egl.MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      egl.DestroyContext(display, context);
    }
    if (display != EGL_NO_DISPLAY) egl.Terminate(display);
    // The library stays: drivers start threads and leave handlers that point into it.
  }

  // What is missing, or nothing.
  std::string Open() {
    library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) return fmt::format("libEGL.so.1 is not here {}", kPackages);
    if (!egl.Load(library))
      return "libEGL.so.1 lacks a function of EGL 1.4 or eglGetPlatformDisplayEXT";
    display = egl.GetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !egl.Initialize(display, nullptr, nullptr)) {
      display = EGL_NO_DISPLAY;
      return fmt::format("EGL has no driver that draws without a display {}", kPackages);
    }
    return MakeContext();
  }

  std::string MakeContext() {
    const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                              3,
                              EGL_CONTEXT_MINOR_VERSION,
                              3,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                              EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!egl.BindApi(EGL_OPENGL_API) || !egl.ChooseConfig(display, wanted, &config, 1, &count) ||
        count == 0)
      return "EGL's driver has no OpenGL, or none without a window";
    context = egl.CreateContext(display, config, EGL_NO_CONTEXT, version);
    if (context == EGL_NO_CONTEXT) return "the driver has no OpenGL 3.3 core";
    if (!egl.MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
      return "the driver wants a window";
#define PELT_GL_LOAD(name, type) \
  if (!egl.Find(gl.name, "gl" #name)) return "the driver lacks gl" #name;
    PELT_GL_FUNCTIONS(PELT_GL_LOAD)
#undef PELT_GL_LOAD
    return {};
  }
};

Result<GlContext> GlContext::Open() {
  auto state = std::make_shared<State>();
  if (std::string missing = state->Open(); !missing.empty())
    return Failure{"no OpenGL: " + std::move(missing)};
  return GlContext(std::move(state));
}

std::string_view GlContext::ShaderVersion() { return "#version 330 core\n"; }

const GlApi& GlContext::gl() const { return state_->gl; }

std::string GlContext::Renderer() const {
  const auto* name = reinterpret_cast<const char*>(state_->gl.GetString(GL_RENDERER));
  return name ? name : "unnamed";
}

}  // namespace pelt
