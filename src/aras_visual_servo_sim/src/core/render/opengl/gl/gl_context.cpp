#include "gl_context.hpp"

#include <cstdlib>
#include <filesystem>
#include <mutex>

namespace aras_visual_servo_sim {

std::string GlContext::description() const {
  const auto text = [this](GLenum name) {
    const GLubyte* value = gl_.GetString(name);
    return std::string(value ? reinterpret_cast<const char*>(value) : "unknown");
  };
  return text(GL_RENDERER) + ", " + text(GL_VERSION);
}

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

}  // namespace aras_visual_servo_sim
