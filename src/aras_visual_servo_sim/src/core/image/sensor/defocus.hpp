#pragma once

#include <vector>

#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** How many pixels a disc about the middle of a pixel reaches beyond it. */
int reachOfDisc(double diameter_px);
/** What of a disc lies in each pixel about its middle: (2 reach + 1)^2 shares, row by row, that sum up to 1. */
std::vector<float> discOf(double diameter_px);

/** Spreads every point of an image evenly over a disc: a pixel becomes the mean over the disc about its middle, the
 *  squares of the pixels being of one value. Beyond its border the image goes on as at the border.
 *  @param diameter_px  >= 0 */
void defocus(double diameter_px, FineImage& image);

}  // namespace aras_visual_servo_sim
