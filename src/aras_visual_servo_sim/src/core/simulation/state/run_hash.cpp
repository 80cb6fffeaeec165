#include "aras_visual_servo_sim/simulation/state/run_hash.hpp"

#include <cinttypes>
#include <cstdio>
#include <cstring>

#include "aras_visual_servo_sim/config/splitmix.hpp"

namespace aras_visual_servo_sim {
namespace {

using splitmix::kGolden;
using splitmix::mix;

// Odd constants with well-spread bits: the multipliers of splitmix64.
constexpr std::uint64_t kMixA = 0xbf58476d1ce4e5b9ULL;
constexpr std::uint64_t kMixB = 0x94d049bb133111ebULL;
constexpr std::size_t kLanes = 4;  // independent multiplications that keep the processor's pipeline full

std::uint64_t rotateLeft(std::uint64_t word, int bits) { return (word << bits) | (word >> (64 - bits)); }

std::uint64_t loadWord(const unsigned char* data, std::size_t size) {
  std::uint64_t word = 0;
  std::memcpy(&word, data, size);
  return word;
}

}  // namespace

void RunHash::add(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  std::uint64_t lane[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) lane[k] = state_ + (k + 1) * kGolden;

  constexpr std::size_t kWord = sizeof(std::uint64_t);
  std::size_t at = 0;
  for (; at + kLanes * kWord <= size; at += kLanes * kWord) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      lane[k] = rotateLeft(lane[k] ^ (loadWord(bytes + at + k * kWord, kWord) * kMixA), 29) * kMixB + kGolden;
    }
  }
  for (; at < size; at += kWord) {
    const std::size_t left = size - at < kWord ? size - at : kWord;
    lane[0] = mix(lane[0] ^ loadWord(bytes + at, left)) + kGolden;
  }
  std::uint64_t sum = mix(state_ ^ size);
  for (const std::uint64_t word : lane) sum = mix(sum + word);
  state_ = sum;
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
