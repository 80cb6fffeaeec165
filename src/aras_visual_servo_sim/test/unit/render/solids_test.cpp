#include <gtest/gtest.h>

#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing::solids_test {
namespace {

Body boxAt(const char* name, const Eigen::Vector3d& p_W, const Eigen::Vector3d& size_m, Rgb color) {
  Body body;
  body.name = name;
  body.shapes.push_back({Pose{}, makeBox(size_m), color});
  body.X_WB.p = p_W;
  return body;
}

TEST(Solids, AgreesWithExactCoverageWithinItsSampling) {
  // A regular 8 x 8 grid misjudges the coverage of a pixel by one straight edge by at most 1/16; plus corners (two
  // edges), rounding, and OpenGL's snapping of corners to 1/256 of a sample.
  constexpr double kSampling = 2.0 / 16.0 * 210.0 + 1.0;
  // Over a whole outline at an angle these errors cancel: random, 1/16/sqrt(3) each on some 400 edge pixels.
  constexpr double kArea = 4.0 * 0.036 * 20.0;
  for (const CameraConfig& config : {cameraConfig(), distortedConfig()}) {
    const CameraModel camera(config);
    const Scene scene = sceneWith(lShape());
    const Pose X_WC = lookingDown({0.05, -0.06, 0.4}, 0.2, 0.1, 0.4);
    const Image exact = render(camera, X_WC, scene);
    const Image sampled = render(camera, X_WC, scene, CoverageRenderer::Path::kSampled);
    int worst = 0;
    for (std::size_t i = 0; i < exact.data.size(); ++i) {
      worst = std::max(worst, std::abs(int(exact.data[i]) - int(sampled.data[i])));
    }
    EXPECT_LE(worst, kSampling);
    EXPECT_NEAR(blobOf(exact).area, blobOf(sampled).area, kArea);
    constexpr double kSampledCentroid = 0.02;  // [px] what the sampled path must reach
    EXPECT_LE((blobOf(exact).centroid - blobOf(sampled).centroid).norm(), kSampledCentroid);
  }
}

TEST(Solids, IsNotTouchedWhileNoBodyIsInView) {
  const CameraModel camera(cameraConfig());
  Scene scene = sceneWith(lShape());
  scene.bodies.push_back(boxAt("behind", {0, 0, 1.0}, {0.1, 0.1, 0.1}, {255, 0, 0}));
  scene.bodies.push_back(boxAt("beside", {2.0, 0, 0.0}, {0.1, 0.1, 0.1}, {255, 0, 0}));
  scene.bodies.push_back(boxAt("housing", {0, 0, 0.4}, {0.1, 0.1, 0.1}, {255, 0, 0}));  // the camera is inside
  scene.bodies.push_back(boxAt("far", {0, 0, -9.0}, {0.1, 0.1, 0.1}, {255, 0, 0}));
  CoverageRenderer renderer;
  Image image;
  renderer.render(camera, lookingDown({0, 0, 0.4}), scene, image);
  EXPECT_FALSE(renderer.statistics().tiles > 0);
  EXPECT_EQ(image.data, render(camera, lookingDown({0, 0, 0.4}), sceneWith(lShape())).data);
}

TEST(Solids, BodiesHideWhatIsBehindThemAndNothingElse) {
  const CameraModel camera(cameraConfig());
  const Polygon square{{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}};
  for (const double z : {0.1, -0.1}) {
    Scene scene = sceneWith(square);
    scene.bodies.push_back(boxAt("box", {0.03, 0.03, z}, {0.02, 0.02, 0.02}, {120, 120, 120}));
    CoverageRenderer renderer;
    Image image;
    renderer.render(camera, lookingDown({0, 0, 0.4}), scene, image);
    const Eigen::Vector2d box = *camera.project({0.03, -0.03, 0.4 - z - 0.01});
    const int value = *image.pixel(static_cast<int>(box.x()), static_cast<int>(box.y()));
    if (z > 0) {
      EXPECT_TRUE(value > 30 && value <= 120) << value;  // lit
    } else {
      EXPECT_EQ(value, 20);  // unlit target in front
    }
    EXPECT_EQ(*image.pixel(145, 130), 20);
    EXPECT_EQ(*image.pixel(10, 10), 230);
  }
}

TEST(Solids, WallsSeenEdgeOnBehindABoardLeaveItsEdgesExact) {
  const CameraModel camera(cameraConfig());
  Scene scene;
  scene.background = {230, 230, 230};
  scene.models.emplace_back("t", std::vector<Polygon>{lShape()}, Rgb{20, 20, 20},
                            PlanarModel::Board{{0.4, 0.3}, {230, 230, 230}});
  const Pose X_WC = lookingDown({0.0, 0.0, 0.4});
  const Image exact = render(camera, X_WC, scene);
  Body boxes;
  boxes.name = "boxes";
  for (int k = 0; k < 400; ++k) {
    const Eigen::Vector3d place(0.012 * (k % 20 - 9.5), 0.012 * (k / 20 - 9.5), -0.03);  // NOLINT
    boxes.shapes.push_back({Pose{place, Eigen::Quaterniond::Identity()}, makeBox({0.01, 0.01, 0.002}), {0, 0, 0}});
  }
  scene.bodies.push_back(boxes);
  CoverageRenderer renderer;
  Image image;
  renderer.render(camera, X_WC, scene, image);
  EXPECT_GT(renderer.statistics().tiles, 0);
  int differing = 0;
  for (std::size_t i = 0; i < image.data.size(); ++i) differing += image.data[i] != exact.data[i];
  EXPECT_LE(differing, 4);  // where the board's own diagonal crosses the outline
}

TEST(Solids, TilesAwayFromBodiesKeepTheExactCoverage) {
  const CameraModel camera(cameraConfig());
  Scene scene = sceneWith(lShape());
  const Pose X_WC = lookingDown({0.0, 0.0, 0.4}, 0.1, 0.2, 0.3);
  const Image exact = render(camera, X_WC, scene);
  scene.bodies.push_back(boxAt("box", {-0.2, 0.1, 0.0}, {0.02, 0.02, 0.02}, {120, 120, 120}));
  const Image image = render(camera, X_WC, scene);
  int differing = 0;
  for (std::size_t i = 0; i < image.data.size(); ++i) differing += image.data[i] != exact.data[i];
  EXPECT_GT(differing, 50);    // the box is there
  EXPECT_LT(differing, 1000);  // and nothing else changed
}

TEST(Solids, SphereCoversTheAreaOfItsOutline) {
  const CameraModel camera(cameraConfig());
  Scene scene;
  scene.background = {0, 0, 0};
  Body ball;
  ball.name = "ball";
  ball.shapes.push_back({Pose{}, makeSphere(0.05, 96), {255, 255, 255}});
  scene.bodies.push_back(ball);
  const Image image = render(camera, lookingDown({0, 0, 0.5}), scene);
  const auto lit = std::count_if(image.data.begin(), image.data.end(), [](std::uint8_t x) { return x > 40; });
  const double radius_px = camera.fx() * std::tan(std::asin(0.05 / 0.5));
  constexpr double kRing = 0.03;  // [-] partly covered pixels around the rim, and 96 corners instead of a circle
  EXPECT_NEAR(lit, M_PI * radius_px * radius_px, kRing * M_PI * radius_px * radius_px);
}

TEST(Solids, SameFrameSameBytesWhateverWasDrawnBefore) {
  const CameraModel camera(distortedConfig());
  Scene scene = sceneWith(lShape());
  scene.bodies.push_back(boxAt("box", {0.02, 0.02, 0.05}, {0.03, 0.02, 0.04}, {120, 60, 10}));
  CoverageRenderer renderer;
  Image first, other, again;
  renderer.render(camera, lookingDown({0, 0, 0.4}), scene, first);
  renderer.render(camera, lookingDown({0.1, 0, 0.2}, 0.5, 0.2), scene, other);
  renderer.render(camera, lookingDown({0, 0, 0.4}), scene, again);
  EXPECT_TRUE(renderer.statistics().tiles > 0);
  EXPECT_EQ(first.data, again.data);
  EXPECT_EQ(first.data, render(camera, lookingDown({0, 0, 0.4}), scene).data);
}

TEST(Solids, TwoRenderersDoNotDisturbEachOther) {
  const CameraModel small(cameraConfig());
  CameraConfig config = cameraConfig();
  config.width = 100;
  config.height = 77;
  config.encoding = "rgb8";
  const CameraModel odd(config);
  Scene scene = sceneWith(lShape());
  scene.bodies.push_back(boxAt("box", {0.02, 0.02, 0.05}, {0.03, 0.02, 0.04}, {120, 60, 10}));
  CoverageRenderer a, b;
  Image image_a, image_b, again;
  a.render(small, lookingDown({0, 0, 0.4}), scene, image_a);
  b.render(odd, lookingDown({0, 0, 0.4}), scene, image_b);
  a.render(small, lookingDown({0, 0, 0.4}), scene, again);
  EXPECT_EQ(image_a.data, again.data);
  EXPECT_EQ(image_b.data.size(), 3u * 100 * 77);
}

TEST(Solids, BodyCutByTheNearPlaneAndTheBordersIsDrawn) {
  const CameraModel camera(distortedConfig());
  Scene scene;
  scene.bodies.push_back(boxAt("floor", {0, 0, -0.5}, {4, 4, 1}, {100, 100, 100}));
  const Image image = render(camera, lookingDown({0, 0, 0.3}, 0.6), scene);  // the horizon is out of view
  EXPECT_TRUE(std::all_of(image.data.begin() + 120 * 320, image.data.end(), [](std::uint8_t x) { return x <= 110; }));
}

TEST(Solids, TilesThatSeeOneFacetAreShadedAsPixelByPixel) {
  // A lens of next to no effect takes the way of every pixel by itself, through the same rays.
  CameraConfig config = cameraConfig(), bent = cameraConfig();
  bent.distortion_model = "plumb_bob";
  bent.distortion = {1e-14, 0.0, 0.0, 0.0, 0.0};
  Scene scene = sceneWith(lShape());
  scene.models.front().X_WM.p.z() = 0.011;
  scene.bodies.push_back(boxAt("table", {0.05, 0.0, -0.01}, {0.5, 0.4, 0.04}, {230, 120, 40}));
  scene.bodies.push_back(boxAt("block", {0.1, 0.1, 0.03}, {0.1, 0.1, 0.06}, {40, 120, 230}));
  const Pose X_WC = lookingDown({0.05, -0.06, 0.4}, 0.3, -0.2, 0.4);
  for (const char* encoding : {"rgb8", "bgr8", "mono8"}) {
    config.encoding = bent.encoding = encoding;
    const Image whole = render(CameraModel(config), X_WC, scene), single = render(CameraModel(bent), X_WC, scene);
    ASSERT_EQ(whole.data.size(), single.data.size());
    std::size_t differing = 0;
    for (std::size_t i = 0; i < whole.data.size(); ++i) {
      const int difference = std::abs(int(whole.data[i]) - int(single.data[i]));
      differing += difference > 0;
      ASSERT_LE(difference, 1) << "byte " << i;
    }
    EXPECT_LT(differing, whole.data.size() / 1000);  // sums in another order: a rounding here and there
  }
}

/** A hill of triangles with a smooth colour. */
MeshPtr hill() {
  constexpr int kSide = 9;
  auto mesh = std::make_shared<TriangleMesh>();
  for (int k = 0; k < kSide * kSide; ++k) {
    const float x = 0.05f * float(k % kSide) - 0.2f, y = 0.05f * float(k / kSide) - 0.2f;  // NOLINT
    mesh->points.emplace_back(x, y, 0.03f - 0.5f * (x * x + y * y));
    mesh->normals.push_back(Eigen::Vector3f(x, y, 1.0f).normalized());
  }
  for (std::uint32_t k = 0; k + kSide + 1 < kSide * kSide; ++k) {
    if (k % kSide == kSide - 1) continue;
    mesh->triangles.push_back({k, k + 1, k + kSide + 1});
    mesh->triangles.push_back({k, k + kSide + 1, k + kSide});
  }
  mesh->finish();
  return mesh;
}

TEST(Solids, TilesThatSeeSeveralFacetsOfASurfaceAreShadedAsPixelByPixel) {
  CameraConfig config = cameraConfig(), bent = cameraConfig();
  bent.distortion_model = "plumb_bob";
  bent.distortion = {1e-14, 0.0, 0.0, 0.0, 0.0};
  Scene scene;
  Body body = boxAt("hill", {0.0, 0.0, 0.0}, {0.1, 0.1, 0.1}, {230, 120, 40});
  body.shapes[0].mesh = hill();
  scene.bodies.push_back(body);
  scene.bodies.push_back(boxAt("table", {0.05, 0.0, -0.06}, {0.9, 0.9, 0.02}, {40, 120, 230}));
  const Pose X_WC = lookingDown({0.05, -0.06, 0.4}, 0.3, -0.2, 0.4);
  for (const char* sampling : {"coverage", "center"}) {
    config.sampling = bent.sampling = sampling;
    const Image whole = render(CameraModel(config), X_WC, scene), single = render(CameraModel(bent), X_WC, scene);
    std::size_t differing = 0;
    for (std::size_t i = 0; i < whole.data.size(); ++i) {
      const int difference = std::abs(int(whole.data[i]) - int(single.data[i]));
      differing += difference > 1;
    }
    EXPECT_LT(differing, 20U);  // where rays of other roundings take another side of an edge
  }
}

TEST(Solids, EdgesWithinASurfaceAreNoneWhereTheImageCutsIt) {
  Scene scene;
  scene.bodies.push_back(boxAt("floor", {0, 0, -0.5}, {4, 4, 1}, {100, 100, 100}));
  const CameraModel camera(cameraConfig());
  CoverageRenderer renderer;
  Image image;
  renderer.render(camera, lookingDown({0.1, 0.2, 0.3}, 0.1, 0.2, 0.3), scene, image);
}

TEST(Renderer, RejectsPosesThatAreNotFinite) {
  const CameraModel camera(cameraConfig());
  Scene scene = sceneWith(lShape());
  Pose bad;
  bad.p.x() = std::nan("");
  EXPECT_THROW(render(camera, bad, scene), NotFiniteError);
  scene.models[0].X_WM.q.w() = std::nan("");
  EXPECT_THROW(render(camera, Pose{}, scene), NotFiniteError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::solids_test
