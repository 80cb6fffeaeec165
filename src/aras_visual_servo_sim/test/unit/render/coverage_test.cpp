#include <gtest/gtest.h>

#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing::coverage_test {
namespace {

struct View {
  const char* name;
  CameraConfig config;
  Pose X_WC;
};

std::vector<View> views() {
  CameraConfig shifted = cameraConfig();
  shifted.cx_px = 150.3;
  shifted.cy_px = 131.7;
  CameraConfig fisheye = cameraConfig();
  fisheye.distortion_model = "equidistant";
  fisheye.distortion = {-0.02, 0.004, -0.001, 0.0002};
  CameraConfig rational = cameraConfig();
  rational.distortion_model = "rational_polynomial";
  rational.distortion = {0.2, 0.05, 0.001, 0.0005, 0.01, 0.35, 0.1, 0.01};
  return {{"parallel", cameraConfig(), lookingDown({0.0, 0.0, 0.45})},
          {"rolled", cameraConfig(), lookingDown({0.013, -0.021, 0.4}, 0.0, 0.0, 0.7)},
          {"tilted", cameraConfig(), lookingDown({0.09, -0.11, 0.4}, 0.35, -0.2, 0.3)},
          {"shifted", shifted, lookingDown({0.02, 0.03, 0.4}, 0.1, 0.2, -1.1)},
          {"plumb bob", distortedConfig(), lookingDown({0.1, 0.08, 0.4}, 0.1, -0.15, 2.0)},
          {"rational", rational, lookingDown({-0.1, 0.08, 0.4}, -0.1, -0.15, 1.0)},
          {"fisheye", fisheye, lookingDown({0.1, -0.08, 0.4}, 0.1, 0.15, 0.5)}};
}

TEST(Coverage, AreaAndCentroidAgreeWithTheProjectedOutline) {
  for (const View& view : views()) {
    SCOPED_TRACE(view.name);
    const CameraModel camera(view.config);
    const Scene scene = sceneWith(lShape());
    const Blob found = blobOf(render(camera, view.X_WC, scene));
    const Blob exact = exactBlob(camera, view.X_WC, scene.models[0]);
    EXPECT_GT(exact.area, 500.0);
    EXPECT_NEAR(found.area, exact.area, kAreaTolerance);
    EXPECT_NEAR(found.centroid.x(), exact.centroid.x(), kCentroidTolerance);
    EXPECT_NEAR(found.centroid.y(), exact.centroid.y(), kCentroidTolerance);
  }
}

TEST(Coverage, CornersAreFoundWhereTheyProject) {
  // The corner of a bright square region is seen through sums: rows left of the corner's column are empty.
  const CameraModel camera(cameraConfig());
  const Polygon square{{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}};
  const Scene scene = sceneWith(square);
  const Pose X_WC = lookingDown({0.0123, 0.0071, 0.4});
  const Image image = render(camera, X_WC, scene);
  const auto weight = [&](int u, int v) { return (230.0 - *image.pixel(u, v)) / 210.0; };
  const Pose X_CW = X_WC.inverse();
  const Eigen::Vector2d a = *camera.project(X_CW * Eigen::Vector3d(-0.05, 0.05, 0.0));  // top left in the image
  const Eigen::Vector2d b = *camera.project(X_CW * Eigen::Vector3d(0.05, -0.05, 0.0));
  const int middle_u = static_cast<int>(0.5 * (a.x() + b.x())), middle_v = static_cast<int>(0.5 * (a.y() + b.y()));
  double left = -0.5, right = -0.5, top = -0.5, bottom = -0.5;  // edges: sums of what is outside and inside
  for (int u = 0; u < 320; ++u) {
    if (u < middle_u) left += 1.0 - weight(u, middle_v);
    right += u < middle_u ? 1.0 : weight(u, middle_v);
  }
  for (int v = 0; v < 240; ++v) {
    if (v < middle_v) top += 1.0 - weight(middle_u, v);
    bottom += v < middle_v ? 1.0 : weight(middle_u, v);
  }
  constexpr double kHalfLevel = 0.51 / 210.0;  // [px] one edge pixel, rounded to 8 bits
  EXPECT_NEAR(left, a.x(), kHalfLevel);
  EXPECT_NEAR(right, b.x(), kHalfLevel);
  EXPECT_NEAR(top, a.y(), kHalfLevel);
  EXPECT_NEAR(bottom, b.y(), kHalfLevel);
}

TEST(Coverage, XGoesRightAndYGoesDown) {
  const CameraModel camera(cameraConfig());
  const Scene scene = sceneWith({{0.05, 0.05}, {0.08, 0.05}, {0.08, 0.07}, {0.05, 0.07}});
  const Pose X_WC{{0.065, 0.06, -0.4}, Eigen::Quaterniond::Identity()};  // from below: C parallel to W
  Pose moved = X_WC;
  moved.p += Eigen::Vector3d(-0.1, -0.05, 0.0);
  const Blob centered = blobOf(render(camera, X_WC, scene)), shifted = blobOf(render(camera, moved, scene));
  EXPECT_NEAR(shifted.centroid.x() - centered.centroid.x(), 0.1 / 0.4 * camera.fx(), 2 * kCentroidTolerance);
  EXPECT_NEAR(shifted.centroid.y() - centered.centroid.y(), 0.05 / 0.4 * camera.fy(), 2 * kCentroidTolerance);
}

TEST(Coverage, PartBeyondTheBorderIsCutOff) {
  const CameraModel camera(cameraConfig());
  for (const Eigen::Vector2d& side :
       {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)}) {
    const Scene scene = sceneWith({{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}});
    const double reach_m = 0.4 / camera.fx() * (side.x() != 0.0 ? 160.0 : 120.0);  // puts its centre on the border
    const Blob blob = blobOf(render(camera, lookingDown({side.x() * reach_m, side.y() * reach_m, 0.4}), scene));
    const double width_px = 0.1 / 0.4 * camera.fx();
    EXPECT_NEAR(blob.area, 0.5 * width_px * width_px, kAreaTolerance);
  }
}

