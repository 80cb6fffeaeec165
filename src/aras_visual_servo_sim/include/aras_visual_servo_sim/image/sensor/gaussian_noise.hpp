#pragma once

#include <cstdint>

#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** Adds Gaussian noise to every value, each channel by itself, then rounds and clamps to what a value can be, once.
 *
 *  Noise comes before rounding, so that a pixel half covered by an edge keeps its mean over many frames. Counter based:
 *  what is added depends on (seed, frame_index, index of the value) alone, so frame k is the same whatever was rendered
 *  before it.
 *  @param stddev  standard deviation before rounding, in grey levels, finite and >= 0; 0 adds the mean alone
 *  @param mean    in grey levels, finite
 *  @param encoding  of the image, of as many channels as light
 *  @throws ParameterError if one is out of range */
void addGaussianNoise(const FineImage& light, double stddev, std::uint64_t seed, std::uint64_t frame_index, double mean,
                      Encoding encoding, Image& image);

}  // namespace aras_visual_servo_sim
