// Cost of one frame of 320 x 240 under light, drawn by OpenGL: a plane, a picture on it, ten boxes, their shadow.
// Run: light_bench [--benchmark_filter=...]; the scenes are those that MuJoCo's camera is measured with.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include "aras_visual_servo_sim/render/coverage_renderer.hpp"
#include "aras_visual_servo_sim/render/opengl_renderer.hpp"

namespace aras_visual_servo_sim {
namespace {

struct Kind {
  const char* name;
  bool textured, multisampled, boxes, shadow, moving;
};

constexpr Kind kKinds[] = {
    {"flat", false, false, false, false, false},          {"textured", true, false, false, false, false},
    {"textured_msaa", true, true, false, false, false},   {"boxes", false, false, true, false, false},
    {"boxes_shadow", false, false, true, true, true},     {"everything", true, true, true, true, true},
    {"everything_at_rest", true, true, true, true, false}};

CameraModel cameraOf(const Kind& kind) {
  CameraConfig config;
  config.width = 320;
  config.height = 240;
  config.fx_px = config.fy_px = 120.0 / std::tan(0.5 * 63.0 * M_PI / 180.0);
  config.sampling = kind.multisampled ? "coverage" : "center";
  return CameraModel(config);
}

TexturePtr checks() {
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < 512 * 512; ++k) {
    const bool light = ((k % 512) / 256 + k / (512 * 256)) % 2 == 0;
    for (const int level : {light ? 204 : 26, light ? 179 : 51, light ? 153 : 77}) {
      rgb.push_back(static_cast<std::uint8_t>(level));
    }
  }
  return std::make_shared<Texture>("checks", 512, 512, rgb);
}

/** Six metres square at z = 0, its picture four times each way. */
MeshPtr plane(bool textured) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->points = {{-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}};
  mesh->normals.assign(4, Eigen::Vector3f::UnitZ());
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  if (textured) {
    mesh->texture_coordinates = {{0, 4}, {4, 4}, {4, 0}, {0, 0}};
    mesh->pictures = {{checks()}};
    mesh->picture_of = {0, 0};
  }
  mesh->finish();
  return mesh;
}

Scene sceneOf(const Kind& kind) {
  Scene scene;
  Light sun;
  sun.name = "sun";
  sun.diffuse.setConstant(0.7);
  scene.lighting.lights = {sun};
  scene.lighting.ambient.setConstant(0.1);
  scene.lighting.shadows = kind.shadow;
  const auto add = [&](const std::string& name, const MeshPtr& mesh, const Rgb& color, const Eigen::Vector3d& p) {
    Body body;
    body.name = name;
    body.shapes.push_back({Pose{}, mesh, color, Material{}});
    body.X_WB.p = p;
    scene.bodies.push_back(body);
  };
  const Rgb white{255, 255, 255}, grey{128, 128, 128};
  add("plane", plane(kind.textured), kind.textured ? white : grey, {0, 0, 0});
  scene.bodies.back().casts_shadows = false;
  for (int i = 0; kind.boxes && i < 10; ++i) {
    add("box" + std::to_string(i), makeBox({0.1, 0.1, 0.1}), {204, 77, 51},
        {-0.25 + 0.1 * (i % 5), -0.1 + 0.2 * (i / 5), 0.05});
  }
  return scene;
}

template <typename AnyRenderer>
void run(benchmark::State& state, const Kind& kind) {
  const CameraModel camera = cameraOf(kind);
  Scene scene = sceneOf(kind);
  const Pose X_WC{{0, 0, 0.6}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()))};
  AnyRenderer renderer;
  Image image;
  for (auto _ : state) {
    if (kind.moving) scene.bodies.back().X_WB.p.x() += 1e-9;  // its shadow is drawn anew
    renderer.render(camera, X_WC, scene, image);
    benchmark::DoNotOptimize(image.data.data());
  }
}

void registerAll() {
  for (const Kind& kind : kKinds) {
    const auto add = [&](const std::string& renderer, auto* function) {
      benchmark::RegisterBenchmark((renderer + "/" + kind.name).c_str(), function, kind)->Unit(benchmark::kMicrosecond);
    };
    add("opengl", &run<OpenGlRenderer>);
    if (!kind.shadow) add("coverage", &run<CoverageRenderer>);
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim

int main(int argc, char** argv) {
  aras_visual_servo_sim::registerAll();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
