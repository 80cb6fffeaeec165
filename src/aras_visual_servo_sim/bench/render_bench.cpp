// Cost of one frame at 320 x 240. Run: render_bench [--benchmark_filter=...]
#include <benchmark/benchmark.h>

#include <cmath>

#include "aras_visual_servo_sim/image/sensor/gaussian_noise.hpp"
#include "aras_visual_servo_sim/render/coverage_renderer.hpp"

namespace aras_visual_servo_sim {
namespace {

CameraModel camera(const char* encoding, bool lens) {
  CameraConfig config;
  config.width = 320;
  config.height = 240;
  config.horizontal_fov_rad = 1.41;
  config.encoding = encoding;
  if (lens) {
    config.distortion_model = "plumb_bob";
    config.distortion = {-0.3306, 0.117, 0.0, 0.0, 0.0};
  }
  return CameraModel(config);
}

/** A 20-cornered blob, about 75 px wide from 0.5 m. */
Scene blobScene() {
  Polygon outline;
  for (int i = 0; i < 20; ++i) {
    const double angle = 2.0 * M_PI * i / 20, radius = 0.08 + 0.02 * std::cos(angle) + 0.01 * std::cos(3.0 * angle);
    outline.emplace_back(radius * std::cos(angle), 0.8 * radius * std::sin(angle));
  }
  Scene scene;
  scene.models.emplace_back("blob", std::vector<Polygon>{outline}, Rgb{20, 20, 20});
  return scene;
}

/** Robot-like parts: cylinders and boxes beside and over the blob. */
Scene occludedScene(int parts) {
  Scene scene = blobScene();
  for (int i = 0; i < parts; ++i) {
    Body body;
    body.name = std::to_string(i);
    const MeshPtr mesh = i % 2 == 0 ? makeCylinder(0.012, 0.1) : makeBox({0.03, 0.02, 0.06});
    body.shapes.push_back({Pose{}, mesh, {200, 120, 40}});
    body.X_WB.p = Eigen::Vector3d(0.06 * (i % 5) - 0.12, 0.08 * (i / 5), 0.1 + 0.01 * i);
    body.X_WB.q = Eigen::AngleAxisd(0.4 * i, Eigen::Vector3d(1, 1, 0).normalized());
    scene.bodies.push_back(body);
  }
  return scene;
}

Pose poseOf(std::int64_t frame) {
  const Eigen::Quaterniond down(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  return {{0.01 + 1e-5 * double(frame % 1000), 0.02, 0.5},
          down * Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.2, 0.1, 1.0).normalized())};
}

void run(benchmark::State& state, const CameraModel& model, const Scene& scene,
         CoverageRenderer::Path path = CoverageRenderer::Path::kAutomatic) {
  CoverageRenderer renderer(path);
  Image image;
  std::int64_t frame = 0;
  for (auto _ : state) {
    renderer.render(model, poseOf(frame++), scene, image);
    benchmark::DoNotOptimize(image.data.data());
  }
  state.counters["sampled"] = renderer.statistics().sampled_pixels;
  state.counters["triangles"] = renderer.statistics().triangles;
}

/** What an image with noise takes: light, noise, rounding. */
void coverageNoise(benchmark::State& state) {
  const CameraModel model = camera("rgb8", false);
  const Scene scene = blobScene();
  CoverageRenderer renderer;
  FineImage light;
  Image image;
  std::int64_t frame = 0;
  for (auto _ : state) {
    renderer.render(model, poseOf(frame), scene, light);
    addGaussianNoise(light, 2.0, 1, static_cast<std::uint64_t>(frame++), 0.0, light.encoding, image);
    benchmark::DoNotOptimize(image.data.data());
  }
}
void coverageRgb(benchmark::State& state) { run(state, camera("rgb8", false), blobScene()); }
void coverageMono(benchmark::State& state) { run(state, camera("mono8", false), blobScene()); }
void coverageLens(benchmark::State& state) { run(state, camera("rgb8", true), blobScene()); }
void coverageBoard(benchmark::State& state) {
  Scene scene = blobScene();
  const PlanarModel blob = scene.models[0];
  scene.models[0] = PlanarModel("blob", blob.outlines(), blob.color(), PlanarModel::Board{{2.0, 2.0}, {250, 250, 245}});
  run(state, camera("rgb8", false), scene);
}
/** A picture of 640 x 480 texels that fills the view, at 1.6 to 2.2 texels a pixel. */
void picture(benchmark::State& state, const char* encoding) {
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < 640 * 480 * 3; ++k) rgb.push_back(static_cast<std::uint8_t>(k * 7 % 251));
  Scene scene;
  scene.models.emplace_back("photo", std::vector<Polygon>{}, Rgb{}, std::nullopt,
                            PlanarModel::Picture{std::make_shared<Texture>("photo", 640, 480, rgb), {1.5, 1.125}});
  run(state, camera(encoding, false), scene);
}
void pictureRgb(benchmark::State& state) { picture(state, "rgb8"); }
void pictureMono(benchmark::State& state) { picture(state, "mono8"); }
void glBlobOnly(benchmark::State& state) {
  run(state, camera("rgb8", false), blobScene(), CoverageRenderer::Path::kSampled);
}
void occludedByTwo(benchmark::State& state) { run(state, camera("rgb8", false), occludedScene(2)); }
void occluded(benchmark::State& state) { run(state, camera("rgb8", false), occludedScene(10)); }
void occludedLens(benchmark::State& state) { run(state, camera("rgb8", true), occludedScene(10)); }
void noise(benchmark::State& state) {
  CoverageRenderer renderer;
  FineImage light;
  Image image;
  renderer.render(camera("rgb8", false), poseOf(0), blobScene(), light);
  std::uint64_t frame = 0;
  for (auto _ : state) addGaussianNoise(light, 2.0, 1, frame++, 0.0, light.encoding, image);
}

BENCHMARK(coverageRgb)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageNoise)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageMono)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageLens)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageBoard)->Unit(benchmark::kMicrosecond);
BENCHMARK(pictureRgb)->Unit(benchmark::kMicrosecond);
BENCHMARK(pictureMono)->Unit(benchmark::kMicrosecond);
BENCHMARK(glBlobOnly)->Unit(benchmark::kMicrosecond);
BENCHMARK(occludedByTwo)->Unit(benchmark::kMicrosecond);
BENCHMARK(occluded)->Unit(benchmark::kMicrosecond);
BENCHMARK(occludedLens)->Unit(benchmark::kMicrosecond);
BENCHMARK(noise)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace aras_visual_servo_sim

BENCHMARK_MAIN();
