// Depths of points from a depth image: slanted objects before something else, holes, lenses, encodings, other sizes.
#include "image/depth_reader.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "point_views.hpp"

namespace aras_visual_servo_camera::depth_reader_test {
namespace {

constexpr double kFloat =
    3e-7;  // relative: depths are floats, and a point beside its pixels is further by a few of them
constexpr float kBehind_m = 1.0F;
const float kHole = std::numeric_limits<float>::quiet_NaN();
constexpr DepthConfig kUsual{9, 0.05};

/** Depths of the plane 1/Z = a x + b y + c inside a box of pixels, of a wall outside. */
struct Scene {
  explicit Scene(const CameraIntrinsics& camera, int u0 = 100, int u1 = 140, int v0 = 80, int v1 = 120)
      : map(camera), z(static_cast<std::size_t>(camera.width()) * camera.height(), kBehind_m) {
    for (int v = v0; v < v1; ++v) {
      mask.spans.push_back({v, u0, u1});
      for (int u = u0; u < u1; ++u) at(u, v) = static_cast<float>(1.0 / overZ(map.at(u, v).x, map.at(u, v).y));
    }
  }

  float& at(int u, int v) { return z[static_cast<std::size_t>(v) * map.width() + u]; }
  static double overZ(double x, double y) { return 0.4 * x - 0.3 * y + 1.7; }
  DepthView view() const {
    return {reinterpret_cast<const std::uint8_t*>(z.data()), map.width(), map.height(),
            sizeof(float) * static_cast<std::size_t>(map.width())};
  }

