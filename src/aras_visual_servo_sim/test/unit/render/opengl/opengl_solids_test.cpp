// Solids and flat targets against the coverage renderer.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "opengl_tools.hpp"

namespace aras_visual_servo_sim::testing::opengl_solids_test {
namespace {

// Light at each pixel here and at the corners there: it differs by this on round things.
constexpr int kLightOfPixels = 4;
// Of four samples at an edge of 100 levels, over the tenth of all pixels that have one.
constexpr double kMeanGrey = 0.5;

/** Black solids, through and beside each other and a grey plate. Black stays black in any light. */
Scene blackScene() {
  Scene scene = colourfulScene();
  scene.background = {255, 255, 255};
  scene.bodies.erase(scene.bodies.begin());
  for (Body& body : scene.bodies) body.shapes[0].color = {0, 0, 0};
  scene.models.emplace_back("plate", std::vector<Polygon>{{{-0.1, -0.08}, {0.12, -0.08}, {0.12, 0.08}, {-0.1, 0.08}}},
                            Rgb{128, 128, 128});
  return scene;
}

TEST(OpenGl, DrawsTheSameSolids) {
  constexpr int kFine = 8;
  const CameraModel camera(cameraConfig());
  CameraConfig fine_config = cameraConfig();
  fine_config.width *= kFine;
  fine_config.height *= kFine;
  fine_config.sampling = "center";
  fine_config.exact_targets = false;
  const Scene scene = blackScene();
  const Pose X_WC = lookingDown({0.01, 0.02, 0.35}, 0.2, -0.3, 0.5);
  const Image image = render(camera, X_WC, scene);
  const Image fine = renderOpenGl(CameraModel(fine_config), X_WC, scene);
  double sum = 0.0;
  int worst = 0, edges = 0;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      int grey = 0;
      for (int k = 0; k < kFine * kFine; ++k) grey += *fine.pixel(kFine * u + k % kFine, kFine * v + k / kFine);
      const int difference = int(*image.pixel(u, v)) - (grey + 32) / 64;
      edges += grey > 0 && grey < 64 * 255 && grey != 64 * 128;
      worst = std::max(worst, std::abs(difference));
      sum += difference;
    }
  }
  ASSERT_GT(edges, 500);
  // One straight edge is off by 1/16 of a pixel at most in either pattern; two meet in a corner.
  constexpr double kSampling = 2.0 * (1.0 / 16.0 + 1.0 / 16.0) * 255.0;
  EXPECT_LE(worst, kSampling);
  // Over all edge pixels these errors cancel: 1/16/sqrt(3) each, both patterns, four standard deviations.
  EXPECT_LE(std::abs(sum), 4.0 * 255.0 * 0.036 * std::sqrt(2.0 * edges));
}

TEST(OpenGl, LightsSolidsAsTheCoverageRendererDoes) {
  for (const char* encoding : {"rgb8", "bgr8", "mono8"}) {
    CameraConfig config = cameraConfig();
    config.encoding = encoding;
    config.cx_px = 120.3;
    config.cy_px = 140.8;
    const CameraModel camera(config);
    const Pose X_WC = lookingDown({0.01, 0.02, 0.35}, 0.2, -0.3, 0.5);
    const Image expected = render(camera, X_WC, colourfulScene());
    const Difference difference = differenceOf(expected, renderOpenGl(camera, X_WC, colourfulScene()));
    EXPECT_LE(difference.inside, kLightOfPixels) << encoding;
    EXPECT_EQ(difference.apart, 0) << encoding;
    EXPECT_LE(std::abs(difference.mean), kMeanGrey) << encoding;
  }
}

TEST(OpenGl, LaysTargetsOverSolidsWithTheirExactCoverage) {
  CameraConfig config = cameraConfig();
  config.encoding = "rgb8";
  const CameraModel camera(config);
  const Pose X_WC = lookingDown({0.01, 0.02, 0.5}, 0.1, -0.1, 0.5);
  Scene scene = sceneWith(lShape());
  const Image alone = render(camera, X_WC, scene);
  EXPECT_EQ(renderOpenGl(camera, X_WC, scene).data, alone.data);
  scene.bodies.push_back(solid("box", makeBox({0.05, 0.05, 0.05}), {200, 60, 40}, {0.3, 0.0, 0.0}));
  OpenGlRenderer renderer;
  Image image;
  renderer.render(camera, X_WC, scene, image);
  EXPECT_FALSE(renderer.statistics().redrawn_flats);
  int beside = 0;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < 200; ++u) beside += image.pixel(u, v)[0] != alone.pixel(u, v)[0];
  }
  EXPECT_EQ(beside, 0);  // the box stands to the right of that
  EXPECT_NE(image.data, alone.data);
}

