// Depth and ids of what the centres of pixels see.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/render/geometry_image.hpp"
#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing::geometry_test {
namespace {

GeometryImage geometryOf(const CameraModel& camera, const Pose& X_WC, const Scene& scene) {
  GeometryRenderer renderer;
  GeometryImage image;
  renderer.render(camera, X_WC, scene, image);
  return image;
}

std::vector<CameraConfig> lenses() {
  CameraConfig fisheye = cameraConfig();
  fisheye.distortion_model = "equidistant";
  fisheye.distortion = {-0.02, 0.004, -0.001, 0.0002};
  return {cameraConfig(), distortedConfig(), fisheye};
}

/** Z where the ray of a pixel meets the plane z = 0 of the world, nothing of the renderer involved. */
double depthOfFloor(const CameraModel& camera, const Pose& X_WC, int u, int v) {
  const Eigen::Vector3d ray_C = camera.unproject(u, v), ray_W = X_WC.q * ray_C;
  return -X_WC.p.z() / ray_W.z() * ray_C.z();
}

TEST(Geometry, DepthOfATiltedPlaneIsThatOfItsEquation) {
  for (const CameraConfig& config : lenses()) {
    SCOPED_TRACE(config.distortion_model);
    const CameraModel camera(config);
    const Scene scene = sceneWith({{-2, -2}, {2, -2}, {2, 2}, {-2, 2}});
    const Pose X_WC = lookingDown({0.05, -0.04, 0.4}, 0.25, -0.3, 0.7);
    const GeometryImage image = geometryOf(camera, X_WC, scene);
    // float: 6e-8; through a polynomial lens the mean of the corners' rays stands for the centre's, 1e-5 by its
    // curvature.
    const double tolerance = camera.lens() == CameraModel::Lens::kPlumbBob ? 2e-5 : 1e-7;
    double worst = 0.0;
    for (int v = 0; v < image.height; v += 7) {
      for (int u = 0; u < image.width; u += 7) {
        ASSERT_EQ(image.ids[image.at(u, v)], 1) << u << " " << v;
        const double truth = depthOfFloor(camera, X_WC, u, v);
        worst = std::max(worst, std::abs(image.depth_m[image.at(u, v)] - truth) / truth);
      }
    }
    EXPECT_LT(worst, tolerance);
  }
}

/** The floor as the top of a box instead of a plane: triangles give the same depth. */
TEST(Geometry, DepthOfABodyAgreesWithThePlaneOfItsFace) {
  for (const CameraConfig& config : lenses()) {
    SCOPED_TRACE(config.distortion_model);
    const CameraModel camera(config);
    Scene scene;
    Body box;
    box.name = "box";
    box.shapes.push_back({Pose{}, makeBox({4.0, 4.0, 0.1}), {}});
    box.X_WB.p = {0.0, 0.0, -0.05};
    scene.bodies.push_back(box);
    const Pose X_WC = lookingDown({0.05, -0.04, 0.4}, 0.25, -0.3, 0.7);
    const GeometryImage image = geometryOf(camera, X_WC, scene);
    // As above; float corners of meshes are rounded by 6e-8 of metres.
    const double tolerance = camera.lens() == CameraModel::Lens::kPlumbBob ? 2e-5 : 1e-6;
    double worst = 0.0;
    for (int v = 0; v < image.height; v += 7) {
      for (int u = 0; u < image.width; u += 7) {
        ASSERT_EQ(image.ids[image.at(u, v)], 1) << u << " " << v;
        const double truth = depthOfFloor(camera, X_WC, u, v);
        worst = std::max(worst, std::abs(image.depth_m[image.at(u, v)] - truth) / truth);
      }
    }
    EXPECT_LT(worst, tolerance);
  }
}

TEST(Geometry, NearerThingsHideFartherOnesAndNothingIsNaN) {
  Scene scene = sceneWith(lShape());
  scene.models.emplace_back("plate", std::vector<Polygon>{{{-0.01, -0.01}, {0.01, -0.01}, {0.01, 0.01}, {-0.01, 0.01}}},
                            Rgb{}, PlanarModel::Board{{0.04, 0.04}, {}});
  scene.models[1].X_WM.p = {-0.04, -0.035, 0.1};
  Body ball;
  ball.name = "ball";
  ball.shapes.push_back({Pose{}, makeSphere(0.01, 128), {}});
  ball.X_WB.p = {-0.04, -0.035, 0.2};
  scene.bodies.push_back(ball);
  const auto ids = segmentationIds(scene);
  EXPECT_EQ(ids, (std::map<std::string, std::uint16_t>{{"target", 1}, {"plate", 2}, {"ball", 3}}));

  const CameraModel camera(cameraConfig());
  const Pose X_WC = lookingDown({-0.04, -0.035, 0.45});
  const GeometryImage image = geometryOf(camera, X_WC, scene);
  const auto at = [&](double x, double y, double z) {
    const Eigen::Vector2d px = *camera.project(X_WC.inverse() * Eigen::Vector3d(x, y, z));
    return image.at(int(std::lround(px.x())), int(std::lround(px.y())));
  };
  const std::size_t top = at(-0.04, -0.035, 0.21), plate = at(-0.025, -0.035, 0.1), target = at(0.05, -0.035, 0.0);
  EXPECT_EQ(image.ids[top], 3);
  EXPECT_NEAR(image.depth_m[top], 0.24, 5e-5);  // half a pixel's diagonal, 0.9 mm, beside the pole: 4e-5 m
  EXPECT_EQ(image.ids[plate], 2);
  EXPECT_NEAR(image.depth_m[plate], 0.35, 1e-7);
  EXPECT_EQ(image.ids[target], 1);
  EXPECT_NEAR(image.depth_m[target], 0.45, 1e-7);
  EXPECT_EQ(image.ids[0], 0);
  EXPECT_TRUE(std::isnan(image.depth_m[0]));
}

TEST(Geometry, BodiesBeyondTheFarPlaneAreNotSeenAsInImages) {
  CameraConfig config = cameraConfig();
  config.far_m = 0.5;
  Scene scene;
  Body box;
  box.name = "box";
  box.shapes.push_back({Pose{}, makeBox({0.1, 0.1, 0.1}), {}});
  scene.bodies.push_back(box);
  const auto seen = [&](double height) {
    const GeometryImage image = geometryOf(CameraModel(config), lookingDown({0.0, 0.0, height}), scene);
    return int(image.ids[image.at(160, 120)]);
  };
  EXPECT_EQ(seen(0.5), 1);
  EXPECT_EQ(seen(0.6), 0);
  EXPECT_THROW(geometryOf(CameraModel(config), lookingDown({0.0, 0.0, std::nan("")}), scene), NotFiniteError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::geometry_test
