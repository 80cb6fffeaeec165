// Planar models with a picture on them: every pixel is the mean of the texels its square sees.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "tools/messages.hpp"
#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing::picture_test {
namespace {

const Eigen::Vector2d kSize{0.30, 0.225};  // [m]

/** Smooth waves of several lengths, and discs with hard edges: nothing about it is symmetric. */
TexturePtr photo(int width, int height) {
  std::vector<std::uint8_t> rgb;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const double x = (i + 0.5) / width, y = (j + 0.5) / height;
      const double wave = std::sin(9.0 * x + 4.0 * y) + 0.6 * std::sin(31.0 * x * y + 2.0) + 0.3 * std::cos(70.0 * y);
      const bool disc = std::hypot(x - 0.7, y - 0.3) < 0.15 || std::hypot(x - 0.25, y - 0.6) < 0.1;
      const double grey = disc ? 230.0 : 110.0 + 40.0 * wave;
      rgb.insert(rgb.end(),
                 {std::uint8_t(grey), std::uint8_t(0.7 * grey + 30.0 * x), std::uint8_t(200.0 - 0.6 * grey)});
    }
  }
  return std::make_shared<Texture>("photo", width, height, rgb);
}

Scene photoScene(const TexturePtr& texture) {
  Scene scene;
  scene.models.emplace_back("photo", std::vector<Polygon>{}, Rgb{}, std::nullopt, PlanarModel::Picture{texture, kSize});
  return scene;
}

/** Mean of n x n rays of a pixel, each seeing a texel or the background. */
Eigen::Vector3d bruteForce(const CameraModel& camera, const Pose& X_WC, const Scene& scene, int u, int v, int n) {
  const PlanarModel& model = scene.models[0];
  const Texture& texture = *model.picture()->texture;
  const Pose X_MC = model.X_WM.inverse() * X_WC;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < n * n; ++k) {
    const Eigen::Vector3d d = X_MC.q * camera.unproject(u - 0.5 + (k % n + 0.5) / n, v - 0.5 + (k / n + 0.5) / n);
    const double lambda = -X_MC.p.z() / d.z();
    const Eigen::Vector3d p = X_MC.p + lambda * d;
    const double s = (p.x() / kSize.x() + 0.5) * texture.width(), t = (0.5 - p.y() / kSize.y()) * texture.height();
    if (lambda > 0.0 && s >= 0.0 && t >= 0.0 && s < texture.width() && t < texture.height()) {
      const std::uint8_t* rgb = texture.texel(int(s), int(t));
      sum += Eigen::Vector3d(rgb[0], rgb[1], rgb[2]);
    } else {
      sum += Eigen::Vector3d(scene.background.r, scene.background.g, scene.background.b);
    }
  }
  return sum / (n * n);
}

struct Errors {
  double worst = 0.0, rms = 0.0;  // [grey levels]
  int seen = 0;                   // pixels compared that see the picture
};

/** Against brute force, over a grid of pixels that covers the image, those that see something. */
Errors errorsOf(const Image& image, const CameraModel& camera, const Pose& X_WC, const Scene& scene, int n) {
  Errors errors;
  const Eigen::Vector3d nothing(scene.background.r, scene.background.g, scene.background.b);
  for (int v = 1; v < image.height; v += 14) {
    for (int u = 2; u < image.width; u += 14) {
      const Eigen::Vector3d truth = bruteForce(camera, X_WC, scene, u, v, n);
      if (truth == nothing) continue;
      const std::uint8_t* found = image.pixel(u, v);
      Eigen::Vector3d error;
      if (image.channels() == 1) {
        error.setConstant(found[0] - truth.dot(Eigen::Vector3d(0.299, 0.587, 0.114)));
      } else {
        const bool bgr = image.encoding == Encoding::kBgr8;
        for (int c = 0; c < 3; ++c) error[c] = found[bgr ? 2 - c : c] - truth[c];
      }
      errors.worst = std::max(errors.worst, error.cwiseAbs().maxCoeff());
      errors.rms += error.squaredNorm() / 3.0;
      ++errors.seen;
    }
  }
  errors.rms = std::sqrt(errors.rms / errors.seen);
  return errors;
}

