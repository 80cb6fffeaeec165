// Reading of `motion:`.
#include "aras_visual_servo_sim/scene/model_motion.hpp"

namespace aras_visual_servo_sim {
namespace {

using Eigen::Vector3d;

ConstantVelocity readConstantVelocity(YamlReader& reader) {
  return {reader.get<Vector3d>("linear_m_per_s"), reader.get<Vector3d>("angular_rad_per_s")};
}

CircleMotion readCircle(YamlReader& reader) {
  CircleMotion circle;
  circle.radius_m = reader.get<double>("radius_m");
  circle.angular_speed_rad_per_s = reader.get<double>("angular_speed_rad_per_s");
  circle.axis = reader.get<Vector3d>("axis");
  circle.phase_rad = reader.get<double>("phase_rad");
  if (circle.axis.norm() == 0.0) reader.fault("axis", "zero", "any other direction");
  circle.axis.normalize();
  return circle;
}

RandomWalk readRandomWalk(YamlReader& reader) {
  RandomWalk walk;
  walk.interval_s = reader.get<double>("interval_s");
  walk.speed_stddev_m_per_s = reader.get<Vector3d>("speed_stddev_m_per_s");
  walk.angular_speed_stddev_rad_per_s = reader.get<Vector3d>("angular_speed_stddev_rad_per_s");
  walk.radius_m = reader.get<double>("radius_m");
  walk.seed = static_cast<std::uint64_t>(reader.get<std::int64_t>("seed"));
  return walk;
}

WaypointMotion readWaypoints(YamlReader& reader) {
  WaypointMotion motion;
  motion.repeat = reader.get<bool>("repeat");
  for (YamlReader& entry : reader.list("waypoints")) {
    WaypointMotion::Waypoint waypoint;
    waypoint.time_s = entry.get<double>("time_s");
    waypoint.p = entry.get<Vector3d>("position_m");
    if (const auto rpy = entry.find<Vector3d>("rpy_rad")) waypoint.q = quaternionFromRpy(*rpy);
    if (!motion.waypoints.empty() && waypoint.time_s <= motion.waypoints.back().time_s) {
      entry.fault("time_s", std::to_string(waypoint.time_s),
                  "> " + std::to_string(motion.waypoints.back().time_s) + ", that of the waypoint before");
    }
    motion.waypoints.push_back(waypoint);
  }
  return motion;
}

}  // namespace

ModelMotion ModelMotion::read(YamlReader reader, const YAML::Node& node) {
  ModelMotion motion;
  const std::string type = reader.find<std::string>("type").value_or("");
  if (type == "constant_velocity") motion.path_ = readConstantVelocity(reader);
  if (type == "circle") motion.path_ = readCircle(reader);
  if (type == "random_walk") motion.path_ = readRandomWalk(reader);
  if (type == "waypoints") motion.path_ = readWaypoints(reader);
  motion.delay_s_ = reader.get<double>("delay_s");
  YAML::Emitter text;
  text << YAML::Flow << node;
  motion.yaml_ = text.c_str();
  return motion;
}

ModelMotion ModelMotion::fromYaml(const YAML::Node& node, const std::string& where) {
  YamlReader reader(node, sectionOf("motion"), where);
  ModelMotion motion = read(reader, node);
  reader.finish();
  return motion;
}

}  // namespace aras_visual_servo_sim
