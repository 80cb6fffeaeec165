#include "joint_wish.hpp"

#include <algorithm>
#include <aras_visual_servo_common/errors.hpp>
#include <cmath>
#include <string>

namespace aras_visual_servo {

void requireSize(const char* name, Eigen::Index found, Eigen::Index expected) {
  if (found == expected) return;
  throw aras_visual_servo_common::ShapeError(std::string(name) + ": " + std::to_string(found) + " values, expected " +
                                             std::to_string(expected));
}

Wish::Wish(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, double posture_gain_per_s,
           double joint_limit_gain_per_s, double max_speed)
    : middle_(Eigen::VectorXd::Zero(lower.size())),
      limit_gain_(Eigen::VectorXd::Zero(lower.size())),
      posture_gain_(posture_gain_per_s),
      max_speed_(max_speed) {
  requireSize("upper", upper.size(), lower.size());
  for (Eigen::Index i = 0; i < lower.size(); ++i) {
    if (!std::isfinite(lower[i]) || !std::isfinite(upper[i])) continue;
    const double half = 0.5 * (upper[i] - lower[i]);
    middle_[i] = 0.5 * (lower[i] + upper[i]);
    limit_gain_[i] = joint_limit_gain_per_s / (half * half);
  }
}

Eigen::VectorXd Wish::operator()(const JointsRef& q, const std::optional<Eigen::VectorXd>& posture,
                                 const std::optional<Eigen::VectorXd>& more) const {
  requireSize("q", q.size(), middle_.size());
  if (posture) requireSize("posture", posture->size(), middle_.size());
  if (more) requireSize("more", more->size(), middle_.size());
  Eigen::VectorXd wish(q.size());
  double fastest = 0.0;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double off = q[i] - middle_[i];
    wish[i] = -limit_gain_[i] * (off * off * off);
    if (posture) wish[i] += posture_gain_ * ((*posture)[i] - q[i]);
    if (more) wish[i] += (*more)[i];
    fastest = std::max(fastest, std::abs(wish[i]));
  }
  if (fastest > max_speed_) wish *= max_speed_ / fastest;
  return wish;
}

double velocityFactor(const JointsRef& q_dot, const JointsRef& limit) {
  requireSize("limit", limit.size(), q_dot.size());
  double worst = 0.0;
  for (Eigen::Index i = 0; i < q_dot.size(); ++i) worst = std::max(worst, std::abs(q_dot[i]) / limit[i]);
  return worst <= 1.0 ? 1.0 : 1.0 / worst;
}

std::pair<double, std::optional<int>> positionFactor(const JointsRef& q, const JointsRef& q_dot, const JointsRef& lower,
                                                     const JointsRef& upper, double horizon_s) {
  requireSize("q_dot", q_dot.size(), q.size());
  requireSize("lower", lower.size(), q.size());
  requireSize("upper", upper.size(), q.size());
  double factor = 1.0;
  std::optional<int> joint;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double way = q_dot[i] * horizon_s;
    double room = 1.0;
    if (way > 0.0 && q[i] + way > upper[i]) {
      room = (upper[i] - q[i]) / way;
    } else if (way < 0.0 && q[i] + way < lower[i]) {
      room = (lower[i] - q[i]) / way;
    } else {
      continue;
    }
    if (room < factor) {
      factor = std::max(0.0, room);
      joint = static_cast<int>(i);
    }
  }
  return {factor, joint};
}

}  // namespace aras_visual_servo
