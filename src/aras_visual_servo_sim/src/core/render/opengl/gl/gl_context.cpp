#include "gl_context.hpp"

#define EGL_NO_X11 1
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <link.h>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "osmesa_library.hpp"
#include "shared_library.hpp"

namespace aras_visual_servo_sim {
namespace {

class OsmesaContext : public GlContext {
 public:
  explicit OsmesaContext(std::shared_ptr<const OsmesaLibrary> library) : library_(std::move(library)) {
    const int wanted[] = {OSMESA_FORMAT,
                          OSMESA_RGBA,
                          OSMESA_DEPTH_BITS,
                          0,
                          OSMESA_PROFILE,
                          OSMESA_CORE_PROFILE,
                          OSMESA_CONTEXT_MAJOR_VERSION,
                          3,
                          OSMESA_CONTEXT_MINOR_VERSION,
                          3,
                          0};
    context_ = library_->create(wanted, nullptr);
    if (!context_) throw RenderError("renderer 'opengl': OSMesa gives no context of OpenGL 3.3, core profile");
    const Binding binding(*this);
    gl_ = GlFunctions::load([this](const char* name) { return reinterpret_cast<void*>(library_->address(name)); });
  }
  ~OsmesaContext() override { library_->destroy(context_); }

 private:
  void bind() override {
    if (!library_->make_current(context_, unused_.data(), GL_UNSIGNED_BYTE, kSide, kSide)) {
      throw RenderError("renderer 'opengl': the OSMesa context was lost");
    }
  }
  void release() override { library_->make_current(nullptr, nullptr, 0, 0, 0); }

