#include "aras_visual_servo_sim/physics/managed/joint_state_controller.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {
namespace {

std::unique_ptr<Controller> make(const std::string& name, const std::string& type, const YAML::Node& parameters,
                                 const RobotModel& model, std::vector<std::string>& warnings) {
  JointStateConfig config =
      jointStatesOf(readController<ControllerKeys>(parameters, name, warnings, [](auto&&...) {}), model);
  if (!config.publish_rate_hz) {
    throw ParameterError(name + "/publish_rate: Parameter 'publish_rate' not set, allowed is a rate above 0 Hz");
  }
  return std::make_unique<JointStateController>(name, type, std::move(config));
}

const RegisterController kType("joint_state_controller/JointStateController", make);

}  // namespace
}  // namespace aras_visual_servo_sim
