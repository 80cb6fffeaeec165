#include "aras_visual_servo_sim/simulation/state/run_hash.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#include <xxh_x86dispatch.h>  // takes the widest instructions that the processor has; the hash is the same
#else
#include <xxhash.h>
#endif

#include <cinttypes>
#include <cstdio>

namespace aras_visual_servo_sim {

namespace {

/** Wide registers that XXH3 leaves in use make the narrow arithmetic of the physics take twice as long. */
#if defined(__x86_64__)
__attribute__((target("avx"))) void clearUpperHalves() { _mm256_zeroupper(); }
void leaveWideRegisters() {
  if (__builtin_cpu_supports("avx")) clearUpperHalves();
}
#else
void leaveWideRegisters() {}
#endif

}  // namespace

void RunHash::add(const void* data, std::size_t size) {
  state_ = XXH3_64bits_withSeed(data, size, state_);
  leaveWideRegisters();
}

void RunHash::add(const MultibodyWorld& world, std::int64_t time_ns) {
  add(&time_ns, sizeof(time_ns));
  for (const Eigen::VectorXd* values : {&world.jointPositions(), &world.jointVelocities()}) {
    add(values->data(), sizeof(double) * static_cast<std::size_t>(values->size()));
  }
  if (!world.floatingBase()) return;
  const Pose base = world.basePose();
  add(base.p.data(), sizeof(double) * 3);
  add(base.q.coeffs().data(), sizeof(double) * 4);
}

std::string RunHash::hex() const {
  char text[17];
  std::snprintf(text, sizeof(text), "%016" PRIx64, state_);
  return text;
}

}  // namespace aras_visual_servo_sim
