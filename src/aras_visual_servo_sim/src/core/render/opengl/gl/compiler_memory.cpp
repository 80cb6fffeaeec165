#include "compiler_memory.hpp"

#include <link.h>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>

namespace aras_visual_servo_sim {
namespace {

/** Drops the pages of one library that were never written to, if it is LLVM's: they are those of its file. */
int dropPages(dl_phdr_info* library, std::size_t, void*) {
  if (!library->dlpi_name || !std::strstr(library->dlpi_name, "libLLVM")) return 0;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  for (int k = 0; k < library->dlpi_phnum; ++k) {
    const ElfW(Phdr)& part = library->dlpi_phdr[k];
    if (part.p_type != PT_LOAD || part.p_flags & PF_W) continue;
    const std::uintptr_t start = (library->dlpi_addr + part.p_vaddr + page - 1) / page * page;
    const std::uintptr_t end = (library->dlpi_addr + part.p_vaddr + part.p_memsz) / page * page;
    if (start < end) madvise(reinterpret_cast<void*>(start), end - start, MADV_DONTNEED);  // advice: may be refused
  }
  return 0;
}

}  // namespace

void giveBackCompilerMemory() {
  dl_iterate_phdr(&dropPages, nullptr);
  malloc_trim(0);
}

}  // namespace aras_visual_servo_sim
