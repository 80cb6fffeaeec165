#include "osmesa_library.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

OsmesaLibrary openLibrary() {
  setenv("LP_NUM_THREADS", "0", /*overwrite=*/0);
  void* handle = nullptr;
  for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
    handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);  // never closed: llvmpipe does not survive that
    if (handle) break;
  }
  if (!handle) throw RenderError(std::string("libOSMesa cannot be opened (Debian: libosmesa6): ") + dlerror());
  const auto symbol = [&](const char* name) {
    void* address = dlsym(handle, name);
    if (!address) throw RenderError(std::string("libOSMesa has no ") + name);
    return address;
  };
  const auto procAddress = reinterpret_cast<decltype(&OSMesaGetProcAddress)>(symbol("OSMesaGetProcAddress"));
  const auto gl = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::decay_t<decltype(function)>>(procAddress(name));
    if (!function) throw RenderError(std::string("OSMesaGetProcAddress knows no ") + name);
  };
  OsmesaLibrary library{};
  library.createContext = reinterpret_cast<decltype(&OSMesaCreateContextExt)>(symbol("OSMesaCreateContextExt"));
  library.destroyContext = reinterpret_cast<decltype(&OSMesaDestroyContext)>(symbol("OSMesaDestroyContext"));
  library.makeCurrent = reinterpret_cast<decltype(&OSMesaMakeCurrent)>(symbol("OSMesaMakeCurrent"));
  gl(library.clear, "glClear");
  gl(library.clearColor, "glClearColor");
  gl(library.clearDepth, "glClearDepth");
  gl(library.colorPointer, "glColorPointer");
  gl(library.depthFunc, "glDepthFunc");
  gl(library.disable, "glDisable");
  gl(library.drawArrays, "glDrawArrays");
  gl(library.enable, "glEnable");
  gl(library.enableClientState, "glEnableClientState");
  gl(library.finish, "glFinish");
  gl(library.getError, "glGetError");
  gl(library.loadIdentity, "glLoadIdentity");
  gl(library.matrixMode, "glMatrixMode");
  gl(library.ortho, "glOrtho");
  gl(library.vertexPointer, "glVertexPointer");
  gl(library.viewport, "glViewport");
  return library;
}

}  // namespace

const OsmesaLibrary& OsmesaLibrary::instance() {
  static const OsmesaLibrary library = openLibrary();
  return library;
}

}  // namespace aras_visual_servo_sim
