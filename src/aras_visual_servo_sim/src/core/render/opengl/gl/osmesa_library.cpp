#include "osmesa_library.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <iterator>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "shared_library.hpp"

namespace aras_visual_servo_sim {
namespace {

struct Instance {
  OsmesaLibrary library;
  std::thread::id user;
  int held = 0;
};

/** @param names  of its file, the first that can be opened is taken @throws RenderError */
OsmesaLibrary openOsmesa(const std::vector<std::string>& names) {
  const SharedLibrary file("renderer 'opengl'", names, "libosmesa6");
  OsmesaLibrary found{};
  file.find(found.create, "OSMesaCreateContextAttribs");
  file.find(found.destroy, "OSMesaDestroyContext");
  file.find(found.make_current, "OSMesaMakeCurrent");
  file.find(found.address, "OSMesaGetProcAddress");
  return found;
}

/** Files that may hold it: the one that the environment names, else Debian's. */
std::vector<std::string> names() {
  if (const char* name = std::getenv("ARAS_VISUAL_SERVO_OSMESA")) return {name};
  return {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
}

/** The same library once more: the loader knows a file by its inode. @throws RenderError */
OsmesaLibrary openCopy(const OsmesaLibrary& of) {
  Dl_info info{};
  dladdr(reinterpret_cast<const void*>(of.create), &info);
  std::ifstream file(info.dli_fname ? info.dli_fname : "", std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  const int copy = memfd_create("osmesa", MFD_CLOEXEC);
  const bool written = copy >= 0 && !bytes.empty() && write(copy, bytes.data(), bytes.size()) == ssize_t(bytes.size());
  try {
    if (!written) throw RenderError("renderer 'opengl': no copy of OSMesa");
    const OsmesaLibrary opened = openOsmesa({"/proc/self/fd/" + std::to_string(copy)});
    close(copy);
    return opened;
  } catch (const RenderError&) {
    if (copy >= 0) close(copy);
    throw;
  }
}

}  // namespace

std::shared_ptr<const OsmesaLibrary> osmesaOfThread() {
  static std::mutex mutex;
  static std::deque<Instance>& instances = *new std::deque<Instance>;  // contexts may outlive all that is static
  static bool copies = true;
  const std::lock_guard<std::mutex> lock(mutex);
  if (instances.empty()) instances.push_back({openOsmesa(names()), {}, 0});
  const auto me = std::this_thread::get_id();
  const auto isMine = [me](const Instance& each) { return each.held > 0 && each.user == me; };
  auto chosen = std::find_if(instances.begin(), instances.end(), isMine);
  if (chosen == instances.end()) {
    const auto fewer = [](const Instance& a, const Instance& b) { return a.held < b.held; };
    chosen = std::min_element(instances.begin(), instances.end(), fewer);
    const auto most = 2 * std::max<std::size_t>(1, std::thread::hardware_concurrency());
    if (chosen->held > 0 && copies && instances.size() < most) {
      try {
        instances.push_back({openCopy(instances.front().library), {}, 0});
        chosen = std::prev(instances.end());
      } catch (const RenderError&) {
        copies = false;
      }
    }
  }
  Instance& instance = *chosen;
  if (instance.held++ == 0) instance.user = me;
  return {&instance.library, [&instance](const OsmesaLibrary*) {
            const std::lock_guard<std::mutex> release(mutex);
            --instance.held;
          }};
}

}  // namespace aras_visual_servo_sim
