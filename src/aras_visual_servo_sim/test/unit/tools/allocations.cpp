// The address sanitizer, which takes the place of the C library's functions, tells of each allocation through this
// hook.
#include "allocations.hpp"

extern "C" void __sanitizer_malloc_hook(const volatile void*, std::size_t) { aras_visual_servo_sim::countAllocation(); }
