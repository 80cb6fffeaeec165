// Counts allocations in place of the C library's functions, which those of all libraries here end in. It is a library
// of its own: the malloc of a program would come before that of a preloaded address sanitizer, which then cannot start.
#include <atomic>
#include <cerrno>

#include "allocations.hpp"

namespace aras_visual_servo_sim {
namespace {
std::atomic<std::size_t> count{0};
}  // namespace

std::size_t allocations() { return count; }
void countAllocation() { ++count; }

}  // namespace aras_visual_servo_sim

using aras_visual_servo_sim::count;

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  ++count;
  return __libc_malloc(size);
}

void* calloc(std::size_t number, std::size_t size) {
  ++count;
  return __libc_calloc(number, size);
}

void* realloc(void* old, std::size_t size) {
  ++count;
  return __libc_realloc(old, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  ++count;
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  *result = memalign(alignment, size);
  return *result ? 0 : ENOMEM;
}
}
