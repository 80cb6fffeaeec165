// Images of colours and of 16 bits are segmented by their grey; what is no image is refused.
#include <gtest/gtest.h>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/segmentation/segmentation.hpp"
#include "fill.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera {
namespace {

using testing::fill;
using testing::GreyImage;
using testing::kBackgroundGrey;
using testing::kObjectGrey;

TEST(Segmentation, ColourImagesGiveTheMaskOfTheirGrey) {
  GreyImage image(64, 48, kBackgroundGrey);
  fill(&image, 20, 15, 13, 11, kObjectGrey);
  for (PixelFormat format : {PixelFormat::kRgb8, PixelFormat::kBgr8, PixelFormat::kRgba8}) {
    const int n = channels(format);
    const std::size_t step = 64 * n + 5;  // padded rows
    std::vector<std::uint8_t> data(step * 48, 3);
    for (int v = 0; v < 48; ++v)
      for (int u = 0; u < 64; ++u)
        for (int k = 0; k < n; ++k) data[v * step + u * n + k] = image.at(u, v);
    const ObjectMask mask = Segmentation(testing::usualVision()).process({data.data(), 64, 48, step, format});
    EXPECT_EQ(mask.area_px, 143);
    EXPECT_DOUBLE_EQ(mask.u_px, 26.0);
  }
}

TEST(Segmentation, SixteenBitsGiveTheMaskOfTheirUpperEight) {
  GreyImage image(64, 48, kBackgroundGrey);
  fill(&image, 20, 15, 13, 11, kObjectGrey);
  for (PixelFormat format : {PixelFormat::kMono16, PixelFormat::kRgb16}) {
    const int n = channels(format);
    ASSERT_EQ(bytesOf(format), 2 * n);
    const std::size_t step = 64 * n + 3;  // padded rows, in values
    std::vector<std::uint16_t> data(step * 48, 700);
    for (int v = 0; v < 48; ++v)
      for (int u = 0; u < 64; ++u)
        for (int k = 0; k < n; ++k) data[v * step + u * n + k] = static_cast<std::uint16_t>(257 * image.at(u, v) + 90);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(data.data());
    const ObjectMask mask = Segmentation(testing::usualVision()).process({bytes, 64, 48, 2 * step, format});
    const ObjectMask same = Segmentation(testing::usualVision()).process(image.view());
    EXPECT_EQ(mask.area_px, 143);
    EXPECT_EQ(mask.u_px, same.u_px);
    EXPECT_THROW(Segmentation(testing::usualVision()).process({bytes, 64, 48, std::size_t(2 * 64 * n - 2), format}),
                 ShapeError);
  }
}

TEST(Segmentation, RedAndBlueAreToldApartByTheFormat) {
  std::vector<std::uint8_t> data(3 * 40 * 40, 0);
  for (std::size_t k = 0; k < data.size(); k += 3) data[k] = 255;  // red in rgb8: grey 76; blue in bgr8: grey 29
  VisionConfig config = testing::usualVision();
  config.segmentation = SegmentationMethod::kFixed;
  config.threshold = 50;
  EXPECT_FALSE(Segmentation(config).process({data.data(), 40, 40, 120, PixelFormat::kRgb8}).visible);
  EXPECT_TRUE(Segmentation(config).process({data.data(), 40, 40, 120, PixelFormat::kBgr8}).visible);
}

TEST(Segmentation, ImageWithoutPixelsIsAShapeError) {
  Segmentation segmentation{testing::usualVision()};
  EXPECT_THROW(segmentation.process(ImageView()), ShapeError);
  const GreyImage image(8, 8, 0);
  EXPECT_THROW(segmentation.process({image.data.data(), 8, 8, 7, PixelFormat::kMono8}), ShapeError);
}

}  // namespace
}  // namespace aras_visual_servo_camera
