#pragma once

#include <array>
#include <limits>

namespace aras_visual_servo_sim {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/** Effort of an actuator as a function of the joint's velocity v at the end of the step, never increasing with v:
 *  clamp(a0 - a1 v + clamp(b0 - b1 v, b_min, b_max), u_min, u_max), and none of it towards a speed beyond v_max.
 *  With soft limits, not beyond v_max but: clamped to [clamp(-g (v - v_soft_low), u_min, u_max),
 *  clamp(-g (v - v_soft_high), u_min, u_max)], g = soft_gain.
 *  As a servo: whatever effort in [u_min, u_max] it takes to have v = servo_velocity. */
struct ActuatorLaw {
  double a0 = 0.0, a1 = 0.0;                            ///< proportional and derivative part
  double b0 = 0.0, b1 = 0.0, b_min = 0.0, b_max = 0.0;  ///< integral part
  double u_min = 0.0, u_max = 0.0;
  double v_max = kInfinity;
  bool servo = false;
  double servo_velocity = 0.0;
  bool soft = false;
  double soft_gain = 0.0, v_soft_low = 0.0, v_soft_high = 0.0;
};

/** Total effort on a joint over v: actuator, viscous damping, Coulomb friction, position stops.
 *
 *  A never increasing graph made of segments 0..points(), segment k lying between point(k - 1) and point(k), with
 *  vertical parts at some points: friction at v = 0, the stops at the velocity that just reaches them, the velocity
 *  limit, the servo. */
class JointGraph {
 public:
  struct Line {
    double c, g;  ///< effort = c - g v, g >= 0
  };

  /** @param v_low, v_high  velocities that reach the position limits at the end of the step; v_low <= v_high */
  void build(const ActuatorLaw& law, double damping, double friction, double v_low, double v_high);

  int points() const { return count_; }
  double point(int k) const { return points_[k]; }
  Line line(int segment) const;

  /** Efforts just left (upper) and just right (lower) of a point; equal where the graph is continuous. */
  double upper(int k) const;
  double lower(int k) const;

  /** Where a search that starts at v begins: the segment v lies in, or the point it equals if the graph is vertical
   *  there (`vertical` is set then); for a servo always its own point. */
  int locate(double v, bool& vertical) const;

  /** The actuator's share when the joint ends at v and `total` acts on it. */
  double actuatorEffort(double v, double total) const;

 private:
  void add(double v);
  void addLawPoints();
  void addSoftPoints(double v_soft);
  Line softLine(double v_soft, double v) const;
  Line softened(Line raw, double v) const;
  double rawEffort(double v) const;
  double rawRoot(double effort) const;
  Line rawLine(double v) const;
  Line actuatorLine(double v) const;
  double frictionAt(double v) const;

  ActuatorLaw law_;
  double damping_ = 0.0, friction_ = 0.0, v_low_ = 0.0, v_high_ = 0.0;
  std::array<double, 20> points_;  // at most 17: 2 stops, friction, 4 of the PID and its limits, 2 x 5 of soft limits
  int count_ = 0;
};

}  // namespace aras_visual_servo_sim
