#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/physics/managed/controller.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** Its type among ros_control's controllers. */
inline const char kJointStateType[] = "joint_state_controller/JointStateController";

/** Settings of ros_control's joint_state_controller/JointStateController. */
struct JointStateConfig {
  std::optional<double> publish_rate_hz;  ///< > 0
  std::vector<ExtraJoint> extra_joints;   ///< in the order of the file; those that the robot has are ignored
};

/** What publishes joint_states while it runs; it drives nothing. */
class JointStateController : public Controller {
 public:
  JointStateController(std::string name, std::string type, JointStateConfig config)
      : Controller(std::move(name), std::move(type), {}), config_(std::move(config)) {}
  const JointStateConfig& config() const { return config_; }

 private:
  JointStateConfig config_;
};

/** The settings that the keys of a controller of that type give. */
JointStateConfig jointStatesOf(const ControllerKeys& keys, const RobotModel& model);

/** The joint state controller among ros_control's controllers (parseControllers), the first if there are several.
 *  @throws ParameterError listing every fault of it */
JointStateConfig parseJointStates(const YAML::Node& controllers, const RobotModel& model);

}  // namespace aras_visual_servo_sim
