#include "tags/tag_finder.hpp"

#include <dlfcn.h>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {
namespace {

/** The file beside the one that holds this function. */
std::string installedLibrary() {
  Dl_info here;
  if (dladdr(reinterpret_cast<void*>(&installedLibrary), &here) == 0) return kAprilTagLibrary;
  const std::string file = here.dli_fname;
  return file.substr(0, file.rfind('/') + 1) + kAprilTagLibrary;
}

}  // namespace

std::unique_ptr<TagFinder> openTagFinder(const std::string& family, const std::string& library) {
  const std::string file = library.empty() ? installedLibrary() : library;
  void* handle = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);  // the same one each time, which nobody closes
  void* function = handle ? dlsym(handle, kNewAprilTagFinder) : nullptr;
  if (!function) throw ArasError("tag: the library that finds AprilTags cannot be used: " + std::string(dlerror()));
  return std::unique_ptr<TagFinder>(reinterpret_cast<NewAprilTagFinder*>(function)(family.c_str()));
}

}  // namespace aras_visual_servo_camera
