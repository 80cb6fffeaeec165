#pragma once

#include <cstdint>
#include <type_traits>

namespace aras_visual_servo_sim {

/** Four channels r, g, b, a in one number, the first in its lowest bits: 8 bits each of std::uint32_t, 16 of
 *  std::uint64_t. Two of them at a time are counted in twice as many bits, so that sums do not run over. */
template <typename Pixel>
struct Packed {
  static constexpr int kBits = 2 * sizeof(Pixel);
  static constexpr Pixel kMost = (Pixel{1} << kBits) - 1;               ///< of a channel
  static constexpr Pixel kOnes = Pixel{1} | (Pixel{1} << (2 * kBits));  ///< 1 in each of two channels
  static constexpr Pixel kEven = kOnes * kMost;                         ///< the bits of r and b

  static Pixel even(Pixel pixel) { return pixel & kEven; }
  static Pixel odd(Pixel pixel) { return (pixel >> kBits) & kEven; }
  /** Of sums that are `shift` bits too large. */
  static Pixel join(Pixel even, Pixel odd, int shift) {
    return ((even >> shift) & kEven) | (((odd >> shift) & kEven) << kBits);
  }
  /** Of 8 bits a channel, alpha 0. */
  static Pixel of(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
    constexpr Pixel kUnit = kMost / 255;
    return kUnit * r | (kUnit * g << kBits) | (kUnit * b << (2 * kBits));
  }
  static Pixel alpha(Pixel pixel) { return pixel >> (3 * kBits); }
  static Pixel channel(Pixel pixel, int k) { return (pixel >> (kBits * k)) & kMost; }

  /** Sum of four pixels, to become their mean, rounded. */
  struct Mean {
    Pixel even_sum = 2 * kOnes, odd_sum = 2 * kOnes;
    void add(Pixel pixel) {
      even_sum += even(pixel);
      odd_sum += odd(pixel);
    }
    Pixel of4() const { return join(even_sum, odd_sum, 2); }
  };

  /** a and b in the proportion of 256 - weight to weight, rounded. */
  static Pixel mix(Pixel a, Pixel b, Pixel weight) {
    constexpr Pixel kHalf = 128 * kOnes;
    return join(even(a) * (256 - weight) + even(b) * weight + kHalf, odd(a) * (256 - weight) + odd(b) * weight + kHalf,
                8);
  }
};

/** The pixels, as Canvas reads them, that values of an image are made of. */
template <typename Value>
using PixelFor = std::conditional_t<sizeof(Value) == 1, std::uint32_t, std::uint64_t>;

}  // namespace aras_visual_servo_sim
