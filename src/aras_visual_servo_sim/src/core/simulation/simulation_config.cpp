#include "aras_visual_servo_sim/simulation/simulation_config.hpp"

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {
namespace {

WorldConfig worldOf(const SimConfig& settings) {
  static const std::map<std::string, Base> kBases = {
      {"as_urdf", Base::kFromModel}, {"fixed", Base::kFixed}, {"floating", Base::kFloating}, {"driven", Base::kDriven}};
  WorldConfig world;
  world.period_s = settings.period_s;
  world.gravity_m_s2 = settings.gravity_m_s2;
  world.drive = settings.drive;
  world.base = kBases.at(settings.base);
  if (settings.base_pose) world.X_WB = poseOf(*settings.base_pose);
  world.hold_idle_joints = settings.idle_joints == "hold";
  world.command_timeout_s = settings.command_timeout_s;
  world.contacts = settings.contacts;
  return world;
}

}  // namespace

SimulationConfig SimulationConfig::fromYaml(const YAML::Node& node) {
  SimulationConfig config;
  readSection<SimConfig>(node, "sim", [&config](const SimConfig& settings, const SectionCheck& section) {
    config.world = worldOf(settings);
    config.command_delay_s = settings.command_delay_s;
    config.seed = static_cast<std::uint64_t>(settings.seed);
    config.initial_positions = settings.initial_positions;
    for (const CameraKeys& camera : settings.cameras) config.cameras.push_back({camera, {}, {}, {}});
    config.tag_renderer = settings.tag_renderer;
    config.gazebo_cameras = settings.compatibility == "gazebo";
    config.scene = SceneConfig(settings.scene, section.part("scene"));
    if (config.gazebo_cameras) config.scene.lightAsGazebo();
    if (!section.faults().empty()) return;
    for (const CameraConfig& camera : config.cameras) {  // checks of a camera that a schema cannot express
      section.faults().collect([&] { CameraModel{camera}; });
    }
  });
  return config;
}

}  // namespace aras_visual_servo_sim
