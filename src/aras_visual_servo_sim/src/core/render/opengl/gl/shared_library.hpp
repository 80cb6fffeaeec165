#pragma once

#include <dlfcn.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

/** A library that is opened at its first use and then stays: llvmpipe does not survive being closed. */
class SharedLibrary {
 public:
  /** @param who      for messages: what wants it, for example "gl 'egl'"
   *  @param names    of its file, the first that can be opened is taken
   *  @param package  Debian's that has it
   *  @throws RenderError naming the library, the package and why it cannot be opened */
  SharedLibrary(std::string who, const std::vector<std::string>& names, const std::string& package);

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

}  // namespace aras_visual_servo_sim
