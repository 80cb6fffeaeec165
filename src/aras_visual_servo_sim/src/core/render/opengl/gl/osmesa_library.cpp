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
  OsmesaOfThread osmesa;
  std::thread::id user;
  int held = 0;
};

constexpr char kThreads[] = "LP_NUM_THREADS";

/** In how many threads an image is drawn, unless the user says so. */
int threadsOf(bool wide) {
  const int processors = static_cast<int>(std::thread::hardware_concurrency());
  return wide && !threadsAreChosen() && processors > 1 ? processors : 0;
}

/** What reads and changes the environment, one after another. */
std::mutex& environment() {
  static std::mutex& mutex = *new std::mutex;
  return mutex;
}

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

OSMesaContext OsmesaOfThread::create(const int* wanted) const {
  const std::lock_guard<std::mutex> lock(environment());
  if (threads == 0) return library.create(wanted, nullptr);
  const std::string before = std::getenv(kThreads);  // which the opening of the library has set
  setenv(kThreads, std::to_string(threads).c_str(), 1);
  const OSMesaContext context = library.create(wanted, nullptr);
  setenv(kThreads, before.c_str(), 1);
  return context;
}

std::shared_ptr<OsmesaOfThread> osmesaOfThread(bool wide) {
  static std::mutex mutex;
  static std::deque<Instance>& instances = *new std::deque<Instance>;  // contexts may outlive all that is static
  static bool copies = true;
  const std::lock_guard<std::mutex> lock(mutex);
  const int threads = threadsOf(wide);
  const auto me = std::this_thread::get_id();
  const auto most = 2 * std::max<std::size_t>(1, std::thread::hardware_concurrency());
  Instance* chosen = nullptr;
  for (Instance& each : instances) {
    if (each.osmesa.threads != threads) continue;
    if (each.held > 0 && each.user == me) chosen = &each;
  }
  for (Instance& each : instances) {
    if (each.osmesa.threads == threads && (!chosen || (chosen->user != me && each.held < chosen->held))) chosen = &each;
  }
  if (!chosen || (chosen->held > 0 && chosen->user != me && copies && instances.size() < most)) {
    try {
      const OsmesaLibrary library =
          instances.empty() ? openOsmesa(names()) : openCopy(instances.front().osmesa.library);
      instances.push_back({{library, threads}, {}, 0});
      chosen = &instances.back();
    } catch (const RenderError&) {
      if (instances.empty()) throw;
      copies = false;
      if (!chosen) chosen = &instances.front();
    }
  }
  if (chosen->held++ == 0) chosen->user = me;
  Instance& instance = *chosen;
  return {&instance.osmesa, [&instance](OsmesaOfThread*) {
            const std::lock_guard<std::mutex> release(mutex);
            --instance.held;
          }};
}

}  // namespace aras_visual_servo_sim
