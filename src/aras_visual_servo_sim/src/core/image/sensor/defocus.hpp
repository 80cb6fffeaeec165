#pragma once

#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** Spreads every point of an image evenly over a disc: a pixel becomes the mean over the disc about its middle, the
 *  squares of the pixels being of one value. Beyond its border the image goes on as at the border.
 *  @param diameter_px  >= 0 */
void defocus(double diameter_px, FineImage& image);

}  // namespace aras_visual_servo_sim
