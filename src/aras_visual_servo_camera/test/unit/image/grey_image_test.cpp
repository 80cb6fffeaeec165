// Images of every format: their grey, their colour, and which ones are refused.
#include "image/grey_image.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "aras_visual_servo_camera/extraction/overlay.hpp"
#include "text_of.hpp"

namespace aras_visual_servo_camera::grey_image_test {
namespace {

constexpr int kWidth = 6, kHeight = 5;
constexpr int kPadding = 4;                                  // bytes that follow each row
constexpr int kRest = 40;                                    // of a value of 16 bits, which the rounding drops
constexpr std::array<std::uint8_t, 3> kColour{200, 40, 90};  // rgb
// Of the eye's response to it, 0.299 r + 0.587 g + 0.114 b.
const int kGrey = static_cast<int>(std::lround(0.299 * kColour[0] + 0.587 * kColour[1] + 0.114 * kColour[2]));

struct Format {
  const char* name;
  const char* channels;  // which one each value of a pixel is; of a Bayer pattern, which one each of 2 x 2 pixels is
};
constexpr Format kColours[] = {
    {"rgb8", "rgb"},          {"bgr8", "bgr"},          {"rgba8", "rgba"},        {"rgb16", "rgb"},
    {"bayer_rggb8", "rggb"},  {"bayer_bggr8", "bggr"},  {"bayer_gbrg8", "gbrg"},  {"bayer_grbg8", "grbg"},
    {"bayer_rggb16", "rggb"}, {"bayer_bggr16", "bggr"}, {"bayer_gbrg16", "gbrg"}, {"bayer_grbg16", "grbg"},
    {"bgra8", "bgra"},        {"bgr16", "bgr"},         {"rgba16", "rgba"},       {"bgra16", "bgra"},
    {"8UC3", "bgr"},          {"8UC4", "bgra"},         {"16UC3", "bgr"},         {"16UC4", "bgra"}};

std::uint8_t valueOf(char channel) {
  return channel == 'r' ? kColour[0] : channel == 'g' ? kColour[1] : channel == 'b' ? kColour[2] : 255;
}

/** An image of one colour that owns its bytes. */
struct Picture {
  explicit Picture(const Format& format) : kind(formatNamed(format.name)) {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u)
        for (int k = 0; k < channels(kind); ++k) {
          const std::uint8_t value = valueOf(format.channels[isBayer(kind) ? v % 2 * 2 + u % 2 : k]);
          if (isDeep(kind)) bytes.push_back(value + kRest);  // the lower byte: 257 times the value, and the rest
          bytes.push_back(value);
        }
      bytes.resize(static_cast<std::size_t>(v + 1) * step(), 3);
    }
  }
  std::size_t step() const { return static_cast<std::size_t>(kWidth) * bytesOf(kind) + kPadding; }
  ImageView view() const { return {bytes.data(), kWidth, kHeight, step(), kind}; }

  PixelFormat kind;
  std::vector<std::uint8_t> bytes;
};

void rgbBytes(const ImageView& view, std::vector<std::uint8_t>* rgb) {
  std::vector<std::uint16_t> deep(rgb->size());
  if (!isDeep(view.format)) return toRgb(view, rgb->data());
  toRgb(view, deep.data());
  for (std::size_t k = 0; k < deep.size(); ++k) (*rgb)[k] = static_cast<std::uint8_t>(deep[k] >> 8);
}

class EachColour : public ::testing::TestWithParam<Format> {};
INSTANTIATE_TEST_SUITE_P(Formats, EachColour, ::testing::ValuesIn(kColours));

TEST_P(EachColour, HasItsGreyAndItsColourInEveryPixel) {
  const Picture picture(GetParam());
  cv::Mat buffer;
  const cv::Mat grey = greyOf(picture.view(), &buffer);
  std::vector<std::uint8_t> rgb(3 * kWidth * kHeight);
  rgbBytes(picture.view(), &rgb);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      EXPECT_EQ(grey.at<std::uint8_t>(v, u), kGrey) << GetParam().name;
      for (int k = 0; k < 3; ++k) EXPECT_EQ(rgb[3 * (v * kWidth + u) + k], kColour[k]) << GetParam().name << k;
    }
  }
}

TEST(GreyFormats, AreTheirOwnGreyAndThreeTimesThatInColour) {
  for (const Format format : {Format{"mono8", "g"}, Format{"mono16", "g"}, Format{"8UC1", "g"}, Format{"16UC1", "g"}}) {
    const Picture picture(format);
    cv::Mat buffer;
    const cv::Mat grey = greyOf(picture.view(), &buffer);
    std::vector<std::uint8_t> rgb(3 * kWidth * kHeight);
    rgbBytes(picture.view(), &rgb);
    EXPECT_EQ(cv::countNonZero(grey != kColour[1]), 0) << format.name;
    EXPECT_EQ(rgb, std::vector<std::uint8_t>(rgb.size(), kColour[1])) << format.name;
  }
}

TEST(ColourImages, RowsOfOneGreyAmongOthersStayWhereTheyAre) {
  for (const std::vector<int>& coloured : {std::vector<int>{0, 1}, {2}, {4}, {0, 2, 3}}) {
    Picture picture(kColours[0]);
    std::vector<int> wanted(kHeight, 77);
    for (int v = 0; v < kHeight; ++v) std::fill_n(picture.bytes.begin() + picture.step() * v, 3 * kWidth, 77);
    for (const int v : coloured) {
      for (int k = 0; k < 3 * kWidth; ++k) picture.bytes[picture.step() * v + k] = kColour[k % 3];
      wanted[v] = kGrey;
    }
    cv::Mat buffer;
    const cv::Mat grey = greyOf(picture.view(), &buffer);
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) EXPECT_EQ(grey.at<std::uint8_t>(v, u), wanted[v]) << coloured[0] << v;
  }
}

