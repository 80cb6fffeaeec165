#pragma once

#include <string>
#include <type_traits>
#include <vector>

namespace aras_visual_servo_sim {

/** A library that is opened when somebody first draws with it, and then stays: llvmpipe does not survive being closed.
 */
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
    function = reinterpret_cast<Function>(symbol(name));
  }

 private:
  void* symbol(const char* name) const;

  std::string who_, name_;
  void* handle_ = nullptr;
};

}  // namespace aras_visual_servo_sim