  static constexpr int kSide = 8;
  const std::shared_ptr<const OsmesaLibrary> library_;
  OSMesaContext context_ = nullptr;
  std::array<unsigned, kSide * kSide> unused_{};  // OSMesa's own picture: everything is drawn elsewhere
};

struct EglLibrary {
  decltype(&eglGetProcAddress) address;
  decltype(&eglInitialize) initialize;
  decltype(&eglBindAPI) bind_api;
  decltype(&eglChooseConfig) choose;
  decltype(&eglCreateContext) create;
  decltype(&eglDestroyContext) destroy;
  decltype(&eglMakeCurrent) make_current;
  EGLDisplay display = EGL_NO_DISPLAY;
};

/** Mesa's software renderer among EGL's devices; null: EGL does not list it. */
EGLDeviceEXT softwareDevice(decltype(&eglGetProcAddress) address) {
  const auto query = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(address("eglQueryDevicesEXT"));
  const auto text_of = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(address("eglQueryDeviceStringEXT"));
  std::array<EGLDeviceEXT, 64> devices{};
  EGLint count = 0;
  if (!query || !text_of || !query(EGLint(devices.size()), devices.data(), &count)) return nullptr;
  for (int k = 0; k < count; ++k) {
    const char* extensions = text_of(devices[k], EGL_EXTENSIONS);
    if (extensions && std::strstr(extensions, "EGL_MESA_device_software")) return devices[k];
  }
  return nullptr;
}

/** Files that may hold EGL: the one that the environment names, else Debian's. */
std::vector<std::string> eglNames() {
  if (const char* name = std::getenv("ARAS_VISUAL_SERVO_EGL")) return {name};
  return {"libEGL.so.1"};
}

/** @param software  on Mesa's software renderer even where there is a GPU */
EglLibrary openEgl(bool software) {
  const SharedLibrary file("gl 'egl'", eglNames(), "libegl1");
  EglLibrary found{};
  file.find(found.address, "eglGetProcAddress");
  file.find(found.initialize, "eglInitialize");
  file.find(found.bind_api, "eglBindAPI");
  file.find(found.choose, "eglChooseConfig");
  file.find(found.create, "eglCreateContext");
  file.find(found.destroy, "eglDestroyContext");
  file.find(found.make_current, "eglMakeCurrent");
  decltype(&eglGetPlatformDisplay) display_of = nullptr;
  file.find(display_of, "eglGetPlatformDisplay");
  EGLDeviceEXT device = software ? softwareDevice(found.address) : nullptr;
  found.display = device ? display_of(EGL_PLATFORM_DEVICE_EXT, device, nullptr)
                         : display_of(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (found.display == EGL_NO_DISPLAY || !found.initialize(found.display, nullptr, nullptr)) {
    throw RenderError("gl 'egl': found no surfaceless display, needs Mesa's EGL (Debian's package libegl-mesa0)");
  }
  return found;
}

template <bool kSoftware>
const EglLibrary& eglLibrary() {
  static const EglLibrary opened = openEgl(kSoftware);
  return opened;
}

class EglContext : public GlContext {
 public:
  explicit EglContext(const EglLibrary& library) : egl_(library) {
    through_ = ", through EGL";
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

  const EglLibrary& egl_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

/** Drops the pages of one library that were never written to, if it is LLVM's: they are those of its file. */
int dropPages(dl_phdr_info* library, std::size_t, void*) {
  if (!library->dlpi_name || !std::strstr(library->dlpi_name, "libLLVM")) return 0;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  for (int k = 0; k < library->dlpi_phnum; ++k) {
    const ElfW(Phdr)& part = library->dlpi_phdr[k];
    if (part.p_type != PT_LOAD || part.p_flags & PF_W) continue;
    const std::uintptr_t start = (library->dlpi_addr + part.p_vaddr + page - 1) / page * page;
    const std::uintptr_t end = (library->dlpi_addr + part.p_vaddr + part.p_memsz) / page * page;
    if (start < end) madvise(reinterpret_cast<void*>(start), end - start, MADV_DONTNEED);  // advice: may be refused
  }
  return 0;
}

}  // namespace

GlFunctions GlFunctions::load(const std::function<void*(const char*)>& address) {
  GlFunctions gl;
  const auto find = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::decay_t<decltype(function)>>(address(name));
    if (!function)
      throw RenderError(std::string("OpenGL: found no function ") + name + ", needs 3.3 with clip control");
  };
#define ARAS_GL_FIND(name) find(gl.name, "gl" #name);
  ARAS_GL_FUNCTIONS(ARAS_GL_FIND)
#undef ARAS_GL_FIND
  return gl;
}

void GlFunctions::check(const char* step) const {
  const GLenum error = GetError();
  if (error == GL_NO_ERROR) return;
  const char* name = error == GL_OUT_OF_MEMORY       ? "out of memory"
                     : error == GL_INVALID_VALUE     ? "invalid value"
                     : error == GL_INVALID_OPERATION ? "invalid operation"
                                                     : "error";
  throw RenderError(std::string("OpenGL: ") + name + " (" + std::to_string(error) + ") while " + step);
}

std::string GlContext::description() const {
  const auto text = [this](GLenum name) {
    const GLubyte* value = gl_.GetString(name);
    return std::string(value ? reinterpret_cast<const char*>(value) : "unknown");
  };
  return text(GL_RENDERER) + ", " + text(GL_VERSION) + through_;
}

std::unique_ptr<GlContext> makeOsmesaContext() {
  std::shared_ptr<const OsmesaLibrary> library;
  try {
    library = osmesaOfThread();
  } catch (const RenderError& no_osmesa) {
    try {
      return std::make_unique<EglContext>(eglLibrary<true>());
    } catch (const RenderError& no_egl) {
      throw RenderError(no_osmesa.what() + std::string("; ") + no_egl.what());
    }
  }
  return std::make_unique<OsmesaContext>(std::move(library));
}

std::unique_ptr<GlContext> makeEglContext() { return std::make_unique<EglContext>(eglLibrary<false>()); }

void giveBackCompilerMemory() {
  dl_iterate_phdr(&dropPages, nullptr);
  malloc_trim(0);
}

}  // namespace aras_visual_servo_sim
