// Means of a picture over the pixels of a tile, held against polygons cut in double precision texel by texel.
#include "render/picture/picture_means.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tools/render_tools.hpp"
#include "tools/texel_means.hpp"

namespace aras_visual_servo_sim::testing::picture_means_test {
namespace {

/** A tilted picture: pixel (u, v) sees texels by this matrix. @param texels  to a pixel, about */
Eigen::Matrix3d picturePlane(double texels, double turn, const Eigen::Vector2d& middle) {
  Eigen::Matrix3d pixels = Eigen::Matrix3d::Identity();
  pixels.topLeftCorner<2, 2>() = texels * Eigen::Rotation2Dd(turn).toRotationMatrix();
  pixels.row(2) << 1e-3, -2e-3, 1.0;
  pixels.topRightCorner<2, 1>() = middle;
  return pixels;
}

struct Worst {
  double error = 0.0;  // [grey levels]
  int tiles = 0;       // that could be integrated
};

/** Over tiles of an image of 64 x 64 pixels. */
template <int size>
Worst worstOf(const MeshPicture& picture, const Eigen::Matrix3d& plane) {
  const CameraModel camera(cameraConfig());
  PictureCorners<size> corners;
  PictureMeans<3, size> means;
  Worst worst;
  for (int tile = 0; tile < 64 * 64 / (size * size); ++tile) {
    const int u0 = tile % (64 / size) * size, v0 = tile / (64 / size) * size;
    // Narrow ones too, as at an image's border.
    const PixelBox box{u0, v0, u0 + size - (tile % 3 == 0 ? 3 : 0), v0 + size - (tile % 5 == 0 ? 2 : 0)};
    if (!corners.project(camera, plane, plane, box)) continue;
    if (!means.integrate(corners, *picture.texture, picture.wrap_s, picture.wrap_t)) continue;
    ++worst.tiles;
    for (int j = 0; j < corners.rows(); ++j) {
      for (int i = 0; i < corners.columns(); ++i) {
        const Eigen::Vector3d truth = meanOfTexels(
            picture, {corners.at(i, j), corners.at(i + 1, j), corners.at(i + 1, j + 1), corners.at(i, j + 1)});
        for (int c = 0; c < 3; ++c) {
          worst.error = std::max(worst.error, std::abs(double(means.means()[j * size + i][c]) - truth[c]));
        }
      }
    }
  }
  return worst;
}

// Of single precision: places in a tile and shares of a way, a few times 2^-24 of sums of up to 80 * 255, over a
// pixel's area of a ninth of a texel at least. 0.04 if all of them added up; they do not.
constexpr double kRounding = 0.01;

TEST(PictureMeans, AreExactWhateverTheScaleAndTheAngle) {
  const MeshPicture picture{noise(400, 300)};
  for (const double texels : {0.35, 1.0, 1.3, 2.1, 2.5}) {
    for (const double turn : {0.0, 0.4, 0.785398163397448279, 1.5707963267948966, 2.5}) {
      SCOPED_TRACE(std::to_string(texels) + " " + std::to_string(turn));
      const Worst found = worstOf<8>(picture, picturePlane(texels, turn, {200.0, 150.0}));
      EXPECT_LT(found.error, kRounding);
      EXPECT_EQ(found.tiles, 64);
      const Worst large = worstOf<16>(picture, picturePlane(texels, turn, {200.0, 150.0}));
      EXPECT_LT(large.error, kRounding);
      EXPECT_GT(large.tiles, 10);
    }
  }
}

TEST(PictureMeans, GoOnBeyondThePicturesEdges) {
  for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirror}) {
    MeshPicture picture{noise(13, 9), wrap, wrap == Wrap::kMirror ? Wrap::kRepeat : Wrap::kMirror};
    const Worst found = worstOf<8>(picture, picturePlane(0.8, 0.3, {-20.0, 3.0}));
    EXPECT_LT(found.error, kRounding);
    EXPECT_EQ(found.tiles, 64);
  }
}

TEST(PictureMeans, OfOneColourAreThatColour) {
  const MeshPicture picture{std::make_shared<Texture>("plain", 2, 1, std::vector<std::uint8_t>{9, 8, 7, 9, 8, 7})};
  PictureCorners<8> corners;
  PictureMeans<3, 8> means;
  ASSERT_TRUE(corners.project(CameraModel(cameraConfig()), picturePlane(1.0, 0.3, {0.0, 0.0}),
                              picturePlane(1.0, 0.3, {0.0, 0.0}), {8, 8, 16, 16}));
  ASSERT_TRUE(means.integrate(corners, *picture.texture, Wrap::kRepeat, Wrap::kRepeat));
  for (int c = 0; c < 3; ++c) EXPECT_EQ(means.means()[63][c], 9.0f - float(c));
}

TEST(PictureMeans, LeaveToOthersWhatSeesTooManyTexels) {
  const MeshPicture picture{noise(400, 300)};
  EXPECT_EQ(worstOf<8>(picture, picturePlane(5.0, 0.0, {0.0, 0.0})).tiles, 0);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::picture_means_test
