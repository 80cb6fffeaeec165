// Pixels that see the border of a planar model's picture: the mean of the part that they see, before the background.
#include <gtest/gtest.h>

#include "tools/render_tools.hpp"
#include "tools/texel_means.hpp"

namespace aras_visual_servo_sim::testing::picture_border_test {
namespace {

constexpr double kBackground = 90.0, kDistance = 0.4;

/** A picture in the middle of the image, so many of its texels along a pixel's side. */
Scene pictureOf(const CameraModel& camera, const TexturePtr& texture, double texels) {
  const double texel_m = kDistance / camera.fx() / texels;
  Scene scene;
  scene.background = {90, 90, 90};
  scene.models.emplace_back("photo", std::vector<Polygon>{}, Rgb{}, std::nullopt,
                            PlanarModel::Picture{texture, {texture->width() * texel_m, texture->height() * texel_m}});
  return scene;
}

/** What a pixel sees, in texels. */
std::vector<Eigen::Vector2d> squareOf(const CameraModel& camera, const Pose& X_WC, const PlanarModel::Picture& picture,
                                      int u, int v) {
  std::vector<Eigen::Vector2d> square;
  for (const auto& [du, dv] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    const Eigen::Vector3d ray_W = X_WC.q * camera.unproject(u + du, v + dv);
    const Eigen::Vector3d p = X_WC.p - X_WC.p.z() / ray_W.z() * ray_W;
    square.emplace_back((p.x() / picture.size_m.x() + 0.5) * picture.texture->width(),
                        (0.5 - p.y() / picture.size_m.y()) * picture.texture->height());
  }
  return square;
}

/** Largest error over the image, in grey levels. */
double worst(const TexturePtr& texture, double texels, double roll, const char* encoding) {
  CameraConfig config = cameraConfig();
  config.encoding = encoding;
  const CameraModel camera(config);
  const Pose X_WC = lookingDown({0.0013, -0.0007, kDistance}, 0.0, 0.0, roll);
  const Scene scene = pictureOf(camera, texture, texels);
  const PlanarModel::Picture& picture = *scene.models[0].picture();
  FineImage image;
  CoverageRenderer().render(camera, X_WC, scene, image);
  double worst = 0.0;
  for (int v = 90; v < 150; ++v) {
    for (int u = 130; u < 190; ++u) {
      const std::vector<Eigen::Vector2d> square = squareOf(camera, X_WC, picture, u, v);
      const auto part = between(between(square, 0, 0.0, texture->width()), 1, 0.0, texture->height());
      Eigen::Vector3d expected = Eigen::Vector3d::Constant(kBackground);
      if (areaOf(part) > 1e-9) {
        expected +=
            areaOf(part) / areaOf(square) * (meanOfTexels({texture, Wrap::kClamp, Wrap::kClamp}, part) - expected);
      }
      for (int c = 0; c < image.channels(); ++c) {
        worst = std::max(worst, std::abs(image.pixel(u, v)[c] / double(kUnitsOf<std::uint16_t>) - expected[c]));
      }
    }
  }
  return worst;
}

TexturePtr grey(const std::vector<int>& values, int width) {
  std::vector<std::uint8_t> rgb;
  for (const int value : values) rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(value));
  return std::make_shared<Texture>("grey", width, static_cast<int>(values.size()) / width, rgb);
}

// Half a unit of a fine image, and the coverage in single precision.
constexpr double kFine = 0.5 / kUnitsOf<std::uint16_t> + 5e-3;

TEST(PictureBorder, OfAFewTexelsAPixelIsExact) {
  for (const double texels : {0.3, 1.0, 2.1}) {
    for (const double roll : {0.0, 0.4, 1.5707963267948966, 2.5, 3.7, 5.6}) {
      SCOPED_TRACE(std::to_string(texels) + " " + std::to_string(roll));
      EXPECT_LT(worst(noise(9, 7), texels, roll, "rgb8"), kFine);
      EXPECT_LT(worst(grey({7, 240, 30, 0, 99, 255, 18, 163, 200, 81, 55, 140}, 4), texels, roll, "mono8"), kFine);
    }
  }
}

/** Twelve texels along a pixel's side: rows are merged and flat edges sampled, on a picture that grows evenly brighter
 *  exact to a texel's step of 4 levels. */
TEST(PictureBorder, OfManyTexelsAPixelIsTheMeanOfThePartItSees) {
  std::vector<int> to_the_right, downwards;
  for (int k = 0; k < 60 * 60; ++k) {
    to_the_right.push_back(4 * (k % 60));
    downwards.push_back(4 * (k / 60));
  }
  for (const double roll : {0.02, 0.4, 1.59, 3.12}) {
    SCOPED_TRACE(roll);
    EXPECT_LT(worst(grey(to_the_right, 60), 12.0, roll, "mono8"), 2.0);
    EXPECT_LT(worst(grey(downwards, 60), 12.0, roll, "rgb8"), 2.0);
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::picture_border_test
