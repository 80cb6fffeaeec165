#include "driven_base.hpp"

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

/** Below this angle the series of (angle - sin(angle)) / angle^3 is exact to rounding with three terms [rad]. */
constexpr double kSmallRad = 1e-2;
/** A quaternion whose squared length is that near to 1 is left as it is, so that a pose taken back keeps its bits. */
constexpr double kUnit = 1e-14;

Quaterniond unit(const Quaterniond& q) { return std::abs(q.squaredNorm() - 1.0) <= kUnit ? q : q.normalized(); }

}  // namespace

Quaterniond quaternionFromVector(const Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle == 0.0) return Quaterniond::Identity();
  return Quaterniond(Eigen::AngleAxisd(angle, rotation_vector / angle));
}

Vector3d rotationVector(const Quaterniond& q) {
  const double sine = q.vec().norm();
  if (sine == 0.0) return Vector3d::Zero();
  const double angle = 2.0 * std::atan2(sine, std::abs(q.w()));
  return (std::signbit(q.w()) ? -angle : angle) / sine * q.vec();
}

Pose exponential(const Twist& V) {
  const Vector3d v = V.head<3>();
  const Vector3d w = V.tail<3>();
  const double angle = w.norm();
  const double square = angle * angle;
  const double half = angle > 0.0 ? std::sin(0.5 * angle) / (0.5 * angle) : 1.0;
  const double b = 0.5 * half * half;  // (1 - cos) / angle^2 without cancellation
  const double c = angle > kSmallRad ? (angle - std::sin(angle)) / (square * angle)
                                     : (1.0 - square / 20.0 * (1.0 - square / 42.0)) / 6.0;
  const Vector3d wv = w.cross(v);
  return {v + b * wv + c * w.cross(wv), quaternionFromVector(w)};
}

const std::vector<std::string>& DrivenBase::coordinates() {
  static const std::vector<std::string> kNames = {"px", "py", "pz", "rx", "ry", "rz"};
  return kNames;
}

int DrivenBase::index(const std::string& coordinate) {
  const auto& names = coordinates();
  const auto found = std::find(names.begin(), names.end(), coordinate);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  throw UnknownNameError("joint '" + coordinate + "' does not exist, a driven base has: px, py, pz, rx, ry, rz");
}

void DrivenBase::place(const Pose& X_WB) {
  X_WB_ = {X_WB.p, unit(X_WB.q)};
  told_ = moved_ = Twist::Zero();
  expiry_tick_ = 0;
}

void DrivenBase::place(const std::map<int, double>& positions) {
  Coordinates wanted = this->positions();
  bool turned = false;
  for (const auto& [k, position] : positions) {
    wanted[k] = position;
    turned = turned || k >= 3;
  }
  place(Pose{wanted.head<3>(), turned ? quaternionFromVector(wanted.tail<3>()) : X_WB_.q});
}

void DrivenBase::command(const std::map<int, double>& velocities, std::int64_t now_tick, std::int64_t expiry_tick) {
  if (now_tick >= expiry_tick_) told_.setZero();
  for (const auto& [k, velocity] : velocities) told_[k] = velocity;
  expiry_tick_ = expiry_tick;
}

void DrivenBase::step(std::int64_t tick, double dt_s) {
  moved_ = tick < expiry_tick_ ? told_ : Twist(Twist::Zero());
  if (moved_.isZero(0.0)) return;
  X_WB_ = X_WB_ * exponential(dt_s * moved_);
  X_WB_.q = unit(X_WB_.q);
}

DrivenBase::Coordinates DrivenBase::positions() const {
  Coordinates positions;
  positions << X_WB_.p, rotationVector(X_WB_.q);
  return positions;
}

}  // namespace aras_visual_servo_sim
