#include "aras_visual_servo_sim/image/image.hpp"

#include <gtest/gtest.h>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

TEST(Encoding, NamesGoBothWaysAndOthersAreRejected) {
  for (const char* name : {"rgb8", "bgr8", "mono8", "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"})
    EXPECT_STREQ(encodingName(encodingFromName(name)), name);
  EXPECT_THROW(encodingFromName("rgb16"), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim
