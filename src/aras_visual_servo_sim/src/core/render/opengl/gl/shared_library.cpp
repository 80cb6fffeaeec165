#include "shared_library.hpp"

#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <utility>

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

}  // namespace

SharedLibrary::SharedLibrary(std::string who, const std::vector<std::string>& names, const std::string& package)
    : who_(std::move(who)) {
  prepareMesa();
  for (const std::string& name : names) {
    handle_ = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    name_ = name;
    if (handle_) return;
  }
  throw RenderError(who_ + ": " + names.front() + " cannot be opened (Debian's package " + package + "): " + dlerror() +
                    "; renderer 'coverage' needs no library");
}

}  // namespace aras_visual_servo_sim
