#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"

namespace aras_visual_servo_sim {

/** Running 64-bit hash of a byte stream, by which two runs are compared.
 *
 *  Each call of `add` is one record, hashed by XXH3 of xxHash with the hash of the records before it as the seed. XXH3
 *  takes the length in, so that it matters where one record ends, and gives the same on every processor.
 *  The state is one word: it can be saved and restored with the simulation. Not cryptographic. */
class RunHash {
 public:
  /** Adds one record of `size` bytes. */
  void add(const void* data, std::size_t size);
  /** Adds the state of a robot, as records: the time, its joints, the pose of a free base. */
  void add(const MultibodyWorld& world, std::int64_t time_ns);
  void reset() { state_ = 0; }
  std::uint64_t state() const { return state_; }
  void setState(std::uint64_t state) { state_ = state; }
  /** @return 16 lower-case hexadecimal digits */
  std::string hex() const;

 private:
  std::uint64_t state_ = 0;
};

}  // namespace aras_visual_servo_sim
