#include "aras_visual_servo_sim/robot/joint_limits_reader.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

namespace {

using aras_visual_servo_common::nameIn;
using aras_visual_servo_common::shown;

/** Takes over the limits of one joint; a limit counts when `has_` is true and its numbers are there. */
class LimitReader {
 public:
  LimitReader(const JointLimitsConfig& settings, const SectionCheck& section, const std::string& joint,
              RobotModel& model)
      : settings_(settings), section_(section), joint_(joint), model_(model) {}

  void read(JointLimits& limits, SoftLimits& soft) {
    const JointLimitsConfig& s = settings_;
    JointLimits given = limits;
    one("has_position_limits", s.has_position_limits, {{s.min_position, &given.lower}, {s.max_position, &given.upper}},
        given.has_position);
    one("has_velocity_limits", s.has_velocity_limits, {{s.max_velocity, &given.velocity}}, given.has_velocity);
    one("has_acceleration_limits", s.has_acceleration_limits, {{s.max_acceleration, &given.acceleration}},
        given.has_acceleration);
    one("has_effort_limits", s.has_effort_limits, {{s.max_effort, &given.effort}}, given.has_effort);
    bool jerk = false;
    double max_jerk = 0.0;
    one("has_jerk_limits", s.has_jerk_limits, {{s.max_jerk, &max_jerk}}, jerk);
    if (jerk) warn("has_jerk_limits is ignored, as in joint_limits_interface");
    if (given.has_position && given.lower > given.upper) {
      section_.fault("min_position", given.lower, "<= max_position, " + numberText(given.upper));
    }
    limits = given;
    readSoft(soft);
  }

 private:
  using Numbers = std::vector<std::pair<std::optional<double>, double*>>;

  void one(const char* flag, const std::optional<bool>& given, const Numbers& numbers, bool& has) {
    if (given && !*given) has = false;
    if (!given || !*given) return;
    for (const auto& [value, target] : numbers) {
      if (value) continue;
      return warn(std::string(flag) + " is true and its numbers are not all there: it changes nothing");
    }
    has = true;
    for (const auto& [value, target] : numbers) *target = *value;
  }

  void readSoft(SoftLimits& soft) {
    const JointLimitsConfig& s = settings_;
    SoftLimits given = soft;
    bool has = false;
    one("has_soft_limits", s.has_soft_limits,
        {{s.k_position, &given.k_position},
         {s.k_velocity, &given.k_velocity},
         {s.soft_lower_limit, &given.lower},
         {s.soft_upper_limit, &given.upper}},
        has);
    if (!has) return;  // false leaves the soft limits of the URDF as they are
    if (given.lower > given.upper) {
      section_.fault("soft_lower_limit", given.lower, "<= soft_upper_limit, " + numberText(given.upper));
    }
    given.present = true;
    soft = given;
  }

  void warn(const std::string& text) { model_.warnings.push_back("joint_limits/" + joint_ + ": " + text); }

  const JointLimitsConfig& settings_;
  const SectionCheck& section_;
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
      const auto read = [&](const JointLimitsConfig& settings, const SectionCheck& section) {
        LimitReader(settings, section, name, model).read(joint->enforced, joint->soft);
      };
      faults.collect([&] { readSection<JointLimitsConfig>(item.second, "joint_limits." + name, read); });
    } else {
      model.warnings.push_back("joint_limits/" + name + ": no moving joint of that name, ignored");
    }
  }
  faults.throwIfAny();
}

}  // namespace aras_visual_servo_sim
