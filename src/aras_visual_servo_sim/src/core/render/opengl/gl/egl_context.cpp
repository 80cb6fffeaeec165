#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "gl_context.hpp"
#include "shared_library.hpp"

namespace aras_visual_servo_sim {
namespace {

struct Library {
  decltype(&eglGetProcAddress) address;
  decltype(&eglInitialize) initialize;
  decltype(&eglBindAPI) bind_api;
  decltype(&eglChooseConfig) choose;
  decltype(&eglCreateContext) create;
  decltype(&eglDestroyContext) destroy;
  decltype(&eglMakeCurrent) make_current;
  EGLDisplay display = EGL_NO_DISPLAY;
};

const Library& library() {
  static const Library opened = [] {
    prepareMesa();
    const SharedLibrary file("gl 'egl'", {"libEGL.so.1"}, "libegl1");
    Library found{};
    file.find(found.address, "eglGetProcAddress");
    file.find(found.initialize, "eglInitialize");
    file.find(found.bind_api, "eglBindAPI");
    file.find(found.choose, "eglChooseConfig");
    file.find(found.create, "eglCreateContext");
    file.find(found.destroy, "eglDestroyContext");
    file.find(found.make_current, "eglMakeCurrent");
    decltype(&eglGetPlatformDisplay) display_of = nullptr;
    file.find(display_of, "eglGetPlatformDisplay");
    found.display = display_of(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (found.display == EGL_NO_DISPLAY || !found.initialize(found.display, nullptr, nullptr)) {
      throw RenderError("gl 'egl': found no surfaceless display, needs Mesa's EGL (Debian's package libegl-mesa0)");
    }
    return found;
  }();
  return opened;
}

class EglContext : public GlContext {
 public:
  EglContext() : egl_(library()) {
    const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
    const EGLint version[] = {
        EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    egl_.bind_api(EGL_OPENGL_API);
    if (egl_.choose(egl_.display, wanted, &config, 1, &count) && count > 0) {
      context_ = egl_.create(egl_.display, config, EGL_NO_CONTEXT, version);
    }
    if (context_ == EGL_NO_CONTEXT) throw RenderError("gl 'egl': EGL gives no context of OpenGL 3.3, core profile");
    const Binding binding(*this);
    gl_ = GlFunctions::load([this](const char* name) { return reinterpret_cast<void*>(egl_.address(name)); });
  }
  ~EglContext() override { egl_.destroy(egl_.display, context_); }

 private:
  void bind() override {
    egl_.bind_api(EGL_OPENGL_API);
    if (!egl_.make_current(egl_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
      throw RenderError("renderer 'opengl': the EGL context was lost");
    }
  }
  void release() override { egl_.make_current(egl_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

  const Library& egl_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlContext> makeEglContext() { return std::make_unique<EglContext>(); }

}  // namespace aras_visual_servo_sim
