#include "shared_library.hpp"

#include <dlfcn.h>

#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

SharedLibrary::SharedLibrary(std::string who, const std::vector<std::string>& names, const std::string& package)
    : who_(std::move(who)) {
  for (const std::string& name : names) {
    handle_ = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle_) continue;
    name_ = name;
    return;
  }
  throw RenderError(who_ + ": " + names.front() + " cannot be opened (Debian's package " + package + "): " + dlerror() +
                    "; renderer 'coverage' needs no library");
}

void* SharedLibrary::symbol(const char* name) const {
  void* found = dlsym(handle_, name);
  if (!found) throw RenderError(who_ + ": " + name_ + " has no function " + name);
  return found;
}

}  // namespace aras_visual_servo_sim
