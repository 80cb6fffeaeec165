// The equidistant lens beyond 90 degrees from its axis: projection, pictures, bodies, depth.
#include <gtest/gtest.h>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/render/geometry_image.hpp"
#include "tools/fisheye_tools.hpp"

namespace aras_visual_servo_sim::testing::fisheye_test {
namespace {

constexpr double kRounding = 1e-12;

std::string faultOf(const CameraConfig& config) {
  try {
    CameraModel{config};
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "";
}

TEST(EquidistantLens, FoldsWhereItsSlopeVanishesAndGoesOnStraightFromTheCutOff) {
  EquidistantLens lens({-0.2, 0.0, 0.0, 0.0});  // 1 - 0.6 theta^2 = 0
  EXPECT_NEAR(lens.fold(), std::sqrt(1.0 / 0.6), kRounding);
  EXPECT_NEAR(lens.reach(), lens.fold(), kRounding);
  lens.cutOff(1.0);
  EXPECT_EQ(lens.reach(), 1.0);
  EXPECT_NEAR(lens.radius(1.0), 0.8, kRounding);
  EXPECT_NEAR(lens.radius(1.5), 0.8 + 0.4 * 0.5, kRounding);
  for (double theta = 0.0; theta < 3.0; theta += 0.01) EXPECT_NEAR(lens.angle(lens.radius(theta)), theta, 1e-12);
  EXPECT_EQ(lens.angle(1e9), M_PI);
  EXPECT_EQ(EquidistantLens({0, 0, 0, 0}).reach(), EquidistantLens::kWidest);
}

TEST(Fisheye, RaysToAHundredDegreesProjectByTheFormulaAndComeBack) {
  const CameraConfig config = fisheye200Config();
  const CameraModel camera(config);
  for (double theta = 0.0; theta < 100.0; theta += 3.3) {
    for (double azimuth = -3.1; azimuth < 3.1; azimuth += 0.4) {
      const Eigen::Vector3d ray(std::sin(theta * kDegree) * std::cos(azimuth),
                                std::sin(theta * kDegree) * std::sin(azimuth), std::cos(theta * kDegree));
      const auto px = camera.project(3.0 * ray);
      ASSERT_TRUE(px) << theta;
      EXPECT_LT((*px - projectFisheye(config, ray)).norm(), 1e-9);
      EXPECT_LT((camera.unproject(px->x(), px->y()) - ray).norm(), 1e-12);
    }
  }
  EXPECT_FALSE(camera.project({std::sin(1.76), 0.0, std::cos(1.76)}));  // 100.8 degrees: cut off
  EXPECT_FALSE(camera.project({0.0, 0.0, 0.0}));
  EXPECT_FALSE(camera.project({0.0, 0.0, -1.0}));
  EXPECT_THROW(camera.unproject(-0.5, -0.5), ParameterError);
}

TEST(Fisheye, ALensThatFoldsInTheFieldOfViewIsRefusedByTheAngle) {
  CameraConfig config = fisheye200Config();
  config.distortion = {-0.15, 0.0, 0.0, 0.0};  // folds at 1 / sqrt(0.45) = 1.4907
  EXPECT_NE(faultOf(config).find("folds over 1.490712 rad from the axis"), std::string::npos) << faultOf(config);
  config.cutoff_angle_rad = 1.4;
  EXPECT_EQ(faultOf(config), "");
  config.cutoff_angle_rad.reset();
  config.horizontal_fov_rad = 1.2;  // the corners see 0.85 rad: the fold is out of view
  EXPECT_EQ(faultOf(config), "");
}

TEST(Fisheye, FieldAndCutOffAreChecked) {
  CameraConfig config = fisheye200Config();
  for (const double bad : {0.0, -1.0, 2.19, std::nan("")}) {
    config.cutoff_angle_rad = bad;
    EXPECT_NE(faultOf(config).find("cutoff_angle_rad"), std::string::npos) << bad;
  }
  config = fisheye200Config();
  config.horizontal_fov_rad = 2.0 * M_PI;
  EXPECT_NE(faultOf(config).find("horizontal_fov_rad"), std::string::npos);
  config = cameraConfig();
  config.cutoff_angle_rad = 1.0;
  EXPECT_NE(faultOf(config).find("only with distortion_model equidistant"), std::string::npos);
}

TEST(Fisheye, TheImageIsBlackBeyondTheCutOffAndNowhereElse) {
  const CameraConfig config = fisheye200Config();
  const CameraModel camera(config);
  Scene scene;
  const Image image = render(camera, Pose{}, scene);
  double light = 0.0;
  for (const std::uint8_t value : image.data) light += value / 230.0;
  const double radius = projectFisheye(config, {std::sin(100 * kDegree), 0.0, std::cos(100 * kDegree)}).x() - 199.5;
  // Some 8 radius pixels on the rim, each rounded by half a level of 230: random, rms 0.3 levels.
  EXPECT_NEAR(light, M_PI * radius * radius, 4.0 * 0.29 / 230.0 * std::sqrt(8.0 * radius) + 2e-3 * M_PI * radius);
  EXPECT_EQ(*image.pixel(0, 0), 0);
  EXPECT_EQ(*image.pixel(199, 199), 230);
  CameraConfig whole = config;
  whole.cutoff_angle_rad.reset();  // 200 degrees across reach 141 in the corners: drawn up to 125
  EXPECT_EQ(*render(CameraModel(whole), Pose{}, scene).pixel(0, 0), 0);
  EXPECT_EQ(*render(CameraModel(whole), Pose{}, scene).pixel(45, 45), 230);
}

/** A plane below the camera fills all that looks downwards, in front of it and behind. */
TEST(Fisheye, AFloorAcrossZZeroFillsAllBelowTheHorizon) {
  const CameraConfig config = fisheye200Config();
  const CameraModel camera(config);
  for (const double tilt : {0.0, 30.0, -70.0}) {
    const double c = std::cos(tilt * kDegree), s = std::sin(tilt * kDegree);
    const Pose X_WC = lookingAlong({0.3, -0.2, 0.5}, {0.3 * c, 0.95 * c, -s}, {0.95, -0.3, 0.0});
    const Scene scene = sceneWith({{-900, -900}, {900, -900}, {900, 900}, {-900, 900}});
    for (const auto path : {CoverageRenderer::Path::kAutomatic, CoverageRenderer::Path::kSampled}) {
      const Image image = render(camera, X_WC, scene, path);
      for (int v = 0; v < image.height; ++v) {
        for (int u = 0; u < image.width; ++u) {
          if (!camera.isWithinLens(u, v)) continue;
          const double rise = (X_WC.q * camera.unproject(u, v)).z();
          if (std::abs(rise) < 0.02) continue;  // within 1.2 px of the horizon
          const bool rim = std::hypot(u - 199.5, v - 199.5) > 180.0;
          if (!rim) {
            ASSERT_EQ(*image.pixel(u, v), rise < 0.0 ? 20 : 230) << tilt << ": " << u << " " << v;
          }
        }
      }
    }
  }
}

/** A target beside the camera or behind its image plane: area and centroid of its projected outline. */
TEST(Fisheye, AreaAndCentroidHoldAtEveryAngle) {
  const CameraConfig config = fisheye200Config();
  const CameraModel camera(config);
  for (const double theta : {0.0, 40.0, 70.0, 88.0, 92.0}) {
    for (const double azimuth : {0.1, 0.8, 2.5, -2.0}) {
      SCOPED_TRACE(theta);
      const Eigen::Vector3d ray(std::sin(theta * kDegree) * std::cos(azimuth),
                                std::sin(theta * kDegree) * std::sin(azimuth), std::cos(theta * kDegree));
      Scene scene = sceneWith(lShape());
      PlanarModel& target = scene.models[0];  // turned to the camera, and then some
      target.X_WM.q = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), -ray) *
                      Eigen::AngleAxisd(0.5, Eigen::Vector3d(0.6, 0.2, 0.7).normalized());
      target.X_WM.p = 0.35 * ray;
      const auto project = [&](const Eigen::Vector3d& p_C) { return projectFisheye(config, p_C); };
      const Blob exact = exactBlob(project, target.X_WM, target);
      CameraConfig all = config;  // no black rim, which would count as target
      all.cutoff_angle_rad.reset();
      all.horizontal_fov_rad = config.horizontal_fov_rad;
      Image image = render(CameraModel(all), Pose{}, scene);
      for (int v = 0; v < image.height; ++v) {
        for (int u = 0; u < image.width; ++u) {
          if (std::hypot(u - 199.5, v - 199.5) > 205.0) *image.pixel(u, v) = 230;
        }
      }
      const Blob found = blobOf(image);
      EXPECT_GT(exact.area, 300.0);
      EXPECT_NEAR(found.area, exact.area, kAreaTolerance);
      EXPECT_LT((found.centroid - exact.centroid).norm(), kCentroidTolerance);
    }
  }
}

/** The same scene by exact coverage and by triangles: differences are those of 8 x 8 samples. */
TEST(Fisheye, TrianglesAgreeWithExactCoverage) {
  constexpr double kSampling = 2.0 / 16.0 * 210.0 + 3.0;  // as through other lenses, and corners of several edges
  const CameraModel camera(fisheye200Config());
  Scene scene;
  scene.models.emplace_back("floor", std::vector<Polygon>{{{-2, -2}, {2, -2}, {2, 0.3}, {-2, 0.3}}}, Rgb{20, 20, 20},
                            PlanarModel::Board{{5.0, 5.0}, {120, 120, 120}});
  const Pose X_WC = lookingAlong({0.1, 0.0, 0.5}, {0.3, 0.9, 0.1}, {0.9, -0.3, 0.2});
  const Image exact = render(camera, X_WC, scene),
              drawn = render(camera, X_WC, scene, CoverageRenderer::Path::kSampled);
  int worse = 0;
  for (std::size_t i = 0; i < exact.data.size(); ++i) {
    worse += std::abs(int(exact.data[i]) - int(drawn.data[i])) > kSampling;
  }
  EXPECT_EQ(worse, 0);
}

TEST(Fisheye, BodiesBesideAndBehindTheImagePlaneAreSeenWhereTheyAre) {
  const CameraConfig config = fisheye200Config();
  const CameraModel camera(config);
  for (const double theta : {30.0, 80.0, 90.0, 95.0}) {
    const Eigen::Vector3d ray(std::sin(theta * kDegree) * 0.6, std::sin(theta * kDegree) * 0.8,
                              std::cos(theta * kDegree));
    Scene scene;
    scene.background = {0, 0, 0};
    Body ball;
    ball.name = "ball";
    ball.shapes.push_back({Pose{}, makeSphere(0.05, 96), {255, 255, 255}});
    ball.X_WB.p = 0.8 * ray;
    scene.bodies.push_back(ball);
    const Image image = render(camera, Pose{}, scene);
    Blob blob;
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        const double weight = *image.pixel(u, v) > 40 ? 1.0 : 0.0;
        blob.area += weight;
        blob.centroid += weight * Eigen::Vector2d(u, v);
      }
    }
    blob.centroid /= blob.area;
    EXPECT_GT(blob.area, 100.0);
    // Whole pixels, some 150 of them, and a disc whose image is no circle.
    EXPECT_LT((blob.centroid - projectFisheye(config, ray)).norm(), 0.25) << theta;
    GeometryRenderer renderer;
    GeometryImage geometry;
    const std::size_t at =
        geometry.at(0, 0) + std::size_t(std::lround(blob.centroid.y())) * config.width + std::lround(blob.centroid.x());
    renderer.render(camera, Pose{}, scene, geometry, Distance::kRange);
    ASSERT_EQ(geometry.ids[at], 1) << theta;
    EXPECT_NEAR(geometry.depth_m[at], 0.75, 1e-3);  // half a pixel of 0.5 degrees beside the pole: 0.3 mm
    renderer.render(camera, Pose{}, scene, geometry);
    if (theta > 91.0) {
      EXPECT_TRUE(std::isnan(geometry.depth_m[at]));
    } else if (theta < 89.0) {
      EXPECT_NEAR(geometry.depth_m[at], 0.75 * std::cos(theta * kDegree), 0.75 * 0.007);  // that pixel, across
    }
  }
}

