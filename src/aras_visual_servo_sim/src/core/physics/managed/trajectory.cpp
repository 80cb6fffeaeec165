#include "aras_visual_servo_sim/physics/managed/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kTwoPi = 6.283185307179586476925;

std::string seconds(double time_s) {
  std::ostringstream out;
  out << time_s;
  return out.str() + " s";
}

bool finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/** @throws ParameterError unless every point has a position for every joint, and all or no velocities and so on */
void checkPoints(const Trajectory& trajectory) {
  const std::size_t joints = trajectory.joints.size();
  for (std::size_t k = 0; k < trajectory.points.size(); ++k) {
    const Trajectory::Point& point = trajectory.points[k];
    const std::string where = "trajectory point " + std::to_string(k) + ": ";
    const auto fits = [joints](const std::vector<double>& values, bool may_be_empty) {
      return values.size() == joints || (may_be_empty && values.empty());
    };
    if (!fits(point.positions, false) || !fits(point.velocities, true) || !fits(point.accelerations, true)) {
      throw ParameterError(where + "Size mismatch in trajectory point position, velocity or acceleration data: found " +
                           std::to_string(point.positions.size()) + ", " + std::to_string(point.velocities.size()) +
                           " and " + std::to_string(point.accelerations.size()) + " numbers for " +
                           std::to_string(joints) + " joints");
    }
    if (!finite(point.positions) || !finite(point.velocities) || !finite(point.accelerations) ||
        !std::isfinite(point.time_s)) {
      throw ParameterError(where + "found a number that is not finite, allowed are finite numbers");
    }
    if (k > 0 && !(point.time_s > trajectory.points[k - 1].time_s)) {
      throw ParameterError(where + "Trajectory message contains waypoints that are not strictly increasing in time: " +
                           seconds(trajectory.points[k - 1].time_s) + ", then " + seconds(point.time_s));
    }
  }
}

}  // namespace

Segment::Segment(double start_s, const Knot& start, double end_s, const Knot& end)
    : start_s_(start_s), duration_s_(end_s - start_s) {
  const double T = duration_s_;
  const double p0 = start.position, p1 = end.position;
  c_[0] = p0;
  if (!start.velocity || !end.velocity) {
    c_[1] = T == 0.0 ? 0.0 : (p1 - p0) / T;
    return;
  }
  const double v0 = *start.velocity, v1 = *end.velocity;
  c_[1] = v0;
  if (!start.acceleration || !end.acceleration) {
    if (T == 0.0) return;
    c_[2] = (3.0 * (p1 - p0) - (2.0 * v0 + v1) * T) / (T * T);
    c_[3] = (2.0 * (p0 - p1) + (v0 + v1) * T) / (T * T * T);
    return;
  }
  const double a0 = *start.acceleration, a1 = *end.acceleration;
  c_[2] = 0.5 * a0;
  if (T == 0.0) return;
  const double T2 = T * T, T3 = T2 * T, dp = p1 - p0;
  c_[3] = (20.0 * dp - (12.0 * v0 + 8.0 * v1) * T - (3.0 * a0 - a1) * T2) / (2.0 * T3);
  c_[4] = (-30.0 * dp + (16.0 * v0 + 14.0 * v1) * T + (3.0 * a0 - 2.0 * a1) * T2) / (2.0 * T3 * T);
  c_[5] = (12.0 * dp - 6.0 * (v0 + v1) * T - (a0 - a1) * T2) / (2.0 * T3 * T2);
}

TrajectoryState Segment::at(double time_s) const {
  const double t = std::clamp(time_s - start_s_, 0.0, duration_s_);
  TrajectoryState state;
  state.position = c_[0] + t * (c_[1] + t * (c_[2] + t * (c_[3] + t * (c_[4] + t * c_[5]))));
  if (time_s < start_s_ || time_s > start_s_ + duration_s_) return state;
  state.velocity = c_[1] + t * (2.0 * c_[2] + t * (3.0 * c_[3] + t * (4.0 * c_[4] + t * 5.0 * c_[5])));
  state.acceleration = 2.0 * c_[2] + t * (6.0 * c_[3] + t * (12.0 * c_[4] + t * 20.0 * c_[5]));
  return state;
}

JointPath JointPath::resting(double time_s, double position) {
  JointPath path;
  const Knot rest{position, 0.0, 0.0};
  path.add(Segment(time_s, rest, time_s, rest));
  return path;
}

std::size_t JointPath::index(double time_s) const {
  const auto later = std::upper_bound(segments_.begin(), segments_.end(), time_s,
                                      [](double time, const Segment& segment) { return time < segment.startS(); });
  return later == segments_.begin() ? 0 : static_cast<std::size_t>(later - segments_.begin()) - 1;
}

JointPath JointPath::cut(double now_s, double until_s) const {
  JointPath left;
  left.segments_.assign(segments_.begin() + static_cast<std::ptrdiff_t>(index(now_s)),
                        segments_.begin() + static_cast<std::ptrdiff_t>(index(until_s)) + 1);
  return left;
}

void JointPath::forGoal(bool of_goal) {
  for (Segment& segment : segments_) segment.of_goal = of_goal;
}

Segment stopRamp(double time_s, double position, double velocity, double duration_s) {
  const Segment reversal(time_s, {position, velocity, 0.0}, time_s + 2.0 * duration_s, {position, -velocity, 0.0});
  const double rest = reversal.at(time_s + duration_s).position;
  return Segment(time_s, {position, velocity, 0.0}, time_s + duration_s, {rest, 0.0, 0.0});
}

std::size_t firstPointAfter(const Trajectory& trajectory, double now_s, std::string& note) {
  checkPoints(trajectory);
  const auto& points = trajectory.points;
  const double start_s = trajectory.start_s.value_or(now_s);
  std::size_t first = 0;
  while (first < points.size() && start_s + points[first].time_s <= now_s) ++first;
  if (first == points.size()) {
    throw ParameterError("Dropping all " + std::to_string(points.size()) +
                         " trajectory point(s), as they occur before the current time. Last point is " +
                         seconds(now_s - start_s - points.back().time_s) + " in the past.");
  }
  const bool begins_now = first == 1 && !trajectory.start_s && points[0].time_s == 0.0;
  if (first > 0 && !begins_now) {
    note = "Dropping first " + std::to_string(first) + " trajectory point(s) out of " + std::to_string(points.size()) +
           ", as they occur before the current time. First valid point will be reached in " +
           seconds(start_s + points[first].time_s - now_s) + ".";
  }
  return first;
}

double turnsBetween(double previous, double next) { return std::round((previous - next) / kTwoPi) * kTwoPi; }

}  // namespace aras_visual_servo_sim
