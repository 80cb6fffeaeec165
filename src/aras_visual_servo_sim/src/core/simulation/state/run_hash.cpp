#include "aras_visual_servo_sim/simulation/run_hash.hpp"

#include <cinttypes>
#include <cstdio>
#include <cstring>

namespace aras_visual_servo_sim {
namespace {

// Odd constants with well-spread bits: the fractional part of the golden ratio and multipliers of splitmix64.
constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;
constexpr std::uint64_t kMixA = 0xbf58476d1ce4e5b9ULL;
constexpr std::uint64_t kMixB = 0x94d049bb133111ebULL;
constexpr std::size_t kLanes = 4;  // independent multiplications that keep the processor's pipeline full

std::uint64_t mix(std::uint64_t word) {
  word = (word ^ (word >> 30)) * kMixA;
  word = (word ^ (word >> 27)) * kMixB;
  return word ^ (word >> 31);
}

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

std::string RunHash::hex() const {
  char text[17];
  std::snprintf(text, sizeof(text), "%016" PRIx64, state_);
  return text;
}

}  // namespace aras_visual_servo_sim
