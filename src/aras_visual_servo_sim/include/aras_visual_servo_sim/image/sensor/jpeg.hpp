#pragma once

#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** The image as a JPEG file; of 16 bits the upper 8. @param quality  1 .. 100 @throws RenderError */
std::vector<std::uint8_t> jpegOf(const Image& image, int quality);

/** Compresses an image and reads it back. @param image  of 8 bits a value @throws RenderError */
void throughJpeg(int quality, Image& image);

}  // namespace aras_visual_servo_sim