struct View {
  const char* name;
  CameraConfig config;
  Pose X_WC;
};

std::vector<View> views() {
  CameraConfig fisheye = cameraConfig();
  fisheye.distortion_model = "equidistant";
  fisheye.distortion = {-0.02, 0.004, -0.001, 0.0002};
  CameraConfig wide = cameraConfig();
  wide.distortion_model = "equidistant";
  wide.horizontal_fov_rad = 3.3;  // 118 degrees from the axis in the corners
  CameraConfig color = cameraConfig();
  color.encoding = "rgb8";
  CameraConfig bgr = distortedConfig();
  bgr.encoding = "bgr8";
  return {
      {"parallel, far", cameraConfig(), lookingDown({0.0, 0.0, 0.6}, 0.0, 0.0, 0.07)},
      {"full view", color, lookingDown({0.005, -0.01, 0.15}, 0.05, -0.03, 0.3)},
      {"tilted", color, lookingDown({0.09, -0.11, 0.4}, 0.35, -0.2, 0.3)},
      {"steep", cameraConfig(), lookingDown({0.25, -0.02, 0.15}, 0.0, -1.0, 0.0)},
      {"near", cameraConfig(), lookingDown({0.02, 0.03, 0.05}, 0.1, 0.2, -1.1)},
      {"plumb bob", bgr, lookingDown({0.1, 0.08, 0.4}, 0.1, -0.15, 2.0)},
      {"fisheye", fisheye, lookingDown({0.1, -0.08, 0.3}, 0.1, 0.15, 0.5)},
      {"beside a fisheye", wide, lookingDown({0.06, 0.02, 0.08}, 1.7, 0.1, 0.5)},
      {"from behind",
       color,
       {{0.03, 0.02, -0.3}, Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.3, 0.2, 1.0).normalized()))}}};
}

/** Brute force of 32 x 32 rays errs too: an edge across a pixel by at most a row of them, 1/32 of a contrast of at most
 *  150 levels, 4.7, and far less at random. Rounding adds half a level here, and mono8 rounds texels too: 1 in all. */
TEST(Picture, PixelsAreMeansOverTheirSquares) {
  constexpr double kWorst = 4.7 + 1.0, kRms = 0.45;  // rms: two roundings of 0.29, and a tenth for the rest
  for (const View& view : views()) {
    const CameraModel camera(view.config);
    for (const int width : {60, 640, 2400}) {
      SCOPED_TRACE(view.name + (" " + std::to_string(width)));
      const Scene scene = photoScene(photo(width, width * 3 / 4));
      const Image image = render(camera, view.X_WC, scene);
      const Errors errors = errorsOf(image, camera, view.X_WC, scene, 32);
      EXPECT_GT(errors.seen, 30);
      EXPECT_LT(errors.worst, kWorst);
      EXPECT_LT(errors.rms, kRms);
    }
  }
}

