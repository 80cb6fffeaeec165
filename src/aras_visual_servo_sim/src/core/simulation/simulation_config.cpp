#include "aras_visual_servo_sim/simulation/simulation_config.hpp"

#include "aras_visual_servo_sim/camera/camera_config_reader.hpp"
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/yaml_reader.hpp"
#include "aras_visual_servo_sim/physics/contact_config.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kShortestPeriodS = 1e-6;
constexpr double kLongestPeriodS = 0.1;

void appendFaults(const std::string& more, std::string& faults) {
  if (!faults.empty()) faults += "\n";
  faults += more;
}

void readCameras(const YAML::Node& list, std::vector<CameraConfig>& cameras, std::string& faults) {
  if (!list || list.IsNull()) return;
  if (!list.IsSequence()) return appendFaults("sim/cameras: found no list, allowed a list of cameras", faults);
  for (std::size_t k = 0; k < list.size(); ++k) {
    try {
      cameras.push_back(cameraConfigFromYaml(list[k]));
    } catch (const ParameterError& error) {
      appendFaults("sim/cameras[" + std::to_string(k) + "]: " + error.what(), faults);
    }
  }
}

}  // namespace

SimulationConfig SimulationConfig::fromYaml(const YAML::Node& node) {
  SimulationConfig config;
  std::string faults;
  YamlReader reader(node, "sim");
  config.world.period_s =
      reader.optional<double>("period_s", config.world.period_s, Range::between(kShortestPeriodS, kLongestPeriodS));
  config.world.gravity_m_s2 = reader.optional<Eigen::Vector3d>("gravity_m_s2", config.world.gravity_m_s2);
  config.world.drive = reader.optionalChoice("drive", "implicit", {"implicit", "explicit"}) == "explicit"
                           ? Drive::kExplicit
                           : Drive::kImplicit;
  const std::string base = reader.optionalChoice("base", "as_urdf", {"as_urdf", "fixed", "floating"});
  config.world.base = base == "fixed" ? Base::kFixed : base == "floating" ? Base::kFloating : Base::kFromModel;
  if (reader.has("base_pose")) {
    YamlReader pose = reader.section("base_pose");
    config.world.X_WB = Pose{pose.optional<Eigen::Vector3d>("position_m", Eigen::Vector3d::Zero()),
                             quaternionFromRpy(pose.optional<Eigen::Vector3d>("rpy_rad", Eigen::Vector3d::Zero()))};
  }
  config.seed = static_cast<std::uint64_t>(reader.optional<std::int64_t>("seed", 0, Range::nonNegative()));
  config.command_timeout_s = reader.optional<double>("command_timeout_s", 0.1, Range::nonNegative());
  config.world.command_timeout_s = config.command_timeout_s;
  YamlReader positions = reader.section("initial_positions");
  for (const std::string& joint : positions.keys()) {
    config.initial_positions[joint] = positions.required<double>(joint);
  }
  readCameras(reader.raw("cameras"), config.cameras, faults);
  config.gazebo_cameras = reader.optionalChoice("compatibility", "none", {"none", "gazebo"}) == "gazebo";
  const auto collect = [&faults](const auto& action) {
    try {
      action();
    } catch (const ParameterError& error) {
      appendFaults(error.what(), faults);
    }
  };
  collect([&] { config.world.contacts = contactConfigFromYaml(reader.raw("contacts")); });
  collect([&] { config.scene = SceneConfig::fromYaml(reader.raw("scene")); });
  collect([&] { reader.finish(); });
  if (!faults.empty()) throw ParameterError(faults);
  return config;
}

}  // namespace aras_visual_servo_sim
