#include "aras_visual_servo_sim/simulation/simulation_config.hpp"

#include "aras_visual_servo_sim/camera/camera_config_reader.hpp"
#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/physics/contact_config.hpp"

namespace aras_visual_servo_sim {
namespace {

WorldConfig readWorld(YamlReader& reader) {
  WorldConfig world;
  world.period_s = reader.get<double>("period_s");
  world.gravity_m_s2 = reader.get<Eigen::Vector3d>("gravity_m_s2");
  world.drive = reader.choice<Drive>("drive", {{"implicit", Drive::kImplicit}, {"explicit", Drive::kExplicit}});
  world.base = reader.choice<Base>("base", {{"as_urdf", Base::kFromModel},
                                            {"fixed", Base::kFixed},
                                            {"floating", Base::kFloating},
                                            {"driven", Base::kDriven}});
  if (reader.has("base_pose")) {
    YamlReader pose = reader.section("base_pose");
    world.X_WB = Pose{pose.get<Eigen::Vector3d>("position_m"), quaternionFromRpy(pose.get<Eigen::Vector3d>("rpy_rad"))};
  }
  world.hold_idle_joints = reader.choice<bool>("idle_joints", {{"free", false}, {"hold", true}});
  world.command_timeout_s = reader.get<double>("command_timeout_s");
  world.contacts = readContacts(reader.section("contacts"));
  return world;
}

}  // namespace

SimulationConfig SimulationConfig::fromYaml(const YAML::Node& node) {
  SimulationConfig config;
  YamlReader reader(node, sectionOf("sim"), "sim");
  config.world = readWorld(reader);
  config.command_delay_s = reader.get<double>("command_delay_s");
  config.seed = static_cast<std::uint64_t>(reader.get<std::int64_t>("seed"));
  YamlReader positions = reader.section("initial_positions");
  for (const std::string& joint : positions.keys()) config.initial_positions[joint] = positions.get<double>(joint);
  for (YamlReader& camera : reader.list("cameras")) config.cameras.push_back(readCameraConfig(camera));
  config.tag_renderer = reader.get<std::string>("tag_renderer");
  config.gazebo_cameras = reader.choice<bool>("compatibility", {{"none", false}, {"gazebo", true}});
  config.scene = SceneConfig::read(reader.section("scene"));
  if (config.gazebo_cameras) config.scene.lightAsGazebo();
  if (reader.faults().empty()) {  // checks of a camera that a schema cannot express
    for (const CameraConfig& camera : config.cameras) reader.faults().collect([&] { CameraModel{camera}; });
  }
  reader.finish();
  return config;
}

}  // namespace aras_visual_servo_sim
