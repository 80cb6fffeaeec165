#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/physics/pid.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** Which quantity a joint controller is commanded in, and which one it sets. */
enum class ControllerType {
  kEffortPosition,  ///< effort_controllers/JointPositionController: PID on position
  kEffortVelocity,  ///< effort_controllers/JointVelocityController: PID on velocity
  kEffort,          ///< effort_controllers/JointEffortController: the command itself
  kPosition,        ///< position_controllers/JointPositionController: the joint reaches the command at the next step
  kVelocity         ///< velocity_controllers/JointVelocityController: the same for velocity
};

struct ControllerConfig {
  std::string name;
  ControllerType type = ControllerType::kEffortPosition;
  std::string joint;
  PidGains gains;  ///< used by the two kinds with a PID
  bool publish_state = false;
  /** Simulated time after which a velocity or effort command on its own topic, or an effort in a joint command, counts
   *  as 0; 0: held for ever, as ros_control does [s]. */
  double command_timeout_s = 0.0;
};

/** What ros_control publishes as JointControllerState. */
struct ControllerState {
  double set_point = 0.0, process_value = 0.0, process_value_dot = 0.0, error = 0.0, time_step_s = 0.0, command = 0.0;
  PidGains gains;
};

/** Reads ros_control's YAML layout: a map of controllers by name, each as section `controller` describes it. Entries
 *  without `type` are not controllers and are passed over. A JointStateController yields nothing here
 *  (parseJointStates).
 *  @return controllers in the order of the map
 *  @throws ParameterError with all faults: unknown type, unknown joint, joint with two controllers, a type that the
 *          hardware interfaces of the joint's <transmission> do not have, missing `p`, ... */
std::vector<ControllerConfig> parseControllers(const YAML::Node& node, const RobotModel& model);

/** The gains that a section `pid` gives. */
PidGains gainsOf(const PidKeys& pid);

/** @throws ParameterError unless the gains are finite, not negative, i_min <= 0 <= i_max. */
void checkGains(const PidGains& gains, const std::string& controller_name);

/** Whether a controller of this type has a PID. */
inline bool hasPid(ControllerType type) {
  return type == ControllerType::kEffortPosition || type == ControllerType::kEffortVelocity;
}

/** The interface of ros_control that a type drives its joint through, as "EffortJointInterface". */
const char* interfaceOf(ControllerType type);

/** ros_control's name of a type, e.g. "effort_controllers/JointPositionController". */
std::string controllerTypeName(ControllerType type);

}  // namespace aras_visual_servo_sim
