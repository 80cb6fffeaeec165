#include "joint_graph.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

void JointGraph::build(const ActuatorLaw& law, double damping, double friction, double v_low, double v_high) {
  law_ = law;
  law_.servo_velocity = std::clamp(law.servo_velocity, v_low, v_high);
  damping_ = damping;
  friction_ = friction;
  v_low_ = v_low;
  v_high_ = v_high;
  count_ = 0;
  if (v_low_ > -kInfinity) points_[count_++] = v_low_;
  if (v_low_ < v_high_) {
    addLawPoints();
    if (friction_ > 0.0) add(0.0);
    if (v_high_ < kInfinity) points_[count_++] = v_high_;
  }
}

void JointGraph::addLawPoints() {
  if (law_.servo) return add(law_.servo_velocity);
  if (law_.b1 > 0.0) {
    add((law_.b0 - law_.b_max) / law_.b1);
    add((law_.b0 - law_.b_min) / law_.b1);
  }
  if (law_.a1 + law_.b1 > 0.0) {
    add(rawRoot(law_.u_max));
    add(rawRoot(law_.u_min));
  }
  if (law_.soft) {
    addSoftPoints(law_.v_soft_low);
    return addSoftPoints(law_.v_soft_high);
  }
  if (law_.v_max == kInfinity) return;
  add(-law_.v_max);
  add(law_.v_max);
  if (law_.a1 + law_.b1 > 0.0) {
    const double zero = rawRoot(0.0);
    if (std::abs(zero) > law_.v_max) add(zero);
  }
}

/** Where the line -g (v - v_soft) leaves the effort limits, and where the PID may cross it. */
void JointGraph::addSoftPoints(double v_soft) {
  const double g = law_.soft_gain;
  if (g > 0.0) {
    add(v_soft - law_.u_max / g);
    add(v_soft - law_.u_min / g);
  }
  for (const Line& raw : {Line{law_.a0 + law_.b_max, law_.a1}, Line{law_.a0 + law_.b_min, law_.a1},
                          Line{law_.a0 + law_.b0, law_.a1 + law_.b1}}) {
    if (raw.g != g) add((raw.c - g * v_soft) / (raw.g - g));
  }
}

/** -g (v - v_soft) within the effort limits, on the piece that v is inside of. */
JointGraph::Line JointGraph::softLine(double v_soft, double v) const {
  const double effort = -law_.soft_gain * (v - v_soft);
  if (effort >= law_.u_max) return {law_.u_max, 0.0};
  if (effort <= law_.u_min) return {law_.u_min, 0.0};
  return {law_.soft_gain * v_soft, law_.soft_gain};
}

JointGraph::Line JointGraph::softened(Line raw, double v) const {
  const auto at = [v](const Line& line) { return line.c - line.g * v; };
  const Line low = softLine(law_.v_soft_low, v);
  const Line high = softLine(law_.v_soft_high, v);
  if (at(raw) < at(low)) raw = low;
  return at(raw) > at(high) ? high : raw;
}

/** Keeps the points sorted and apart, strictly inside the stops. */
void JointGraph::add(double v) {
  if (!(v > v_low_ && v < v_high_)) return;
  int k = count_;
  while (k > 0 && points_[k - 1] > v) --k;
  if (k > 0 && points_[k - 1] == v) return;
  for (int i = count_; i > k; --i) points_[i] = points_[i - 1];
  points_[k] = v;
  ++count_;
}

double JointGraph::rawEffort(double v) const {
  return law_.a0 - law_.a1 * v + std::clamp(law_.b0 - law_.b1 * v, law_.b_min, law_.b_max);
}

/** Velocity at which the effort before its clamp has a value; not finite where there is none. */
double JointGraph::rawRoot(double effort) const {
  if (std::isinf(effort)) return effort > 0.0 ? -kInfinity : kInfinity;
  const double v = (law_.a0 + law_.b0 - effort) / (law_.a1 + law_.b1);
  const double integral = law_.b0 - law_.b1 * v;
  if (integral > law_.b_max) return (law_.a0 + law_.b_max - effort) / law_.a1;
  if (integral < law_.b_min) return (law_.a0 + law_.b_min - effort) / law_.a1;
  return v;
}

/** The actuator's line through the piece that v is inside of. */
JointGraph::Line JointGraph::actuatorLine(double v) const {
  if (law_.servo) return {v < law_.servo_velocity ? law_.u_max : law_.u_min, 0.0};
  const double raw = rawEffort(v);
  if (v > law_.v_max && raw > 0.0) return {std::min(0.0, law_.u_max), 0.0};
  if (v < -law_.v_max && raw < 0.0) return {std::max(0.0, law_.u_min), 0.0};
  if (law_.soft) return softened(rawLine(v), v);
  if (raw >= law_.u_max) return {law_.u_max, 0.0};
  if (raw <= law_.u_min) return {law_.u_min, 0.0};
  return rawLine(v);
}

JointGraph::Line JointGraph::rawLine(double v) const {
  const double integral = law_.b0 - law_.b1 * v;
  if (integral >= law_.b_max) return {law_.a0 + law_.b_max, law_.a1};
  if (integral <= law_.b_min) return {law_.a0 + law_.b_min, law_.a1};
  return {law_.a0 + law_.b0, law_.a1 + law_.b1};
}

double JointGraph::frictionAt(double v) const { return v > 0.0 ? -friction_ : v < 0.0 ? friction_ : 0.0; }

JointGraph::Line JointGraph::line(int segment) const {
  double inside = 0.0;
  if (count_ > 0) {
    inside = segment == 0        ? points_[0] - 1.0
             : segment == count_ ? points_[count_ - 1] + 1.0
                                 : 0.5 * (points_[segment - 1] + points_[segment]);
  }
  const Line actuator = actuatorLine(inside);
  return {actuator.c + frictionAt(inside), actuator.g + damping_};
}

double JointGraph::upper(int k) const {
  if (points_[k] <= v_low_) return kInfinity;
  const Line left = line(k);
  return left.c - left.g * points_[k];
}

double JointGraph::lower(int k) const {
  if (points_[k] >= v_high_) return -kInfinity;
  const Line right = line(k + 1);
  return right.c - right.g * points_[k];
}

int JointGraph::locate(double v, bool& vertical) const {
  const double target = law_.servo ? law_.servo_velocity : std::clamp(v, v_low_, v_high_);
  int k = 0;
  while (k < count_ && points_[k] < target) ++k;
  const bool at_point = k < count_ && points_[k] == target;
  vertical = at_point && (law_.servo || target == v_low_ || target == v_high_ || (target == 0.0 && friction_ > 0.0));
  return k;
}

double JointGraph::actuatorEffort(double v, double total) const {
  if (law_.servo) {
    if (v != law_.servo_velocity) return v < law_.servo_velocity ? law_.u_max : law_.u_min;
    return std::clamp(total + damping_ * v - frictionAt(v), law_.u_min, law_.u_max);
  }
  if (law_.soft) {
    const Line line = softened(rawLine(v), v);
    return line.c - line.g * v;
  }
  const double plain = std::clamp(rawEffort(v), law_.u_min, law_.u_max);
  if (v == law_.v_max) return std::clamp(total + damping_ * v - frictionAt(v), std::min(plain, 0.0), plain);
  if (v == -law_.v_max) return std::clamp(total + damping_ * v - frictionAt(v), plain, std::max(plain, 0.0));
  if (v > law_.v_max) return std::min(plain, 0.0);
  if (v < -law_.v_max) return std::max(plain, 0.0);
  return plain;
}

}  // namespace aras_visual_servo_sim