TEST(YuvImages, HaveTheGreyOfTheirLumaAndTheColourOfBoth) {
  // Y 128, U 90, V 200 in BT.601: r 245, g 87, b 54 of 255, to two levels.
  const std::uint8_t uyvy[] = {90, 128, 200, 128, 90, 128, 200, 128}, yuyv[] = {128, 90, 128, 200, 128, 90, 128, 200};
  for (const auto& [name, bytes] : {std::pair("yuv422", uyvy), std::pair("yuv422_yuy2", yuyv)}) {
    const ImageView view{bytes, 4, 1, 8, formatNamed(name)};
    cv::Mat buffer;
    EXPECT_EQ(cv::countNonZero(greyOf(view, &buffer) != 128), 0) << name;
    std::uint8_t rgb[12];
    toRgb(view, rgb);
    for (int u = 0; u < 4; ++u) {
      EXPECT_NEAR(rgb[3 * u], 245, 2) << name;
      EXPECT_NEAR(rgb[3 * u + 1], 87, 2) << name;
      EXPECT_NEAR(rgb[3 * u + 2], 54, 2) << name;
    }
    ImageView odd = view;
    odd.width_px = 3;
    EXPECT_NE(testing::textOf<ShapeError>([&] { toRgb(odd, rgb); }).find("even width"), std::string::npos);
  }
}

TEST(DeepImages, MayBeginWithTheUpperByteAndAtOddAddresses) {
  const std::uint8_t bytes[] = {0, 0x12, 0x34, 0xAB, 0xCD, 0, 0x56, 0x78, 0x9A, 0xBC};  // rows of five bytes
  ImageView view{bytes + 1, 2, 2, 5, PixelFormat::kMono16};
  cv::Mat buffer;
  view.upper_byte_first = true;
  cv::Mat grey = greyOf(view, &buffer);
  EXPECT_EQ(grey.at<std::uint8_t>(0, 0), 0x12);
  EXPECT_EQ(grey.at<std::uint8_t>(0, 1), 0xAB);
  EXPECT_EQ(grey.at<std::uint8_t>(1, 1), 0x9A);
  view.upper_byte_first = false;
  grey = greyOf(view, &buffer);
  EXPECT_EQ(grey.at<std::uint8_t>(0, 0), 0x34);
  EXPECT_EQ(grey.at<std::uint8_t>(1, 1), 0xBC);
}

TEST(DeepImages, AreReadWithTheFewestBitsThatAreEnoughForTheImagesSoFar) {
  GreyReader reader;
  std::uint16_t values[] = {0, 0};
  const ImageView view{reinterpret_cast<const std::uint8_t*>(values), 2, 1, 4, PixelFormat::kMono16};
  for (const auto& [value, white, grey] : std::vector<std::array<int, 3>>{{200, 255, 200},
                                                                          {256, 1023, 64},
                                                                          {1023, 1023, 255},
                                                                          {100, 1023, 25},
                                                                          {4000, 4095, 249},
                                                                          {60000, 65535, 233}}) {
    values[1] = static_cast<std::uint16_t>(value);
    EXPECT_EQ(reader.read(view).at<std::uint8_t>(0, 1), grey) << value;
    EXPECT_EQ(reader.white(), white) << value;
  }
}

TEST(DeepImages, DoNotTakeTheirWhiteFromTheirOpacity) {
  GreyReader reader;
  const std::uint16_t values[] = {700, 700, 700, 65535};
  reader.read({reinterpret_cast<const std::uint8_t*>(values), 1, 1, 8, PixelFormat::kRgba16});
  EXPECT_EQ(reader.white(), 1023);
}

std::string refusalOf(const ImageView& view) {
  cv::Mat buffer;
  return testing::textOf<ShapeError>([&] { greyOf(view, &buffer); });
}

TEST(Images, WithoutPixelsOrWithShortRowsAreRefused) {
  const Picture picture(kColours[0]);
  ImageView view = picture.view();
  EXPECT_EQ(refusalOf(view), "");
  view.data = nullptr;
  EXPECT_NE(refusalOf(view), "");
  view = picture.view();
  view.width_px = 0;
  EXPECT_NE(refusalOf(view).find("found 0 x 5 pixels"), std::string::npos);
  view = picture.view();
  view.height_px = 0;
  EXPECT_NE(refusalOf(view).find("found 6 x 0 pixels"), std::string::npos);
  view = picture.view();
  view.step_bytes = 17;
  EXPECT_EQ(refusalOf(view), "image: found 6 x 5 pixels, 17 bytes a row, allowed at least 1 x 1 and 3 bytes a pixel");
}

TEST(Images, OfABayerPatternHaveThreePixelsEachWay) {
  const Picture picture(kColours[4]);
  for (const auto& [width, height] : {std::pair(2, 5), std::pair(6, 2)}) {
    ImageView view = picture.view();
    view.width_px = width;
    view.height_px = height;
    EXPECT_EQ(refusalOf(view), "image: found " + std::to_string(width) + " x " + std::to_string(height) +
                                   " pixels of a Bayer pattern, allowed at least 3 x 3");
  }
}

TEST(Images, OfAnUnknownEncodingAreRefusedWithThoseThatAreKnown) {
  const std::string text = testing::textOf<ShapeError>([] { formatNamed("32FC1"); });
  EXPECT_EQ(text.find("image encoding: found '32FC1', allowed rgb8, bgr8, "), 0u) << text;
  for (const Format& format : kColours) EXPECT_NE(text.find(format.name), std::string::npos) << text;
}

}  // namespace
}  // namespace aras_visual_servo_camera::grey_image_test
