// What draws: a camera and a scene as they stand in a scenario, drawn by the renderer that measures.
#include <aras_visual_servo_common/files.hpp>

#include "aras_visual_servo_sim/render/coverage_renderer.hpp"
#include "aras_visual_servo_sim/render/geometry_image.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation_config.hpp"
#include "target.hpp"

using namespace aras_visual_servo_sim;
using aras_visual_servo_common::kMostSentYaml;
using aras_visual_servo_common::parseYaml;

namespace {

constexpr int kMostSide = 48;  // pixels: larger images take longer and show the same

bool namesFiles(const SceneConfig& scene) {
  for (const ModelEntry& model : scene.models) {
    if (!model.file.empty() || model.shape.picture) return true;
  }
  for (const SolidEntry& solid : scene.solids) {
    if (solid.geometry.type == Geometry::Type::kMesh || !solid.urdf.empty()) return true;
  }
  return false;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::offer(bytes, size, [](const std::string& text) {
    const SimulationConfig config = SimulationConfig::fromYaml(parseYaml(text, kMostSentYaml));
    if (namesFiles(config.scene)) return;
    const Scene scene = loadScene(config.scene, PackagePaths());
    for (const CameraConfig& each : config.cameras) {
      if (each.width > kMostSide || each.height > kMostSide) continue;
      const CameraModel camera(each);
      const Pose X_WC{{0.0, 0.0, 1.0}, quaternionFromRpy({3.0, 0.2, 0.4})};
      CoverageRenderer renderer;
      Image image;
      renderer.render(camera, X_WC, scene, image);
      GeometryRenderer geometry;
      GeometryImage depths;
      geometry.render(camera, X_WC, scene, depths);
    }
  });
}
