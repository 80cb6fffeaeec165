// Pictures: what is refused, their mean colour, and the running sums that areas are summed up from.
#include "aras_visual_servo_sim/image/texture.hpp"

#include <gtest/gtest.h>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/image/pixel_color.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::texture_test {
namespace {

/** Texels that are all different. */
Texture gradient(int width, int height) {
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < 3 * width * height; ++k) rgb.push_back(static_cast<std::uint8_t>(7 * k % 251));
  return Texture("gradient", width, height, rgb);
}

TEST(Texture, HasThreeBytesForEachTexel) {
  for (const std::size_t bytes : {11, 13}) {
    EXPECT_HAS(messageOf<ModelError>([&] { Texture("t", 2, 2, std::vector<std::uint8_t>(bytes)); }),
               "found " + std::to_string(bytes) + " bytes, needs 3 for each of 2 x 2 texels");
  }
}

TEST(Texture, HasABoundedNumberOfTexels) {
  EXPECT_HAS(messageOf<ModelError>([] { Texture("t", 5000, 4000, {}); }), "found 5000 x 4000 texels, allowed 1 .. ");
}

TEST(Texture, OfAFileIsRefusedBeforeItIsRead) {
  std::vector<std::uint8_t> tga(18, 0);  // the head of a TGA: 60000 x 60000 texels of 24 bits
  tga[2] = 2;
  tga[12] = tga[14] = 60000 % 256;
  tga[13] = tga[15] = 60000 / 256;
  tga[16] = 24;
  EXPECT_HAS(messageOf<ModelError>([&] { loadTexture("t", tga.data(), tga.size()); }),
             "found 60000 x 60000 texels, allowed 1 .. ");
}

TEST(Texture, OfAFileThatIsNoPictureIsRefusedWithTheReason) {
  const std::string text = "no picture";
  EXPECT_HAS(
      messageOf<ModelError>([&] { loadTexture("t", reinterpret_cast<const std::uint8_t*>(text.data()), text.size()); }),
      "picture 't': unknown image type");
}

TEST(Texture, OfAFileThatIsMissingIsAnErrorOfTheModel) {
  EXPECT_HAS(messageOf<ModelError>([] { loadTexture("nowhere/picture.png"); }), "nowhere/picture.png");
}

TEST(Texture, ItsMeanColourIsRoundedToTheNearest) {
  const Rgb mean = Texture("t", 2, 1, {10, 20, 200, 11, 22, 201}).meanColor();
  EXPECT_EQ(mean.r, 11);
  EXPECT_EQ(mean.g, 21);
  EXPECT_EQ(mean.b, 201);
}

/** Sum of channel c over the first i texels of a row of the picture, the last row repeated below. */
std::int32_t sumOf(const Texture& texture, int row, int i, int c, int channels) {
  std::int32_t sum = 0;
  for (int k = 0; k < i; ++k) {
    const std::uint8_t* rgb = texture.texel(k, std::min(row, texture.height() - 1));
    sum += pixelOf({rgb[0], rgb[1], rgb[2]}, channels == 3 ? Encoding::kRgb8 : Encoding::kMono8)[c];
  }
  return sum;
}

TEST(Texture, EachLevelHasTheSumsOfTwiceAsManyRowsAsTheOneBefore) {
  const Texture texture = gradient(3, 10);
  for (const int channels : {1, 3}) {
    const std::vector<Texture::Level>& levels = texture.levels(channels);
    ASSERT_EQ(levels.size(), 3u);  // of 10, 5 and 3 rows
    for (std::size_t k = 0; k < 2; ++k) {
      SCOPED_TRACE(std::to_string(channels) + " channels, level " + std::to_string(k));
      const int merged = 1 << k;
      ASSERT_EQ(levels[k].rows, 10 / merged);
      for (int row = 0; row < levels[k].rows; ++row) {
        for (int i = 0; i <= 3; ++i) {
          for (int c = 0; c < channels; ++c) {
            std::int32_t expected = 0;
            for (int m = 0; m < merged; ++m) expected += sumOf(texture, row * merged + m, i, c, channels);
            EXPECT_EQ(levels[k].sums[(row * 4 + i) * channels + c], expected) << row << " " << i << " " << c;
          }
        }
      }
    }
    // The fifth row of the level before has no other to be merged with: it counts twice.
    ASSERT_EQ(levels[2].rows, 3);
    for (int i = 0; i < 4 * channels; ++i) {
      EXPECT_EQ(levels[2].sums[2 * 4 * channels + i], 2 * levels[1].sums[4 * 4 * channels + i]);
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::texture_test