TEST(Coverage, TheLastPixelsOfEveryBorderAreWeighedLikeAnyOther) {
  const CameraModel camera(cameraConfig());
  const double pixel_m = 0.4 / camera.fx();
  for (const Eigen::Vector2i& side :
       {Eigen::Vector2i(1, 0), Eigen::Vector2i(-1, 0), Eigen::Vector2i(0, 1), Eigen::Vector2i(0, -1)}) {
    // From `inner` pixels before the border to far beyond it, 100 px to either side of the middle of that border.
    for (const double inner : {0.25, 1.5}) {
      const double half_px = side.x() != 0 ? 160.0 : 120.0;
      const double begin = (half_px - inner) * pixel_m, end = 2.0 * half_px * pixel_m, across = 100.0 * pixel_m;
      const auto corner = [&](double along, double beside) {  // in the image x goes right, y down; the world's y up
        return Eigen::Vector2d(side.x() * along + side.y() * beside, -(side.y() * along + side.x() * beside));
      };
      const Scene scene =
          sceneWith({corner(begin, -across), corner(end, -across), corner(end, across), corner(begin, across)});
      const Image image = render(camera, lookingDown({0.0, 0.0, 0.4}), scene);
      const auto weight = [&](int from_border) {  // 0: the last pixel
        const int u = side.x() > 0 ? 319 - from_border : side.x() < 0 ? from_border : 160;
        const int v = side.y() > 0 ? 239 - from_border : side.y() < 0 ? from_border : 120;
        return (230.0 - *image.pixel(u, v)) / 210.0;
      };
      constexpr double kLevel = 0.51 / 210.0;
      EXPECT_NEAR(weight(0), std::min(1.0, inner), kLevel) << side.transpose() << " " << inner;
      EXPECT_NEAR(weight(1), std::max(0.0, inner - 1.0), kLevel) << side.transpose() << " " << inner;
      EXPECT_EQ(weight(2), 0.0) << side.transpose() << " " << inner;
    }
  }
}

TEST(Coverage, TargetBehindTheCameraOrTooNearIsNotSeen) {
  const CameraModel camera(cameraConfig());
  const Scene scene = sceneWith(lShape());
  const Image empty = render(camera, lookingDown({0.0, 0.0, -0.4}), scene);
  EXPECT_TRUE(std::all_of(empty.data.begin(), empty.data.end(), [](std::uint8_t x) { return x == 230; }));
  const Image near = render(camera, lookingDown({0.0, 0.0, 0.5 * camera.nearM()}), scene);
  EXPECT_TRUE(std::all_of(near.data.begin(), near.data.end(), [](std::uint8_t x) { return x == 230; }));
}

TEST(Coverage, PlaneThroughTheCameraEndsAtTheHorizon) {
  CameraConfig config = cameraConfig();
  const CameraModel camera(config);
  const Scene scene = sceneWith({{-50, -50}, {50, -50}, {50, 50}, {-50, 50}});
  // Looking along the world's y, 0.3 m above the plane: all below the horizon is plane, to within 50 m.
  const Pose X_WC = lookingDown({0.0, 0.0, 0.3}, 0.5 * M_PI);
  const Image image = render(camera, X_WC, scene);
  EXPECT_EQ(*image.pixel(160, 10), 230);
  EXPECT_EQ(*image.pixel(160, 230), 20);
  const double horizon = camera.cy() + camera.fy() * 0.3 / 50.0;
  EXPECT_NEAR(blobOf(image).area, 320.0 * (239.5 - horizon), 320 * 0.51 / 210.0);
}

