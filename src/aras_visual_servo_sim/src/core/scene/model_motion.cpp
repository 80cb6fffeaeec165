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

/** Along a circle on which the model starts; its attitude does not change. The phase zero is W's x axis, or y for a
 *  circle about x, in the circle's plane. */
ModelPlacement ModelMotion::onCircle(const Pose& X_WM0, double t_s) const {
  const Eigen::Vector3d& axis = settings_.axis;
  const bool along_x = axis.cross(Eigen::Vector3d::UnitX()).norm() < 1e-9;  // rounding of a unit vector
  const Eigen::Vector3d zero = along_x ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d e1 = (zero - axis * axis.dot(zero)).normalized();
  const Eigen::Vector3d e2 = axis.cross(e1);
  const auto radius = [&](double angle) -> Eigen::Vector3d { return std::cos(angle) * e1 + std::sin(angle) * e2; };
  const double radius_m = settings_.radius_m, speed = settings_.angular_speed_rad_per_s, phase = settings_.phase_rad;
  const double angle = phase + speed * t_s;
  const Eigen::Vector3d v = radius_m * speed * (std::cos(angle) * e2 - std::sin(angle) * e1);
  return {{X_WM0.p + radius_m * (radius(angle) - radius(phase)), X_WM0.q}, stacked(v, Eigen::Vector3d::Zero())};
}

/** Drawn for an interval, each component normal with mean zero. Farther than radius_m from its start the model is
 * turned back: the outward part changes its sign. */
Twist ModelMotion::velocityOf(const Knot& knot) const {
  const auto seed = static_cast<std::uint64_t>(settings_.seed);
  Twist V;
  for (int k = 0; k < kDrawsPerInterval; k += 2) {
    const auto pair = splitmix::normalPair(seed, static_cast<std::uint64_t>(kDrawsPerInterval * knot.index + k));
    V[k] = pair.first;
    V[k + 1] = pair.second;
  }
  V.head<3>() = V.head<3>().cwiseProduct(settings_.speed_stddev_m_per_s);
  V.tail<3>() = V.tail<3>().cwiseProduct(settings_.angular_speed_stddev_rad_per_s);
  if (settings_.radius_m > 0.0 && knot.p.norm() > settings_.radius_m) {
    const Eigen::Vector3d outward = knot.p.normalized();
    const double speed = V.head<3>().dot(outward);
    if (speed > 0.0) V.head<3>() -= 2.0 * speed * outward;
  }
  return V;
}

ModelPlacement ModelMotion::onRandomWalk(const Pose& X_WM0, double t_s) const {
  const double interval_s = settings_.interval_s;
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

/** Of the last waypoint up to this one that states an attitude. */
Eigen::Quaterniond ModelMotion::attitudeAt(std::size_t waypoint, const Eigen::Quaterniond& start) const {
  for (std::size_t k = waypoint + 1; k-- > 0;) {
    if (settings_.waypoints[k].rpy_rad) return quaternionFromRpy(*settings_.waypoints[k].rpy_rad);
  }
  return start;
}

/** Straight and at constant speed from each waypoint to the next. */
ModelPlacement ModelMotion::onWaypoints(const Pose& X_WM0, double t_s) const {
  const std::vector<WaypointConfig>& waypoints = settings_.waypoints;
  const double end_s = waypoints.back().time_s;
  if (settings_.repeat && end_s > 0.0) t_s = std::fmod(t_s, end_s);
  std::size_t k = 0;
  while (k < waypoints.size() && t_s >= waypoints[k].time_s) ++k;
  Pose from = X_WM0;
  if (k > 0) from = {waypoints[k - 1].position_m, attitudeAt(k - 1, X_WM0.q)};
  if (k == waypoints.size()) return {from, Twist::Zero()};
  const double from_s = k > 0 ? waypoints[k - 1].time_s : 0.0, duration_s = waypoints[k].time_s - from_s;
  const Eigen::Vector3d v = (waypoints[k].position_m - from.p) / duration_s;
  const Eigen::Vector3d w = rotationFrom(from.q, attitudeAt(k, X_WM0.q)) / duration_s;
  return {moved(from, (t_s - from_s) * v, (t_s - from_s) * w), stacked(v, w)};
}

ModelMotion::ModelMotion(const MotionConfig& settings, const YAML::Node& node) : settings_(settings) {
  settings_.axis.normalize();
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
  const MotionConfig& s = settings_;
  t_s -= s.delay_s;
  if (t_s < 0.0) return {X_WM0, Twist::Zero()};
  if (s.type == "circle") return onCircle(X_WM0, t_s);
  if (s.type == "random_walk") return onRandomWalk(X_WM0, t_s);
  if (s.type == "waypoints") return onWaypoints(X_WM0, t_s);
  return {moved(X_WM0, t_s * s.linear_m_per_s, t_s * s.angular_rad_per_s),
          stacked(s.linear_m_per_s, s.angular_rad_per_s)};
}

}  // namespace aras_visual_servo_sim