/** A checkerboard as texels and as polygons: both are exact, so they differ by their roundings only. */
TEST(Picture, CheckerboardIsThatOfPolygons) {
  constexpr int kSquares = 6;
  std::vector<std::uint8_t> rgb;
  std::vector<Polygon> dark;
  const Eigen::Vector2d side = kSize / kSquares;
  for (int j = 0; j < kSquares; ++j) {
    for (int i = 0; i < kSquares; ++i) {
      const bool is_dark = (i + j) % 2 == 0;
      rgb.insert(rgb.end(), 3, is_dark ? 20 : 240);
      if (!is_dark) continue;
      const Eigen::Vector2d corner(i * side.x() - 0.5 * kSize.x(), 0.5 * kSize.y() - (j + 1) * side.y());
      dark.push_back(
          {corner, corner + Eigen::Vector2d(side.x(), 0.0), corner + side, corner + Eigen::Vector2d(0.0, side.y())});
    }
  }
  Scene polygons;
  polygons.models.emplace_back("board", dark, Rgb{20, 20, 20}, PlanarModel::Board{kSize, {240, 240, 240}});
  const Scene texels = photoScene(std::make_shared<Texture>("checkerboard", kSquares, kSquares, rgb));
  // One level for each of the two roundings; another where the board's border and a dark square share a pixel, which
  // polygons blend one after the other: coverages a and a instead of a at once, off by a (1 - a) <= 1/4 of 220.
  for (const View& view : views()) {
    if (view.X_WC.p.z() < 0.0) continue;  // from behind the board hides the polygons
    SCOPED_TRACE(view.name);
    CameraConfig config = view.config;
    config.encoding = "mono8";
    const CameraModel camera(config);
    const Image a = render(camera, view.X_WC, polygons), b = render(camera, view.X_WC, texels);
    int off = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i) off += std::abs(a.data[i] - b.data[i]) > 2;
    EXPECT_LT(off, 600) << off;
  }
}

TEST(Picture, CentreSamplingTakesOneTexel) {
  CameraConfig config = cameraConfig();
  config.sampling = "center";
  config.encoding = "bgr8";
  const CameraModel camera(config);
  const Scene scene = photoScene(photo(320, 240));
  const Pose X_WC = lookingDown({0.02, -0.01, 0.2}, 0.1, 0.2, 0.4);
  const Errors errors = errorsOf(render(camera, X_WC, scene), camera, X_WC, scene, 1);
  EXPECT_GT(errors.seen, 100);
  EXPECT_EQ(errors.worst, 0.0);
}

/** Behind a body the picture goes through the tiles of OpenGL: it must come out as without, where the body is not. */
TEST(Picture, IsTheSameBesideABody) {
  for (const char* encoding : {"mono8", "rgb8", "bgr8"}) {
    CameraConfig config = cameraConfig();
    config.encoding = encoding;
    const CameraModel camera(config);
    const Pose X_WC = lookingDown({0.02, 0.03, 0.25}, 0.1, 0.2, -1.1);
    const Scene scene = photoScene(photo(640, 480));
    const Image alone = render(camera, X_WC, scene);
    const Image by_tiles = render(camera, X_WC, scene, CoverageRenderer::Path::kSampled);
    // At the picture's border tiles have 64 samples: 1/8 of the contrast of 220 at the very worst; elsewhere rounding.
    int off = 0;
    for (std::size_t i = 0; i < alone.data.size(); ++i) {
      const int difference = std::abs(alone.data[i] - by_tiles.data[i]);
      EXPECT_LE(difference, 28);
      off += difference > 1;
    }
    EXPECT_LT(off, 1500);

    Scene occluded = scene;
    Body body;
    body.name = "ball";
    body.shapes.push_back({Pose{}, makeSphere(0.02), {10, 200, 30}});
    body.X_WB.p = {0.0, 0.0, 0.08};
    occluded.bodies.push_back(body);
    const Image with_body = render(camera, X_WC, occluded);
    int changed = 0;
    for (int v = 0; v < 240; ++v) {
      for (int u = 0; u < 320; ++u) {
        if (std::abs(*with_body.pixel(u, v) - *alone.pixel(u, v)) <= 28) continue;
        ++changed;
        const auto center = camera.project(X_WC.inverse() * body.X_WB.p);
        EXPECT_LT((*center - Eigen::Vector2d(u, v)).norm(), 30.0);  // 22 px radius, perspective and tilt
      }
    }
    EXPECT_GT(changed, 300);
  }
}

