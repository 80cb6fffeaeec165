#pragma once

#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** Which of red (0), green (1) and blue (2) the value at column x of row v stands for, x counting channels; green for
 *  mono8 and mono16. */
int colorAt(Encoding encoding, int x, int v);

/** What each pixel sees through its colour filter. @param rgb  rgb8  @param mosaic  given rgb's size and the encoding
 *  @param encoding  one of the Bayer patterns */
void throughBayerFilter(const FineImage& rgb, Encoding encoding, FineImage& mosaic);

}  // namespace aras_visual_servo_sim
