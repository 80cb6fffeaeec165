// Whatever corners, poses and fields of view come: nothing is written outside the image.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/render/geometry_image.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"
#include "render/coverage/coverage_rasterizer.hpp"
#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing::hostile_test {
namespace {

const double kNan = std::nan(""), kInfinity = std::numeric_limits<double>::infinity();

TEST(Hostile, NoCornerMakesTheRasterizerWriteElsewhere) {
  const std::vector<double> values = {kNan, kInfinity,   -kInfinity, 1e18, -1e18, 1e308, -1e308, 2e9,
                                      -3e9, 1e-320,      -1e-320,    0.0,  15.5,  -0.5,  7.25,   20.0,
                                      31.5, 5.0 - 1e-16, 1e7,        -1e7, 63.0,  4.0,   12.75,  1e30};
  std::mt19937 random(3);
  const auto value = [&] { return values[random() % values.size()]; };
  for (const auto rule : {CoverageRasterizer::Rule::kCoverage, CoverageRasterizer::Rule::kCenter}) {
    CoverageRasterizer rasterizer, fresh;
    for (int k = 0; k < 3000; ++k) {
      Image image, again;
      image.resize(32, 24, Encoding::kMono8);
      std::vector<Eigen::Vector2d> corners(3 + random() % 4);
      for (Eigen::Vector2d& corner : corners) corner = {value(), value()};
      rasterizer.begin(32, 24, rule);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        rasterizer.addEdge(corners[i], corners[(i + 1) % corners.size()]);
      }
      const PixelBox box = rasterizer.bounds();
      ASSERT_TRUE(box.u0 >= 0 && box.v0 >= 0 && box.u1 <= 32 && box.v1 <= 24);
      k % 2 == 0 ? rasterizer.blend(std::array<std::uint8_t, 3>{9, 9, 9}, image)
                 : rasterizer.forEachRun(
                       [](int u0, int u1, int v) { ASSERT_TRUE(u0 >= 0 && u0 < u1 && u1 <= 32 && v >= 0 && v < 24); });
    }
    // And nothing of it is left: the next fill is as from a new one.
    Image after, clean;
    for (auto [one, image] : {std::pair{&rasterizer, &after}, std::pair{&fresh, &clean}}) {
      image->resize(32, 24, Encoding::kMono8);
      std::fill(image->data.begin(), image->data.end(), std::uint8_t{200});
      one->begin(32, 24, rule);
      const Eigen::Vector2d corners[] = {{3.2, 4.1}, {20.7, 6.0}, {11.0, 19.9}};
      for (int i = 0; i < 3; ++i) one->addEdge(corners[i], corners[(i + 1) % 3]);
      one->blend(std::array<std::uint8_t, 3>{20, 20, 20}, *image);
    }
    EXPECT_EQ(after.data, clean.data);
  }
}

constexpr int kWidth = 160, kHeight = 120;
constexpr std::size_t kPixels = kWidth * kHeight;

std::vector<CameraConfig> cameras() {
  CameraConfig fisheye = cameraConfig();
  fisheye.distortion_model = "equidistant";
  fisheye.distortion = {-0.02, 0.004, -0.001, 0.0002};
  fisheye.horizontal_fov_rad = 3.6;
  std::vector<CameraConfig> configs{cameraConfig(), distortedConfig(), fisheye};
  for (CameraConfig& config : configs) {
    config.width = kWidth;
    config.height = kHeight;
  }
  return configs;
}

TEST(Hostile, ThingsOfAnySizeAnywhereAreDrawnOrNot) {
  const auto texture =
      std::make_shared<const Texture>("dots", 8, 8, std::vector<std::uint8_t>(std::size_t(3 * 8 * 8), 77));
  for (const CameraConfig& config : cameras()) {
    const CameraModel camera(config);
    for (const double size : {1e-6, 1.0, 1e9, 1e18, 1e150}) {
      for (const double away : {0.3, 1e6, 1e18, 1e307}) {
        Scene scene = sceneWith({{-size, -size}, {size, -0.7 * size}, {0.1 * size, size}});
        scene.models.emplace_back("photo", std::vector<Polygon>{}, Rgb{}, std::nullopt,
                                  PlanarModel::Picture{texture, {size, size}});
        scene.models[0].X_WM.p = {0.3 * away, -0.2 * away, -away};
        scene.models[1].X_WM.p = {-0.1 * away, away, -0.3};
        Body body;
        body.name = "body";
        const double edge = std::clamp(size, 1e-30, 1e30);
        body.shapes.push_back({Pose{}, makeBox({edge, edge, edge}), {90, 90, 90}, {}});
        body.shapes.push_back({Pose{}, makeSphere(edge), {90, 90, 90}, {}});
        body.shapes.push_back({Pose{}, makeCylinder(edge, edge), {90, 90, 90}, {}});
        body.X_WB.p = {0.1 * away, 0.0, -away - edge};
        scene.bodies.push_back(body);
        for (const double height : {0.4, 1e307}) {
          for (const auto path : {CoverageRenderer::Path::kAutomatic, CoverageRenderer::Path::kSampled}) {
            EXPECT_EQ(render(camera, lookingDown({0.0, 0.0, height}, 0.3), scene, path).data.size(), kPixels);
          }
          GeometryRenderer geometry;
          GeometryImage image;
          geometry.render(camera, lookingDown({0.0, 0.0, height}, 0.3), scene, image);
          EXPECT_EQ(image.ids.size(), kPixels);
        }
      }
    }
  }
}

/** The fields of view, sizes and places that no camera and no room has are refused by name. */
TEST(Hostile, QuantitiesHaveBounds) {
  const auto faultOf = [](const auto& make) {
    try {
      make();
    } catch (const ParameterError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const double field : {1e-308, 1e-5}) {
    CameraConfig config = cameraConfig();
    config.horizontal_fov_rad = field;
    EXPECT_NE(faultOf([&] { return CameraModel(config); }).find("horizontal_fov_rad"), std::string::npos) << field;
  }
  const auto sceneFault = [&](const std::string& text) {
    return faultOf([&] { return SceneConfig::fromYaml(YAML::Load(text)); });
  };
  const std::string model = "models: [{name: t, outlines_m: [[[0, 0], [1, 0], [0, 1]]], ";
  EXPECT_EQ(sceneFault(model + "position_m: [9999, 0, -9999]}]"), "");
  EXPECT_NE(sceneFault(model + "position_m: [1e307, 0, 0]}]").find("position_m"), std::string::npos);
  EXPECT_NE(sceneFault(model + "position_m: [0, 0, -10001]}]").find("position_m"), std::string::npos);
  EXPECT_NE(sceneFault("models: [{name: t, outlines_m: [[[0, 0], [1e18, 0], [0, 1]]]}]").find("outlines_m"),
            std::string::npos);
  EXPECT_NE(sceneFault("solids: [{name: t, sphere_m: 1e18}]").find("sphere_m"), std::string::npos);
  EXPECT_NE(sceneFault("solids: [{name: t, sphere_m: 1, position_m: [0, 1e5, 0]}]").find("position_m"),
            std::string::npos);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::hostile_test
