#include "aras_visual_servo_sim/physics/managed/gripper_controller.hpp"

#include <cmath>
#include <utility>

#include "aras_visual_servo_sim/config/archive.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {
namespace {

std::unique_ptr<Controller> make(const std::string& name, const std::string& type, const YAML::Node& parameters,
                                 const RobotModel& model, std::vector<std::string>& warnings) {
  ControllerConfig drive;
  const auto settings = readController<GripperControllerConfig>(
      parameters, name, warnings, [&](const GripperControllerConfig& given, const SectionCheck& section) {
        drive.joint = given.joint;
        drive.name = name + "/gains/" + drive.joint;
        drive.type = interfaceOfType(type) == "Position" ? ControllerType::kPosition : ControllerType::kEffortPosition;
        checkJoint(model, drive.joint, drive.type, name, section.faults());
      });
  if (drive.type == ControllerType::kEffortPosition) {
    const auto gains = settings.gains.find(drive.joint);
    if (gains != settings.gains.end()) {
      drive.gains = gainsOf(gains->second);
    } else {
      warnings.push_back(drive.name + ": is missing, so this gripper does not move");
    }
  }
  return std::make_unique<GripperController>(
      name, type, std::move(drive),
      GripperController::Settings{std::abs(settings.goal_tolerance), std::abs(settings.max_effort),
                                  settings.stall_velocity_threshold, settings.stall_timeout,
                                  settings.action_monitor_rate});
}

const RegisterController kTypes[] = {{"effort_controllers/GripperActionController", make},
                                     {"position_controllers/GripperActionController", make}};

}  // namespace

GripperController::GripperController(std::string name, std::string type, ControllerConfig drive, Settings settings)
    : Controller(std::move(name), std::move(type), {std::move(drive)}), settings_(settings) {}

void GripperController::hold(const JointNow& joint) {
  if (state_ == State::kActive) state_ = State::kPreempted;
  position_ = joint.position;
  effort_ = settings_.max_effort;
}

void GripperController::start(double time_s, const std::vector<JointNow>& joints) {
  hold(joints.front());
  moved_s_ = time_s;
  last_ = joints.front();
}

void GripperController::stop() {
  if (state_ == State::kActive) state_ = State::kPreempted;
}

void GripperController::pursue(double position, double max_effort, double now_s) {
  if (!std::isfinite(position) || !std::isfinite(max_effort)) {
    throw NotFiniteError("controller '" + name() + "': position or max_effort is not finite, must be finite");
  }
  position_ = position;
  effort_ = std::abs(max_effort);
  moved_s_ = now_s;
  ++goals_;
  state_ = State::kActive;
}

void GripperController::cancel(const JointNow& joint) {
  if (state_ == State::kActive) hold(joint);
}

void GripperController::update(double time_s, double, const std::vector<JointNow>& joints,
                               std::vector<JointTarget>& targets) {
  last_ = joints.front();
  if (state_ == State::kActive) {
    if (std::abs(position_ - last_.position) < settings_.goal_tolerance) {
      state_ = State::kReached;
    } else if (std::abs(last_.velocity) > settings_.stall_speed) {
      moved_s_ = time_s;
    } else if (time_s - moved_s_ > settings_.stall_timeout_s) {
      state_ = State::kStalled;
    }
  }
  targets.front().set_point = position_;
  if (drives().front().type != ControllerType::kPosition) targets.front().effort_limit = effort_;
}

void GripperController::visit(Archive& archive) {
  archive(state_, goals_, position_, effort_, moved_s_, last_.position, last_.velocity, last_.effort);
}

}  // namespace aras_visual_servo_sim
