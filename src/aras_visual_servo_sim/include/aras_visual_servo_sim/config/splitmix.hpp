#pragma once

#include <cmath>
#include <cstdint>
#include <utility>

// Random numbers by counter: number k of a seed can be asked for directly and does not depend on what was drawn before.
// Generator: splitmix64 (Steele, Lea and Flood, OOPSLA 2014).
namespace aras_visual_servo_sim::splitmix {

inline constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;

/** Finaliser of splitmix64: a bijection of 64 bits. */
inline std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/** Number `counter` of the stream of a seed, uniform in (0, 1). */
inline double uniform(std::uint64_t seed, std::uint64_t counter) {
  const std::uint64_t bits = mix(mix(seed + kGolden) + (counter + 1) * kGolden);
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

/** Two independent standard normal numbers from the uniform ones at `counter` and `counter` + 1 (Box and Muller,
 *  Annals of Mathematical Statistics 1958). */
inline std::pair<double, double> normalPair(std::uint64_t seed, std::uint64_t counter) {
  constexpr double kTwoPi = 6.283185307179586;
  const double radius = std::sqrt(-2.0 * std::log(uniform(seed, counter)));
  const double angle = kTwoPi * uniform(seed, counter + 1);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace aras_visual_servo_sim::splitmix
