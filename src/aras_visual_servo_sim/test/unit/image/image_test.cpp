#include "aras_visual_servo_sim/image/image.hpp"

#include <gtest/gtest.h>

#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim::image_test {
namespace {

TEST(Encoding, NamesGoBothWaysAndOthersAreRejected) {
  for (const char* name :
       {"rgb8", "bgr8", "mono8", "rgb16", "mono16", "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"}) {
    const Encoding encoding = encodingFromName(name);
    EXPECT_STREQ(encodingName(encoding), name);
    const bool color = std::string(name).find("bgr8") == 0 || name[0] == 'r';
    EXPECT_EQ(channelsOf(encoding), color ? 3 : 1);
    EXPECT_EQ(bytesOf(encoding), channelsOf(encoding) * (isDeep(encoding) ? 2 : 1));
    EXPECT_EQ(isDeep(encoding), std::string(name).find("16") != std::string::npos);
    EXPECT_EQ(isBayer(encoding), name[1] == 'a');
    EXPECT_EQ(isMono(encoding), name[0] == 'm');
  }
  EXPECT_THROW(encodingFromName("bgr16"), ParameterError);
}

TEST(Image, OfSixteenBitsHasTwoBytesAValue) {
  Image image;
  image.resize(5, 3, Encoding::kRgb16);
  EXPECT_EQ(image.data.size(), 5u * 3 * 3 * 2);
  EXPECT_EQ(image.pixel(2, 1) - image.pixel(0, 0), (5 + 2) * 6);
  for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<std::uint8_t>(i);
  const Image upper = upperBytes(image);
  EXPECT_EQ(upper.encoding, Encoding::kRgb8);
  ASSERT_EQ(upper.data.size(), 45u);
  for (std::size_t i = 0; i < upper.data.size(); ++i) EXPECT_EQ(upper.data[i], 2 * i + 1);  // the lower byte is first
}

}  // namespace
}  // namespace aras_visual_servo_sim::image_test