  PixelMap map;
  ObjectMask mask;
  std::vector<float> z;
};

class DepthLens : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(DepthReader, DepthLens, ::testing::Values(false, true));

TEST_P(DepthLens, ACornerHasTheDepthOfItsObjectNotOfTheWallBehind) {
  const Scene scene(testing::testCamera(GetParam()));
  const DepthReader reader(scene.map, kUsual);
  EXPECT_EQ(reader.fault(nullptr), "no depth image came with the image");
  const DepthView view = scene.view();
  EXPECT_EQ(reader.fault(&view), "");
  for (const auto& [u, v] : {std::pair(100, 80), std::pair(139, 119), std::pair(120, 100)}) {
    const PixelMap::Pixel p = scene.map.at(u, v, u < 120 ? -0.5 : 0.5, v < 100 ? -0.5 : 0.5);
    const double truth = 1.0 / Scene::overZ(p.x, p.y);
    EXPECT_NEAR(reader.at(view, p.x, p.y, &scene.mask), truth, 5.0 * kFloat * truth) << u << ", " << v;
  }
}

TEST(DepthReader, WithoutAMaskPixelsOfAnotherDepthAreLeftOut) {
  Scene scene(testing::testCamera(false));
  const PixelMap::Pixel p = scene.map.at(102, 82);  // three pixels from the wall's
  EXPECT_NEAR(DepthReader(scene.map, kUsual).at(scene.view(), p.x, p.y, nullptr), 1.0 / Scene::overZ(p.x, p.y), 1e-6);
  const DepthReader all(scene.map, {9, 1.0 - 1e-9});
  EXPECT_GT(std::abs(all.at(scene.view(), p.x, p.y, nullptr) * Scene::overZ(p.x, p.y) - 1.0), 0.01);
}

TEST(DepthReader, HolesAreFilledFromTheirSurroundingsAndToldWhereNothingIsLeft) {
  Scene scene(testing::testCamera(false));
  const DepthReader reader(scene.map, kUsual);
  const PixelMap::Pixel p = scene.map.at(120, 100);
  for (float hole : {kHole, 0.0F, -1.0F, std::numeric_limits<float>::infinity()}) {
    scene.at(120, 100) = hole;
    EXPECT_NEAR(reader.at(scene.view(), p.x, p.y, &scene.mask), 1.0 / Scene::overZ(p.x, p.y), 1e-6);
    EXPECT_TRUE(std::isnan(reader.at(scene.view(), p.x, p.y, nullptr)));  // the pixel under the point says which depth
  }
  for (int v = 92; v <= 108; ++v)
    for (int u = 112; u <= 128; ++u)
      if (v != 98) scene.at(u, v) = kHole;
  EXPECT_TRUE(std::isnan(reader.at(scene.view(), p.x, p.y, &scene.mask)));  // a row alone gives no plane
  EXPECT_TRUE(std::isnan(reader.at(scene.view(), 5.0, 0.0, &scene.mask)));  // outside the image
  EXPECT_TRUE(std::isnan(reader.at(scene.view(), 1e300, 0.0, nullptr)));
}

TEST(DepthReader, MillimetresAndOnePixelWindows) {
  const Scene scene(testing::testCamera(false));
  std::vector<std::uint16_t> z;
  for (float m : scene.z) z.push_back(static_cast<std::uint16_t>(std::lround(1e3 * m)));
  const DepthView view{reinterpret_cast<const std::uint8_t*>(z.data()), scene.map.width(), scene.map.height(),
                       2 * static_cast<std::size_t>(scene.map.width()), true};
  const PixelMap::Pixel p = scene.map.at(120, 100);
  EXPECT_NEAR(DepthReader(scene.map, kUsual).at(view, p.x, p.y, &scene.mask), 1.0 / Scene::overZ(p.x, p.y), 2e-4);
  EXPECT_EQ(DepthReader(scene.map, {1, 0.05}).at(view, p.x, p.y, nullptr),
            1e-3 * z[100 * static_cast<std::size_t>(scene.map.width()) + 120]);
}

TEST(DepthReader, OutsideTheImageThereIsNoDepthOnEverySide) {
  const Scene scene(testing::testCamera(false));
  const CameraIntrinsics& camera = scene.map.intrinsics();
  for (const auto& [u, v, inside] :
       {std::tuple(0, 0, true), std::tuple(319, 239, true), std::tuple(-1, 100, false), std::tuple(320, 100, false),
        std::tuple(100, -1, false), std::tuple(100, 240, false)}) {
    const double x = (u - camera.cx()) / camera.fx(), y = (v - camera.cy()) / camera.fy();
    for (const DepthConfig& config : {kUsual, DepthConfig{1, 0.05}})
      EXPECT_EQ(std::isnan(DepthReader(scene.map, config).at(scene.view(), x, y, nullptr)), !inside) << u << " " << v;
  }
  const double far = 2e6 / camera.fx();  // no pixel has such a number
  EXPECT_TRUE(std::isnan(DepthReader(scene.map, kUsual).at(scene.view(), 0.0, far, nullptr)));
}

TEST(DepthReader, CornersOfAnImageGetTheirDepthsAndTheFaultOfADepthImageOfAnotherSize) {
  const CameraIntrinsics camera = testing::testCamera(false);
  VisionConfig config = testing::withPoints(PointSource::kCorners, 4);
  config.depth = kUsual;
  MomentExtractor extractor(camera, config);
  testing::Polygon quad = testing::kQuad;
  for (auto& corner : quad) corner = {2.0 * corner.x, 2.0 * corner.y};  // seen from half a metre
  const testing::GreyImage image = testing::coverageImage(quad, camera);
  const std::size_t pixels = static_cast<std::size_t>(camera.width()) * camera.height();
  const std::vector<float> flat(pixels, 0.75F);
  DepthView depth{reinterpret_cast<const std::uint8_t*>(flat.data()), camera.width(), camera.height(),
                  4 * static_cast<std::size_t>(camera.width())};
  const MomentFeatures seen = extractor.process(image.view(), 1, &depth);
  ASSERT_EQ(seen.point_x.size(), 4u);
  ASSERT_EQ(seen.point_z.size(), 4u);
  for (double z : seen.point_z) EXPECT_NEAR(z, 0.75, 1e-6);
  EXPECT_EQ(seen.depth_fault, "");
  depth.height_px /= 2;
  const MomentFeatures& small = extractor.process(image.view(), 2, &depth);
  EXPECT_TRUE(small.valid && small.point_z.empty());
  EXPECT_NE(small.depth_fault.find("the depth image is 320 x 120, allowed 320 x 240"), std::string::npos)
      << small.depth_fault;
  EXPECT_EQ(extractor.process(image.view(), 3).depth_fault, "no depth image came with the image");
}

}  // namespace
}  // namespace aras_visual_servo_camera::depth_reader_test