TEST(OpenGl, SolidsHideTargetsAndTargetsHideSolids) {
  CameraConfig config = cameraConfig();
  config.encoding = "rgb8";
  const CameraModel camera(config);
  const Pose X_WC = lookingDown({0.01, 0.02, 0.5}, 0.1, -0.1, 0.5);
  Scene scene = sceneWith(lShape());
  scene.lighting.shadows = false;
  scene.bodies.push_back(solid("over", makeBox({0.03, 0.03, 0.03}), {200, 60, 40}, {0.05, -0.04, 0.05}));
  scene.bodies.push_back(solid("under", makeBox({0.06, 0.06, 0.03}), {60, 200, 40}, {-0.04, 0.0, -0.05}));
  OpenGlRenderer renderer;
  Image image;
  renderer.render(camera, X_WC, scene, image);
  EXPECT_TRUE(renderer.statistics().redrawn_flats);
  const Difference difference = differenceOf(render(camera, X_WC, scene), image);
  EXPECT_LE(difference.inside, kLightOfPixels);
  EXPECT_EQ(difference.apart, 0);
}

TEST(OpenGl, DrawsPicturesOnTargetsAndMeshes) {
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < 64 * 64; ++k) {
    const bool light = (k / 16 + k / (64 * 16)) % 2 == 0;
    rgb.insert(rgb.end(), {std::uint8_t(light ? 240 : 20), std::uint8_t(light ? 200 : 60), std::uint8_t(120)});
  }
  const auto texture = std::make_shared<Texture>("checks", 64, 64, rgb);
  Scene scene;
  scene.lighting.shadows = false;
  scene.models.emplace_back("picture", std::vector<Polygon>{}, Rgb{}, std::nullopt,
                            PlanarModel::Picture{texture, {0.3, 0.3}});
  CameraConfig config = cameraConfig();
  config.encoding = "rgb8";
  config.exact_targets = false;  // OpenGL's own
  const CameraModel camera(config);
  const Pose X_WC = lookingDown({0.01, 0.02, 0.5}, 0.1, -0.1, 0.5);
  // Texels are squares in one and interpolated in the other: they agree in the mean and where no edge is near.
  const Difference difference = differenceOf(render(camera, X_WC, scene), renderOpenGl(camera, X_WC, scene));
  EXPECT_LE(difference.inside, 2);
  EXPECT_LE(std::abs(difference.mean), kMeanGrey);
}

// The coverage renderer draws round bodies exactly. Polyhedra lie inside them: seen in the area, over the outline's
// length.
TEST(OpenGl, OutlinesOfRoundBodiesAreRightToATwentiethOfAPixel) {
  constexpr double kOutline_px = 0.05;
  const CameraModel camera(cameraConfig());
  for (const MeshPtr& mesh : {makeSphere(0.1), makeCylinder(0.1, 0.02), makeCone(0.1, 0.1)}) {
    for (const double height : {0.25, 0.4, 1.0, 3.0}) {
      Scene scene;
      scene.background = {255, 255, 255};
      scene.lighting.shadows = false;
      scene.bodies.push_back(solid("round", mesh, {0, 0, 0}, {0.0, 0.0, 0.0}));
      const Pose X_WC = lookingDown({0.003, 0.002, height}, 0.05, -0.05, 0.4);
      const auto area = [](const Image& image) {
        double sum = 0.0;
        for (int v = 0; v < image.height; ++v)
          for (int u = 0; u < image.width; ++u) sum += 1.0 - *image.pixel(u, v) / 255.0;
        return sum;
      };
      const double exact = area(render(camera, X_WC, scene));
      ASSERT_GT(exact, 50.0);
      EXPECT_NEAR(area(renderOpenGl(camera, X_WC, scene)), exact, kOutline_px * std::sqrt(4.0 * M_PI * exact))
          << height;
    }
  }
}

TEST(OpenGl, HighQualityIsNearerToExactCoverage) {
  CameraConfig config = cameraConfig();
  config.exact_targets = false;
  const Scene scene = sceneWith(lShape());
  const Pose X_WC = lookingDown({0.01, 0.02, 0.5}, 0.1, -0.1, 0.5);
  const Blob exact = blobOf(render(CameraModel(config), X_WC, scene));
  const auto error = [&](const char* quality) {
    config.quality = quality;
    const Blob blob = blobOf(renderOpenGl(CameraModel(config), X_WC, scene));
    EXPECT_NEAR(blob.area, exact.area, 10.0);
    return (blob.centroid - exact.centroid).norm();
  };
  EXPECT_LT(error("normal"), 0.02);  // [px] a hundred edge pixels, four samples in each
  EXPECT_LT(error("high"), 0.01);
}

TEST(OpenGl, NothingBeyondTheFarPlaneIsDrawn) {
  CameraConfig config = cameraConfig();
  config.far_m = 0.6;
  const CameraModel camera(config);
  Scene scene;
  scene.background = {255, 255, 255};
  scene.lighting.shadows = false;
  scene.bodies.push_back(solid("pole", makeBox({0.02, 0.02, 1.0}), {0, 0, 0}, {0.1, 0.0, 0.0}));
  const Image image = renderOpenGl(camera, lookingDown({0.0, 0.0, 0.9}), scene);
  const auto seen = [&](double depth) {
    return *image.pixel(int(std::lround(camera.cx() + camera.fx() * 0.09 / depth)), 120);
  };
  EXPECT_LT(seen(0.5), 5);    // on the pole's side
  EXPECT_GT(seen(0.8), 250);  // farther down
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_solids_test
