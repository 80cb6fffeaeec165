// Cost of one frame under light: a plane, a picture on it, ten boxes, their shadow; the arm over a table. 320 x 240
// unless said.
// Run: light_bench [--benchmark_filter=...], or light_bench --rate NAME: frames per second of CPU time as the last
// word. The scenes without the arm are those that MuJoCo's camera is measured with.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <iterator>
#include <memory>
#include <string>

#include "aras_visual_servo_sim/render/coverage_renderer.hpp"
#include "aras_visual_servo_sim/render/opengl_renderer.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Draws the next frame. */
using Draw = std::function<void()>;

Light lamp(const Eigen::Vector3d& direction_W, double diffuse) {
  Light light;
  light.name = "sun";
  light.direction_W = direction_W;
  light.diffuse.setConstant(diffuse);
  return light;
}

/** Draws by a renderer of its own. @param moves  the last body, in each frame: its shadow is drawn anew */
template <typename AnyRenderer>
Draw drawing(const CameraModel& camera, const Pose& X_WC, const Scene& scene, bool moves) {
  struct Stage {
    Stage(const CameraModel& of, const Scene& seen) : camera(of), scene(seen) {}
    CameraModel camera;
    Scene scene;
    AnyRenderer renderer;
    Image image;
  };
  const auto stage = std::make_shared<Stage>(camera, scene);
  return [stage, X_WC, moves] {
    if (moves) stage->scene.bodies.back().X_WB.p.x() += 1e-9;
    stage->renderer.render(stage->camera, X_WC, stage->scene, stage->image);
    benchmark::DoNotOptimize(stage->image.data.data());
  };
}

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
  scene.lighting.lights = {lamp({0.0, 0.0, -1.0}, 0.7)};
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
Draw planeDrawing(const Kind& kind) {
  const Pose X_WC{{0, 0, 0.6}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()))};
  return drawing<AnyRenderer>(cameraOf(kind), X_WC, sceneOf(kind), kind.moving);
}

// --- the arm --------------------------------------------------------------------------------------------------------

struct ArmKind {
  const char* name;
  int shadow_px;  ///< 0: none
  bool moving, in_view, everything;
  int width = 320;
};

constexpr ArmKind kArmKinds[] = {{"arm_casts_512", 512, true, false, false},
                                 {"arm_casts_1024", 1024, true, false, false},
                                 {"arm_casts_2048", 2048, true, false, false},
                                 {"arm_casts_512_at_rest", 512, false, false, false},
                                 {"arm_casts_1024_at_rest", 1024, false, false, false},
                                 {"arm_casts_2048_at_rest", 2048, false, false, false},
                                 {"arm", 0, true, true, false},
                                 {"arm_shadow", 1024, true, true, false},
                                 {"arm_everything", 1024, true, true, true},
                                 {"arm_everything_640", 1024, true, true, true, 640}};

/** The arm over a table, its links where they are at the start. */
Scene armScene(const ArmKind& kind, Pose& X_WC) {
  const PackagePaths packages;
  const std::string file = packages.resolve("package://aras_description/urdf/aras_arm.urdf");
  const YAML::Node config =
      YAML::Load("cameras: [{name: eye, frame: camera_optical_frame, width: 8, height: 8, horizontal_fov_rad: 1.41}]");
  Simulation sim(loadRobotModelFile(file), SimulationConfig::fromYaml(config), YAML::Node(), packages);
  sim.render(0);  // puts the links into the scene
  Scene scene = sim.scene();
  X_WC = sim.cameraPose(0);
  Body table;
  table.name = "table";
  table.shapes.push_back({Pose{}, plane(kind.everything), {200, 200, 200}, Material{}});
  table.X_WB.p.z() = 0.19;
  table.casts_shadows = false;
  scene.bodies.insert(scene.bodies.begin(), table);
  scene.lighting.lights = {lamp({0.3, 0.4, -1.0}, 0.7)};
  scene.lighting.ambient.setConstant(0.3);
  scene.lighting.shadows = kind.shadow_px > 0;
  if (kind.shadow_px > 0) scene.lighting.shadow_map_px = kind.shadow_px;
  if (kind.everything) {
    scene.lighting.lights[0].specular.setConstant(0.5);
    for (Body& body : scene.bodies) {
      for (Shape& shape : body.shapes) shape.material.specular.setConstant(0.3);
    }
  }
  if (kind.in_view) {
    const Eigen::Vector3d from(1.3, -1.3, 1.0), to(0.0, 0.0, 0.85);
    Eigen::Matrix3d R;
    R.col(2) = (to - from).normalized();
    R.col(0) = R.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
    R.col(1) = R.col(2).cross(R.col(0));
    X_WC = {from, Eigen::Quaterniond(R)};
  }
  return scene;
}

Draw armDrawing(const ArmKind& kind) {
  CameraConfig config;
  config.width = kind.width;
  config.height = 3 * kind.width / 4;
  config.horizontal_fov_rad = 1.0;
  config.sampling = kind.everything ? "coverage" : "center";
  Pose X_WC;
  const Scene scene = armScene(kind, X_WC);
  return drawing<OpenGlRenderer>(CameraModel(config), X_WC, scene, kind.moving);
}

// --- worst cases of the coverage renderer ---------------------------------------------------------------------------

