// clang-format off: the types of OpenGL's functions first, as osmesa.h brings gl.h without them
#include "gl_context.hpp"
// clang-format on

#define EGL_NO_X11 1
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/osmesa.h>
#include <dlfcn.h>
#include <link.h>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Sets, once in a process and before Mesa reads them, what it takes from the environment, unless the user has:
 *  LP_NUM_THREADS=0, for frames are so small that they are drawn fastest in the calling thread, and
 *  MESA_SHADER_CACHE_DIR, for compiled shaders: $ROS_HOME or ~/.ros, folder aras_visual_servo. */
void prepareMesa() {
  static std::once_flag once;
  std::call_once(once, [] {
    setenv("LP_NUM_THREADS", "0", /*overwrite=*/0);
    if (std::getenv("MESA_SHADER_CACHE_DIR")) return;
    const char *ros_home = std::getenv("ROS_HOME"), *home = std::getenv("HOME");
    std::filesystem::path folder = ros_home ? std::filesystem::path(ros_home)
                                   : home   ? std::filesystem::path(home) / ".ros"
                                            : std::filesystem::path();
    std::error_code fault;
    if (!folder.empty()) std::filesystem::create_directories(folder /= "aras_visual_servo", fault);
    if (folder.empty() || fault) {
      setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);  // nowhere to keep it
    } else {
      setenv("MESA_SHADER_CACHE_DIR", folder.c_str(), 0);
    }
  });
}

/** A library that is opened at its first use and then stays: llvmpipe does not survive being closed. */
class SharedLibrary {
 public:
  /** @param who      for messages: what wants it, for example "gl 'egl'"
   *  @param names    of its file, the first that can be opened is taken
   *  @param package  Debian's that has it
   *  @throws RenderError naming the library, the package and why it cannot be opened */
  SharedLibrary(std::string who, const std::vector<std::string>& names, const std::string& package)
      : who_(std::move(who)) {
    prepareMesa();
    for (const std::string& name : names) {
      handle_ = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
      name_ = name;
      if (handle_) return;
    }
    throw RenderError(who_ + ": " + names.front() + " cannot be opened (Debian's package " + package +
                      "): " + dlerror() + "; renderer 'coverage' needs no library");
  }

  /** Finds a function. @throws RenderError naming it if the library has none of this name */
  template <typename Function>
  void find(Function& function, const char* name) const {
    function = reinterpret_cast<Function>(dlsym(handle_, name));
    if (!function) throw RenderError(who_ + ": " + name_ + " has no function " + name);
  }

 private:
  std::string who_, name_;
  void* handle_ = nullptr;
};

struct OsmesaLibrary {
  decltype(&OSMesaCreateContextAttribs) create;
  decltype(&OSMesaDestroyContext) destroy;
  decltype(&OSMesaMakeCurrent) make_current;
  decltype(&OSMesaGetProcAddress) address;
};

/** Files that may hold it: the one that the environment names, else Debian's. */
std::vector<std::string> namesOfOsmesa() {
  if (const char* name = std::getenv("ARAS_VISUAL_SERVO_OSMESA")) return {name};
  return {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
}

const OsmesaLibrary& osmesaLibrary() {
  static const OsmesaLibrary opened = [] {
    const SharedLibrary file("renderer 'opengl'", namesOfOsmesa(), "libosmesa6");
    OsmesaLibrary found{};
    file.find(found.create, "OSMesaCreateContextAttribs");
    file.find(found.destroy, "OSMesaDestroyContext");
    file.find(found.make_current, "OSMesaMakeCurrent");
    file.find(found.address, "OSMesaGetProcAddress");
    return found;
  }();
  return opened;
}

class OsmesaContext : public GlContext {
 public:
  OsmesaContext() : library_(osmesaLibrary()) {
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
    context_ = library_.create(wanted, nullptr);
    if (!context_) throw RenderError("renderer 'opengl': OSMesa gives no context of OpenGL 3.3, core profile");
    const Binding binding(*this);
    gl_ = GlFunctions::load([this](const char* name) { return reinterpret_cast<void*>(library_.address(name)); });
  }
  ~OsmesaContext() override { library_.destroy(context_); }

 private:
  void bind() override {
    if (!library_.make_current(context_, unused_.data(), GL_UNSIGNED_BYTE, kSide, kSide)) {
      throw RenderError("renderer 'opengl': the OSMesa context was lost");
    }
  }
  void release() override { library_.make_current(nullptr, nullptr, 0, 0, 0); }

  static constexpr int kSide = 8;
  const OsmesaLibrary& library_;
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

const EglLibrary& eglLibrary() {
  static const EglLibrary opened = [] {
    const SharedLibrary file("gl 'egl'", {"libEGL.so.1"}, "libegl1");
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
  EglContext() : egl_(eglLibrary()) {
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
  return text(GL_RENDERER) + ", " + text(GL_VERSION);
}

std::unique_ptr<GlContext> makeOsmesaContext() { return std::make_unique<OsmesaContext>(); }

std::unique_ptr<GlContext> makeEglContext() { return std::make_unique<EglContext>(); }

void giveBackCompilerMemory() {
  dl_iterate_phdr(&dropPages, nullptr);
  malloc_trim(0);
}

}  // namespace aras_visual_servo_sim
