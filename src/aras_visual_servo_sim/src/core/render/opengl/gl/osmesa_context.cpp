// clang-format off: the types of OpenGL's functions first, as osmesa.h brings gl.h without them
#include "gl_context.hpp"
// clang-format on

#include <GL/osmesa.h>

#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "shared_library.hpp"

namespace aras_visual_servo_sim {
namespace {

struct Library {
  decltype(&OSMesaCreateContextAttribs) create;
  decltype(&OSMesaDestroyContext) destroy;
  decltype(&OSMesaMakeCurrent) make_current;
  decltype(&OSMesaGetProcAddress) address;
};

/** Files that may hold it: the one that the environment names, else Debian's. */
std::vector<std::string> namesOfLibrary() {
  if (const char* name = std::getenv("ARAS_VISUAL_SERVO_OSMESA")) return {name};
  return {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
}

const Library& library() {
  static const Library opened = [] {
    prepareMesa();
    const SharedLibrary file("renderer 'opengl'", namesOfLibrary(), "libosmesa6");
    Library found{};
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