/** The lens of the published camera. */
CameraModel lensCamera() {
  CameraConfig config;
  config.width = 320;
  config.height = 240;
  config.horizontal_fov_rad = 1.41;
  config.distortion_model = "plumb_bob";
  config.distortion = {-0.33, 0.117, 0.0, 0.0, 0.0};
  return CameraModel(config);
}

/** A box of three by four metres that fills the view, and no picture, through the lens. */
Draw tableThroughLens() {
  Scene scene = sceneOf(kKinds[0]);
  scene.bodies[0].shapes[0].mesh = makeBox({3.0, 4.0, 0.02});
  const Pose X_WC{{0.1, 0.2, 0.6}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI - 0.1, Eigen::Vector3d::UnitX()))};
  return drawing<CoverageRenderer>(lensCamera(), X_WC, scene, false);
}

/** The arm's meshes through the lens, seen from beside the arm. */
Draw armThroughLens() {
  Pose X_WC;
  const Scene scene = armScene({"", 0, false, true, false}, X_WC);
  return drawing<CoverageRenderer>(lensCamera(), X_WC, scene, false);
}

/** A picture of 1600 x 1200 texels on a mesh that fills 640 x 480, exact. */
Draw posterDrawing() {
  CameraConfig config;
  config.width = 640;
  config.height = 480;
  config.horizontal_fov_rad = 65.0 * M_PI / 180.0;
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < 1600 * 1200 * 3; ++k) rgb.push_back(static_cast<std::uint8_t>(std::int64_t(k) * k * 7 % 251));
  auto mesh = std::make_shared<TriangleMesh>(*plane(true));
  mesh->points = {{-0.4f, -0.3f, 0}, {0.4f, -0.3f, 0}, {0.4f, 0.3f, 0}, {-0.4f, 0.3f, 0}};
  mesh->texture_coordinates = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh->pictures = {{std::make_shared<Texture>("poster", 1600, 1200, rgb)}};
  mesh->finish();
  Scene scene = sceneOf(kKinds[0]);
  scene.bodies[0].shapes[0] = Shape{Pose{}, mesh, {255, 255, 255}, Material{}};
  const Pose X_WC{{0.01, 0.02, 0.45}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()))};
  return drawing<CoverageRenderer>(CameraModel(config), X_WC, scene, false);
}

/** The scene with everything, and a flat target before the boxes. @param exact  it is laid over by its exact areas */
Draw hybridDrawing(bool exact) {
  const Kind& kind = *std::find_if(std::begin(kKinds), std::end(kKinds),
                                   [](const Kind& each) { return std::string(each.name) == "everything"; });
  Scene scene = sceneOf(kind);
  scene.models.emplace_back("target", std::vector<Polygon>{{{-0.1, -0.05}, {0.1, -0.05}, {0.08, 0.05}, {-0.1, 0.06}}},
                            Rgb{20, 20, 20});
  scene.models.back().X_WM = {{0.0, 0.22, 0.001},
                              Eigen::Quaterniond(Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitZ()))};
  CameraConfig config = cameraOf(kind).config();
  config.exact_targets = exact;
  const Pose X_WC{{0, 0, 0.6}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()))};
  return drawing<OpenGlRenderer>(CameraModel(config), X_WC, scene, kind.moving);
}

// --- all of them ----------------------------------------------------------------------------------------------------

struct Case {
  std::string name;
  std::function<Draw()> make;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Kind& kind : kKinds) {
    all.push_back({std::string("opengl/") + kind.name, [&kind] { return planeDrawing<OpenGlRenderer>(kind); }});
    if (kind.shadow) continue;
    all.push_back({std::string("coverage/") + kind.name, [&kind] { return planeDrawing<CoverageRenderer>(kind); }});
  }
  for (const ArmKind& kind : kArmKinds) {
    all.push_back({std::string("opengl/") + kind.name, [&kind] { return armDrawing(kind); }});
  }
  all.push_back({"opengl/hybrid", [] { return hybridDrawing(true); }});
  all.push_back({"opengl/hybrid_sampled", [] { return hybridDrawing(false); }});
  all.push_back({"coverage/table_lens", tableThroughLens});
  all.push_back({"coverage/arm_lens", armThroughLens});
  all.push_back({"coverage/poster_640", posterDrawing});
  return all;
}

void run(benchmark::State& state, const Case& each) {
  const Draw draw = each.make();
  draw();  // shaders, textures
  for (auto _ : state) draw();
}

/** Frames per second of CPU time. */
double rateOf(const Case& each) {
  const Draw draw = each.make();
  draw();
  const std::clock_t start = std::clock();
  std::clock_t now = start;
  long frames = 0;
  for (; now - start < CLOCKS_PER_SEC; ++frames, now = std::clock()) draw();
  return double(frames) * CLOCKS_PER_SEC / double(now - start);
}

}  // namespace
}  // namespace aras_visual_servo_sim

int main(int argc, char** argv) {
  using namespace aras_visual_servo_sim;
  const std::vector<Case> all = cases();
  if (argc == 3 && std::string(argv[1]) == "--rate") {
    for (const Case& each : all) {
      if (each.name != argv[2]) continue;
      std::printf("%s %.1f\n", each.name.c_str(), rateOf(each));
      return 0;
    }
    std::fprintf(stderr, "light_bench: no scene '%s'\n", argv[2]);
    return 2;
  }
  for (const Case& each : all) {
    benchmark::RegisterBenchmark(each.name.c_str(), [&each](benchmark::State& state) {
      run(state, each);
    })->Unit(benchmark::kMicrosecond);
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
