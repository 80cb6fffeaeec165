// clang-format off: the types of OpenGL's functions first, as osmesa.h brings gl.h without them
#include "gl_context.hpp"
// clang-format on

#include <GL/osmesa.h>
#include <dlfcn.h>

#include <array>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

struct Library {
  decltype(&OSMesaCreateContextAttribs) create;
  decltype(&OSMesaDestroyContext) destroy;
  decltype(&OSMesaMakeCurrent) make_current;
  decltype(&OSMesaGetProcAddress) address;
};

const Library& library() {
  static const Library opened = [] {
    prepareMesa();
    void* handle = nullptr;
    for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
      handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);  // never closed: llvmpipe does not survive that
      if (handle) break;
    }
    if (!handle) {
      throw RenderError(std::string("renderer 'opengl': libOSMesa cannot be opened (Debian's package libosmesa6): ") +
                        dlerror() + "; renderer 'coverage' needs no library");
    }
    const auto symbol = [handle](auto& function, const char* name) {
      function = reinterpret_cast<std::decay_t<decltype(function)>>(dlsym(handle, name));
      if (!function) throw RenderError(std::string("renderer 'opengl': libOSMesa has no function ") + name);
    };
    Library found{};
    symbol(found.create, "OSMesaCreateContextAttribs");
    symbol(found.destroy, "OSMesaDestroyContext");
    symbol(found.make_current, "OSMesaMakeCurrent");
    symbol(found.address, "OSMesaGetProcAddress");
    return found;
  }();
  return opened;
}

class OsmesaContext : public GlContext {
 public:
  OsmesaContext() : library_(library()) {
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
  const Library& library_;
  OSMesaContext context_ = nullptr;
  std::array<unsigned, kSide * kSide> unused_{};  // OSMesa's own picture: everything is drawn elsewhere
};

}  // namespace

std::unique_ptr<GlContext> makeOsmesaContext() { return std::make_unique<OsmesaContext>(); }

}  // namespace aras_visual_servo_sim
