#include "aras_visual_servo_sim/scene/model_motion.hpp"

#include <cmath>

#include "aras_visual_servo_sim/config/splitmix.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kDrawsPerInterval = 6;

Eigen::Quaterniond rotationBy(const Eigen::Vector3d& angle_axis_rad) {
  const double angle = angle_axis_rad.norm();
  if (angle == 0.0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, angle_axis_rad / angle));
}

/** The shorter rotation from a to b, in W [rad]. */
Eigen::Vector3d rotationFrom(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  Eigen::Quaterniond q = b * a.conjugate();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const Eigen::AngleAxisd turn(q);
  return turn.angle() * turn.axis();
}

Twist stacked(const Eigen::Vector3d& v, const Eigen::Vector3d& w) {
  Twist V;
  V << v, w;
  return V;
}

Pose moved(const Pose& start, const Eigen::Vector3d& step, const Eigen::Vector3d& turn_rad) {
  return {start.p + step, (rotationBy(turn_rad) * start.q).normalized()};
}

}  // namespace

ModelPlacement ConstantVelocity::at(const Pose& X_WM0, double t_s) const {
  return {moved(X_WM0, t_s * linear_m_per_s, t_s * angular_rad_per_s), stacked(linear_m_per_s, angular_rad_per_s)};
}

ModelPlacement CircleMotion::at(const Pose& X_WM0, double t_s) const {
  const bool along_x = axis.cross(Eigen::Vector3d::UnitX()).norm() < 1e-9;  // rounding of a unit vector
  const Eigen::Vector3d zero = along_x ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d e1 = (zero - axis * axis.dot(zero)).normalized();
  const Eigen::Vector3d e2 = axis.cross(e1);
  const auto radius = [&](double angle) -> Eigen::Vector3d { return std::cos(angle) * e1 + std::sin(angle) * e2; };
  const double angle = phase_rad + angular_speed_rad_per_s * t_s;
  const Eigen::Vector3d v = radius_m * angular_speed_rad_per_s * (std::cos(angle) * e2 - std::sin(angle) * e1);
  return {{X_WM0.p + radius_m * (radius(angle) - radius(phase_rad)), X_WM0.q}, stacked(v, Eigen::Vector3d::Zero())};
}

RandomWalk::RandomWalk(const MotionConfig& settings)
    : interval_s(settings.interval_s),
      speed_stddev_m_per_s(settings.speed_stddev_m_per_s),
      angular_speed_stddev_rad_per_s(settings.angular_speed_stddev_rad_per_s),
      radius_m(settings.radius_m),
      seed(static_cast<std::uint64_t>(settings.seed)) {}

Twist RandomWalk::velocityOf(const Knot& knot) const {
  Twist V;
  for (int k = 0; k < kDrawsPerInterval; k += 2) {
    const auto pair = splitmix::normalPair(seed, static_cast<std::uint64_t>(kDrawsPerInterval * knot.index + k));
    V[k] = pair.first;
    V[k + 1] = pair.second;
  }
  V.head<3>() = V.head<3>().cwiseProduct(speed_stddev_m_per_s);
  V.tail<3>() = V.tail<3>().cwiseProduct(angular_speed_stddev_rad_per_s);
  if (radius_m > 0.0 && knot.p.norm() > radius_m) {
    const Eigen::Vector3d outward = knot.p.normalized();
    const double speed = V.head<3>().dot(outward);
    if (speed > 0.0) V.head<3>() -= 2.0 * speed * outward;
  }
  return V;
}

ModelPlacement RandomWalk::at(const Pose& X_WM0, double t_s) const {
  const auto index = static_cast<std::int64_t>(std::floor(t_s / interval_s));
  if (index < knot_.index) knot_ = Knot();
  Twist V = velocityOf(knot_);
  while (knot_.index < index) {
    knot_.p += interval_s * V.head<3>();
    knot_.q = (rotationBy(interval_s * V.tail<3>()) * knot_.q).normalized();
    ++knot_.index;
    V = velocityOf(knot_);
  }
  const double rest_s = t_s - interval_s * static_cast<double>(index);
  const Pose start{X_WM0.p + knot_.p, knot_.q * X_WM0.q};
  return {moved(start, rest_s * V.head<3>(), rest_s * V.tail<3>()), V};
}

WaypointMotion::WaypointMotion(const MotionConfig& settings) : repeat(settings.repeat) {
  for (const WaypointConfig& each : settings.waypoints) {
    waypoints.push_back({each.time_s, each.position_m, {}});
    if (each.rpy_rad) waypoints.back().q = quaternionFromRpy(*each.rpy_rad);
  }
}

ModelPlacement WaypointMotion::at(const Pose& X_WM0, double t_s) const {
  const double end_s = waypoints.back().time_s;
  if (repeat && end_s > 0.0) t_s = std::fmod(t_s, end_s);
  Pose from = X_WM0;
  double from_s = 0.0;
  for (const Waypoint& waypoint : waypoints) {
    const Pose to{waypoint.p, waypoint.q.value_or(from.q)};
    if (t_s < waypoint.time_s) {
      const double duration_s = waypoint.time_s - from_s;
      const Eigen::Vector3d v = (to.p - from.p) / duration_s;
      const Eigen::Vector3d w = rotationFrom(from.q, to.q) / duration_s;
      return {moved(from, (t_s - from_s) * v, (t_s - from_s) * w), stacked(v, w)};
    }
    from = to;
    from_s = waypoint.time_s;
  }
  return {from, Twist::Zero()};
}

ModelMotion::ModelMotion(const MotionConfig& settings, const YAML::Node& node) : delay_s_(settings.delay_s) {
  const MotionConfig& s = settings;
  if (s.type == "constant_velocity") path_ = ConstantVelocity{s.linear_m_per_s, s.angular_rad_per_s};
  if (s.type == "circle") path_ = CircleMotion{s.radius_m, s.angular_speed_rad_per_s, s.axis.normalized(), s.phase_rad};
  if (s.type == "random_walk") path_ = RandomWalk(s);
  if (s.type == "waypoints") path_ = WaypointMotion(s);
  YAML::Emitter text;
  text << YAML::Flow << node;
  yaml_ = text.c_str();
}

ModelMotion ModelMotion::fromYaml(const YAML::Node& node, const std::string& where) {
  return {readSection<MotionConfig>(node, where, checkMotion), node};
}

void checkMotion(const MotionConfig& settings, const SectionCheck& section) {
  if (settings.axis.norm() == 0.0) section.fault("axis", "zero", "any other direction");
  for (std::size_t k = 1; k < settings.waypoints.size(); ++k) {
    const double time_s = settings.waypoints[k].time_s, before_s = settings.waypoints[k - 1].time_s;
    if (time_s > before_s) continue;
    section.part("waypoints", k).fault("time_s", time_s, "> " + numberText(before_s) + ", that of the waypoint before");
  }
}

ModelPlacement ModelMotion::at(const Pose& X_WM0, double t_s) const {
  if (t_s < delay_s_) return {X_WM0, Twist::Zero()};
  return std::visit([&](const auto& path) { return path.at(X_WM0, t_s - delay_s_); }, path_);
}

}  // namespace aras_visual_servo_sim