TEST(Fisheye, RangeOfAFloorIsThatOfItsEquationInEveryDirection) {
  const CameraModel camera(fisheye200Config());
  const Pose X_WC = lookingAlong({0.3, -0.2, 0.5}, {0.3, 0.9, -0.2}, {0.95, -0.3, 0.1});
  Scene flat = sceneWith({{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}), solid;
  Body box;
  box.name = "box";
  box.shapes.push_back({Pose{}, makeBox({10.0, 10.0, 1.0}), {}});
  box.X_WB.p = {0.0, 0.0, -0.5};
  solid.bodies.push_back(box);
  CameraConfig far = camera.config();
  far.far_m = 20.0;
  for (const Scene* scene : {&flat, &solid}) {
    GeometryRenderer renderer;
    GeometryImage image;
    renderer.render(CameraModel(far), X_WC, *scene, image, Distance::kRange);
    int seen = 0;
    for (int v = 0; v < image.height; v += 3) {
      for (int u = 0; u < image.width; u += 3) {
        if (!camera.isWithinLens(u, v)) continue;
        const Eigen::Vector3d ray_W = X_WC.q * camera.unproject(u, v);
        const double range = -X_WC.p.z() / ray_W.z();
        const Eigen::Vector3d p = X_WC.p + range * ray_W;
        if (range < 0.0 || p.head<2>().cwiseAbs().maxCoeff() > 4.8) continue;
        ASSERT_EQ(image.ids[image.at(u, v)], 1) << u << " " << v;
        ASSERT_NEAR(image.depth_m[image.at(u, v)] / range, 1.0, scene == &flat ? 1e-7 : 1e-6);
        ++seen;
      }
    }
    EXPECT_GT(seen, 3000);
  }
}

TEST(Fisheye, NothingNearerThanTheNearPlanesIsSeenToAnySide) {
  const CameraModel camera(fisheye200Config());
  for (const Eigen::Vector3d& side : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0, 1)}) {
    Scene scene = sceneWith({{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}});
    scene.models[0].X_WM.q = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), -side);
    const Eigen::Vector2d px = camera.project(side).value();
    for (const double share : {0.9, 1.1}) {
      scene.models[0].X_WM.p = share * camera.nearM() * side;
      EXPECT_EQ(*render(camera, Pose{}, scene).pixel(int(px.x()), int(px.y())), share < 1.0 ? 230 : 20);
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::fisheye_test
