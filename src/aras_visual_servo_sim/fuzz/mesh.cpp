// The reader of meshes. The first byte says which format; assimp wants a file, which is one in memory.
#include <sys/mman.h>
#include <unistd.h>

#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "target.hpp"

using namespace aras_visual_servo_sim;

namespace {

/** A file of /dev/shm that is gone when this ends. */
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& ending) : path_("/dev/shm/aras_fuzz_" + std::to_string(getpid()) + ending) {}
  ~MemoryFile() { unlink(path_.c_str()); }
  const std::string& path() const { return path_; }
  void fill(const std::uint8_t* bytes, std::size_t size) const {
    FILE* file = std::fopen(path_.c_str(), "wb");
    if (!file || std::fwrite(bytes, 1, size, file) != size) __builtin_trap();
    std::fclose(file);
  }

 private:
  std::string path_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const MemoryFile kFiles[] = {MemoryFile(".stl"), MemoryFile(".obj"), MemoryFile(".dae")};
  if (size == 0) return 0;
  const MemoryFile& file = kFiles[bytes[0] % 3];
  file.fill(bytes + 1, size - 1);
  fuzz::allow([&] { loadMesh(file.path()); });
  return 0;
}
