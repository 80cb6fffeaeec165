#include "aras_visual_servo_sim/robot/joint_limits_reader.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

namespace {

using aras_visual_servo_common::nameIn;
using aras_visual_servo_common::shown;

/** Reads the limits of one joint; a limit counts when `has_` is true and its numbers are there. */
class LimitReader {
 public:
  LimitReader(YamlReader reader, const std::string& joint, RobotModel& model)
      : reader_(std::move(reader)), joint_(joint), model_(model) {}

  void read(JointLimits& limits, SoftLimits& soft) {
    JointLimits given = limits;
    one("has_position_limits", {{"min_position", &given.lower}, {"max_position", &given.upper}}, given.has_position);
    one("has_velocity_limits", {{"max_velocity", &given.velocity}}, given.has_velocity);
    one("has_acceleration_limits", {{"max_acceleration", &given.acceleration}}, given.has_acceleration);
    one("has_effort_limits", {{"max_effort", &given.effort}}, given.has_effort);
    bool jerk = false;
    double max_jerk = 0.0;
    one("has_jerk_limits", {{"max_jerk", &max_jerk}}, jerk);
    if (jerk) warn("has_jerk_limits is ignored, as in joint_limits_interface");
    if (given.has_position && given.lower > given.upper) {
      reader_.fault("min_position", std::to_string(given.lower), "<= max_position, " + std::to_string(given.upper));
    }
    limits = given;
    readSoft(soft);
  }

 private:
  using Numbers = std::vector<std::pair<const char*, double*>>;

  void one(const char* flag, const Numbers& numbers, bool& has) {
    const bool given = reader_.has(flag);
    const bool wanted = reader_.find<bool>(flag).value_or(false);
    bool complete = true;
    std::vector<double> values;
    for (const auto& [key, target] : numbers) {
      complete = complete && reader_.has(key);
      values.push_back(reader_.find<double>(key).value_or(*target));
    }
    if (given && !wanted) has = false;
    if (wanted && !complete) warn(std::string(flag) + " is true and its numbers are not all there: it changes nothing");
    if (!wanted || !complete) return;
    has = true;
    for (std::size_t k = 0; k < numbers.size(); ++k) *numbers[k].second = values[k];
  }

  void readSoft(SoftLimits& soft) {
    SoftLimits given = soft;
    bool has = false;
    one("has_soft_limits",
        {{"k_position", &given.k_position},
         {"k_velocity", &given.k_velocity},
         {"soft_lower_limit", &given.lower},
         {"soft_upper_limit", &given.upper}},
        has);
    if (!has) return;  // false leaves the soft limits of the URDF as they are
    if (given.lower > given.upper) {
      reader_.fault("soft_lower_limit", std::to_string(given.lower),
                    "<= soft_upper_limit, " + std::to_string(given.upper));
    }
    given.present = true;
    soft = given;
  }

  void warn(const std::string& text) { model_.warnings.push_back("joint_limits/" + joint_ + ": " + text); }

  YamlReader reader_;
  std::string joint_;
  RobotModel& model_;
};

/** gazebo_ros_control drives position and velocity joints by a PID where it finds these gains. */
void warnOfServoGains(const YAML::Node& node, RobotModel& model) {
  if (!node.IsMap() || !node["gazebo_ros_control"].IsDefined() || !node["gazebo_ros_control"].IsMap()) return;
  const YAML::Node gains = node["gazebo_ros_control"]["pid_gains"];
  if (!gains.IsDefined() || !gains.IsMap()) return;
  std::string joints;
  for (const auto& item : gains) joints += (joints.empty() ? "" : ", ") + YAML::Dump(item.first);
  model.warnings.push_back("gazebo_ros_control/pid_gains (" + joints +
                           "): ignored, position and velocity joints are servos here; an effort controller has a PID");
}

}  // namespace

void applyJointLimits(const YAML::Node& node, RobotModel& model) {
  warnOfServoGains(node, model);
  if (!node.IsMap() || !node["joint_limits"].IsDefined() || node["joint_limits"].IsNull()) return;
  const YAML::Node limits = node["joint_limits"];
  if (!limits.IsMap())
    throw ParameterError("joint_limits: found " + shown(limits) + ", allowed a map of joints by name");
  FaultList faults;
  for (const auto& item : limits) {
    const std::string name = nameIn(item.first);
    Joint* joint = nullptr;
    for (Joint& each : model.joints) {
      if (each.name == name && each.moves()) joint = &each;
    }
    if (joint) {
      YamlReader reader(item.second, sectionOf("joint_limits"), "joint_limits/" + name);
      LimitReader(reader, name, model).read(joint->enforced, joint->soft);
      faults.collect([&] { reader.finish(); });
    } else {
      model.warnings.push_back("joint_limits/" + name + ": no moving joint of that name, ignored");
    }
  }
  faults.throwIfAny();
}

}  // namespace aras_visual_servo_sim
