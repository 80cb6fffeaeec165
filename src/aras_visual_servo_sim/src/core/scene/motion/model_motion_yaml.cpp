// Reading of `motion:`.
#include "aras_visual_servo_sim/scene/model_motion.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kShortestIntervalS = 1e-3;  // shorter ones would take longer to walk again than to simulate

ConstantVelocity readConstantVelocity(YamlReader& reader) {
  return {reader.optional<Eigen::Vector3d>("linear_m_per_s", Eigen::Vector3d::Zero()),
          reader.optional<Eigen::Vector3d>("angular_rad_per_s", Eigen::Vector3d::Zero())};
}

CircleMotion readCircle(YamlReader& reader) {
  CircleMotion circle;
  circle.radius_m = reader.required<double>("radius_m", Range::positive());
  circle.angular_speed_rad_per_s = reader.required<double>("angular_speed_rad_per_s");
  circle.axis = reader.optional<Eigen::Vector3d>("axis", Eigen::Vector3d::UnitZ());
  circle.phase_rad = reader.optional<double>("phase_rad", 0.0);
  if (circle.axis.norm() == 0.0) reader.fault("axis", "zero", "any other direction");
  circle.axis.normalize();
  return circle;
}

RandomWalk readRandomWalk(YamlReader& reader) {
  RandomWalk walk;
  walk.interval_s = reader.required<double>("interval_s", Range::between(kShortestIntervalS, Range::any().max));
  walk.speed_stddev_m_per_s =
      reader.optional<Eigen::Vector3d>("speed_stddev_m_per_s", Eigen::Vector3d::Zero(), Range::nonNegative());
  walk.angular_speed_stddev_rad_per_s =
      reader.optional<Eigen::Vector3d>("angular_speed_stddev_rad_per_s", Eigen::Vector3d::Zero(), Range::nonNegative());
  walk.radius_m = reader.optional<double>("radius_m", 0.0, Range::nonNegative());
  walk.seed = static_cast<std::uint64_t>(reader.optional<std::int64_t>("seed", 0, Range::nonNegative()));
  return walk;
}

WaypointMotion readWaypoints(YamlReader& reader) {
  WaypointMotion motion;
  motion.repeat = reader.optional<bool>("repeat", false);
  for (YamlReader& entry : reader.list("waypoints")) {
    WaypointMotion::Waypoint waypoint;
    waypoint.time_s = entry.required<double>("time_s", Range::nonNegative());
    waypoint.p = entry.required<Eigen::Vector3d>("position_m");
    if (entry.has("rpy_rad")) waypoint.q = quaternionFromRpy(entry.required<Eigen::Vector3d>("rpy_rad"));
    if (!motion.waypoints.empty() && waypoint.time_s <= motion.waypoints.back().time_s) {
      entry.fault("time_s", std::to_string(waypoint.time_s),
                  "> " + std::to_string(motion.waypoints.back().time_s) + ", that of the waypoint before");
    }
    motion.waypoints.push_back(waypoint);
  }
  if (motion.waypoints.empty()) reader.fault("waypoints", "none", "a list of {time_s, position_m, rpy_rad}");
  return motion;
}

}  // namespace

ModelMotion ModelMotion::read(YamlReader& reader, const YAML::Node& node) {
  ModelMotion motion;
  motion.delay_s_ = reader.optional<double>("delay_s", 0.0, Range::nonNegative());
  const std::string type = reader.requiredChoice("type", {"constant_velocity", "circle", "random_walk", "waypoints"});
  if (type == "constant_velocity") motion.path_ = readConstantVelocity(reader);
  if (type == "circle") motion.path_ = readCircle(reader);
  if (type == "random_walk") motion.path_ = readRandomWalk(reader);
  if (type == "waypoints") motion.path_ = readWaypoints(reader);
  YAML::Emitter text;
  text << YAML::Flow << node;
  motion.yaml_ = text.c_str();
  return motion;
}

ModelMotion ModelMotion::fromYaml(const YAML::Node& node, const std::string& where) {
  YamlReader reader(node, where);
  ModelMotion motion = read(reader, node);
  reader.finish();
  return motion;
}

}  // namespace aras_visual_servo_sim