TEST(Picture, LiesBetweenOutlinesAndBoard) {
  CameraConfig config = cameraConfig();
  config.encoding = "rgb8";
  const CameraModel camera(config);
  const TexturePtr red = std::make_shared<Texture>("red", 1, 1, std::vector<std::uint8_t>{200, 10, 10});
  Scene scene;
  scene.models.emplace_back("all", std::vector<Polygon>{{{-0.02, -0.02}, {0.02, -0.02}, {0.02, 0.02}, {-0.02, 0.02}}},
                            Rgb{1, 2, 3}, PlanarModel::Board{{0.3, 0.2}, {240, 241, 242}},
                            PlanarModel::Picture{red, {0.1, 0.1}});
  for (const auto path : {CoverageRenderer::Path::kAutomatic, CoverageRenderer::Path::kSampled}) {
    const Image front = render(camera, lookingDown({0, 0, 0.4}), scene, path);
    EXPECT_EQ(front.pixel(160, 120)[0], 1);
    EXPECT_EQ(front.pixel(160 + 15, 120)[0], 200);
    EXPECT_EQ(front.pixel(160 + 40, 120)[0], 240);
    const Image back = render(camera, {{0, 0, -0.4}, Eigen::Quaterniond::Identity()}, scene, path);
    EXPECT_EQ(back.pixel(160, 120)[0], 240);
  }
}

TEST(Picture, TopOfTheFileIsAtPlusYAndItsRightAtPlusX) {
  CameraConfig config = cameraConfig();
  config.encoding = "rgb8";
  const CameraModel camera(config);
  const TexturePtr quarters =
      std::make_shared<Texture>("quarters", 2, 2, std::vector<std::uint8_t>{10, 0, 0, 20, 0, 0, 30, 0, 0, 40, 0, 0});
  const Scene scene = photoScene(quarters);
  const Pose X_WC = lookingDown({0, 0, 0.4});
  const auto at = [&](double x, double y) {
    const auto px = camera.project(X_WC.inverse() * Eigen::Vector3d(x, y, 0.0));
    return int(*render(camera, X_WC, scene).pixel(int(std::lround(px->x())), int(std::lround(px->y()))));
  };
  EXPECT_EQ(at(-0.05, 0.05), 10);
  EXPECT_EQ(at(0.05, 0.05), 20);
  EXPECT_EQ(at(-0.05, -0.05), 30);
  EXPECT_EQ(at(0.05, -0.05), 40);
}

TEST(Picture, HistoryLeavesNoTrace) {
  const CameraModel camera(distortedConfig());
  const Scene scene = photoScene(photo(640, 480));
  CoverageRenderer renderer;
  Image image;
  for (const double x : {0.2, -0.1, 0.03}) renderer.render(camera, lookingDown({x, 0.0, 0.3}, x), scene, image);
  EXPECT_EQ(image.data, render(camera, lookingDown({0.03, 0.0, 0.3}, 0.03), scene).data);
}

TEST(Picture, BadOnesAreRefusedByName) {
  EXPECT_THROW(Texture("none", 0, 4, {}), ModelError);
  EXPECT_THROW(Texture("short", 2, 2, std::vector<std::uint8_t>(11)), ModelError);
  EXPECT_THROW(Texture("huge", 5000, 4000, {}), ModelError);
  const TexturePtr dot = std::make_shared<Texture>("dot", 1, 1, std::vector<std::uint8_t>(3));
  EXPECT_THROW(PlanarModel("x", {}, Rgb{}, std::nullopt, PlanarModel::Picture{dot, {0.1, 0.0}}), ModelError);
  const SceneConfig lost =
      SceneConfig::fromYaml(YAML::Load("{models: [{name: t, image: {file: /nowhere/photo.png, size_m: [0.3, 0.2]}}]}"));
  EXPECT_HAS(messageOf<ModelError>([&] { loadScene(lost, {}); }), "/nowhere/photo.png");
  EXPECT_THROW(loadTexture(ARAS_SIM_TEST_DIR "/urdf/pendulum.urdf"), ModelError);
  EXPECT_THROW(
      loadScene(SceneConfig::fromYaml(YAML::Load("{models: [{name: t, image: {file: a.png, size_m: [0.3]}}]}")), {}),
      ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::picture_test