TEST(Coverage, ColoursAreExactInEveryEncoding) {
  for (const char* encoding : {"rgb8", "bgr8", "mono8"}) {
    CameraConfig config = cameraConfig();
    config.encoding = encoding;
    const CameraModel camera(config);
    Scene scene = sceneWith(lShape());
    scene.background = {10, 200, 30};
    scene.models.clear();
    scene.models.emplace_back("t", std::vector<Polygon>{{{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}}},
                              Rgb{250, 100, 7}, PlanarModel::Board{{0.2, 0.15}, {60, 70, 80}});
    for (const auto path : {CoverageRenderer::Path::kAutomatic, CoverageRenderer::Path::kSampled}) {
      const Image image = render(camera, lookingDown({0, 0, 0.4}), scene, path);
      const auto expect = [&](int u, int v, int r, int g, int b) {
        const std::uint8_t* pixel = image.pixel(u, v);
        if (image.encoding == Encoding::kMono8) {
          EXPECT_EQ(pixel[0], static_cast<int>(0.299 * r + 0.587 * g + 0.114 * b + 0.5));
        } else {
          EXPECT_EQ(pixel[image.encoding == Encoding::kRgb8 ? 0 : 2], r);
          EXPECT_EQ(pixel[1], g);
          EXPECT_EQ(pixel[image.encoding == Encoding::kRgb8 ? 2 : 0], b);
        }
      };
      expect(5, 5, 10, 200, 30);
      expect(160, 120, 250, 100, 7);
      expect(160 - 40, 120, 60, 70, 80);
    }
  }
}

TEST(Coverage, BoardHidesTheOutlinesFromBehind) {
  const CameraModel camera(cameraConfig());
  Scene scene;
  scene.models.emplace_back("t", std::vector<Polygon>{lShape()}, Rgb{20, 20, 20},
                            PlanarModel::Board{{0.3, 0.3}, {100, 100, 100}});
  const Pose below{{-0.04, 0.0, -0.4}, Eigen::Quaterniond::Identity()};
  for (const auto path : {CoverageRenderer::Path::kAutomatic, CoverageRenderer::Path::kSampled}) {
    EXPECT_EQ(*render(camera, below, scene, path).pixel(160, 120), 100);
    EXPECT_EQ(*render(camera, lookingDown({-0.04, 0.0, 0.4}), scene, path).pixel(160, 120), 20);
  }
}

TEST(Coverage, CenterSamplingGivesTwoValuesOnlyAndPixelsWhoseCentresAreInside) {
  CameraConfig config = cameraConfig();
  config.sampling = "center";
  const CameraModel camera(config);
  const Scene scene = sceneWith({{-0.05, -0.04}, {0.05, -0.04}, {0.05, 0.04}, {-0.05, 0.04}});
  const Image image = render(camera, lookingDown({0.0013, 0.0007, 0.4}), scene);
  const Eigen::Vector2d a = *camera.project({-0.05 - 0.0013, -(0.04 - 0.0007), 0.4});
  const Eigen::Vector2d b = *camera.project({0.05 - 0.0013, 0.04 + 0.0007, 0.4});
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const bool inside = u > a.x() && u < b.x() && v > a.y() && v < b.y();
      ASSERT_EQ(*image.pixel(u, v), inside ? 20 : 230) << u << " " << v;
    }
  }
}

TEST(Coverage, NearerOfTwoModelsIsOnTopWhateverTheirOrder) {
  const CameraModel camera(cameraConfig());
  const Polygon square{{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}};
  for (const bool swapped : {false, true}) {
    Scene scene;
    scene.models.emplace_back("low", std::vector<Polygon>{square}, Rgb{50, 50, 50});
    scene.models.emplace_back("high", std::vector<Polygon>{square}, Rgb{90, 90, 90});
    scene.models[1].X_WM.p.z() = 0.1;
    if (swapped) std::swap(scene.models[0], scene.models[1]);
    CoverageRenderer renderer;
    Image image;
    renderer.render(camera, lookingDown({0, 0, 0.5}, 0.1), scene, image);
    EXPECT_FALSE(renderer.statistics().tiles > 0);
    EXPECT_EQ(*image.pixel(160, static_cast<int>(120 + 0.1 * 195)), 90);
  }
}

TEST(Coverage, CrossingPlanesAreLeftToOpenGl) {
  const CameraModel camera(cameraConfig());
  const Polygon square{{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}};
  Scene scene;
  scene.models.emplace_back("a", std::vector<Polygon>{square}, Rgb{50, 50, 50});
  scene.models.emplace_back("b", std::vector<Polygon>{square}, Rgb{90, 90, 90});
  scene.models[1].X_WM.q = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY());  // dives below a where x > 0
  CoverageRenderer renderer;
  Image image;
  renderer.render(camera, lookingDown({0, 0, 0.5}), scene, image);
  EXPECT_TRUE(renderer.statistics().tiles > 0);
  EXPECT_EQ(*image.pixel(150, 120), 90);
  EXPECT_EQ(*image.pixel(170, 120), 50);
}

TEST(Coverage, HistoryLeavesNoTrace) {
  const CameraModel camera(distortedConfig());
  const Scene scene = sceneWith(lShape());
  CoverageRenderer renderer;
  Image first, other, again;
  renderer.render(camera, lookingDown({0.02, 0.01, 0.4}, 0.2), scene, first);
  renderer.render(camera, lookingDown({-0.2, 0.1, 0.2}, 0.3, 0.4, 1.0), scene, other);
  renderer.render(camera, lookingDown({0.02, 0.01, 0.4}, 0.2), scene, again);
  EXPECT_EQ(first.data, again.data);
  EXPECT_NE(first.data, other.data);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::coverage_test
