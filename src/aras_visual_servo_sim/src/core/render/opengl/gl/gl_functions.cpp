#include "gl_functions.hpp"

#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

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

}  // namespace aras_visual_servo_sim
