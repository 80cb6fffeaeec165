#include "aras_visual_servo_sim/robot/joint_limits_reader.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/yaml_reader.hpp"

namespace aras_visual_servo_sim {

namespace {

/** Reads the limits of one joint; a limit counts when `has_` is true and its numbers are there. */
class LimitReader {
 public:
  LimitReader(YamlReader reader, const std::string& joint, RobotModel& model)
      : reader_(std::move(reader)), joint_(joint), model_(model) {}

  void read(JointLimits& limits, SoftLimits& soft) {
    JointLimits given = limits;
    one("has_position_limits", {{"min_position", &given.lower}, {"max_position", &given.upper}}, Range::any(),
        given.has_position);
    reader_.optional<bool>("angle_wraparound", false);
    one("has_velocity_limits", {{"max_velocity", &given.velocity}}, Range::positive(), given.has_velocity);
    one("has_acceleration_limits", {{"max_acceleration", &given.acceleration}}, Range::positive(),
        given.has_acceleration);
    one("has_effort_limits", {{"max_effort", &given.effort}}, Range::nonNegative(), given.has_effort);
    bool jerk = false;
    double max_jerk = 0.0;
    one("has_jerk_limits", {{"max_jerk", &max_jerk}}, Range::positive(), jerk);
    if (jerk) warn("has_jerk_limits is ignored, as in joint_limits_interface");
    if (given.has_position && given.lower > given.upper) {
      reader_.fault("min_position", std::to_string(given.lower), "<= max_position, " + std::to_string(given.upper));
    }
    limits = given;
    readSoft(soft);
  }

 private:
  using Numbers = std::vector<std::pair<const char*, double*>>;

  void one(const char* flag, const Numbers& numbers, const Range& range, bool& has) {
    const bool given = reader_.has(flag);
    const bool wanted = reader_.optional<bool>(flag, false);
    bool complete = true;
    std::vector<double> values;
    for (const auto& [key, target] : numbers) {
      complete = complete && reader_.has(key);
      values.push_back(reader_.optional<double>(key, *target, range));
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
        Range::any(), has);
    if (!has) return;  // false does not take those of the URDF away
    if (given.k_position < 0.0) reader_.fault("k_position", std::to_string(given.k_position), ">= 0");
    if (given.k_velocity < 0.0) reader_.fault("k_velocity", std::to_string(given.k_velocity), ">= 0");
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
  YamlReader all(node["joint_limits"], "joint_limits");
  for (const std::string& name : all.keys()) {
    Joint* joint = nullptr;
    for (Joint& each : model.joints) {
      if (each.name == name && each.moves()) joint = &each;
    }
    if (joint) {
      LimitReader(all.section(name), name, model).read(joint->enforced, joint->soft);
    } else {
      all.raw(name);
      model.warnings.push_back("joint_limits/" + name + ": no moving joint of that name, ignored");
    }
  }
  all.finish();
}

}  // namespace aras_visual_servo_sim
