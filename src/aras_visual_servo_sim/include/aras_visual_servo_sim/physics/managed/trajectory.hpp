#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace aras_visual_servo_sim {

class Archive;

/** One joint at one instant of a trajectory. */
struct TrajectoryState {
  double position = 0.0, velocity = 0.0, acceleration = 0.0;  ///< [m or rad, per s, per s^2]
};

/** An end of a segment; what is left out decides the order of the polynomial between two ends. */
struct Knot {
  double position = 0.0;
  std::optional<double> velocity, acceleration;
};

/** One joint's motion between two instants: the polynomial through both ends, of order 5 where both give position,
 *  velocity and acceleration, 3 with position and velocity, 1 with positions alone. Before it, its beginning at rest;
 *  after it, its end at rest. Joint trajectories of ros_controllers are made of these. */
class Segment {
 public:
  Segment() = default;
  /** @param end_s  >= start_s */
  Segment(double start_s, const Knot& start, double end_s, const Knot& end);

  double startS() const { return start_s_; }
  double endS() const { return start_s_ + duration_s_; }
  TrajectoryState at(double time_s) const;

  bool of_goal = false;  ///< whether the tolerances of the goal hold on it

 private:
  friend void visit(Archive& archive, Segment& segment);

  double start_s_ = 0.0, duration_s_ = 0.0;
  std::array<double, 6> c_{};  ///< of the powers of the time since the beginning
};

/** One joint's way: segments in the order of their beginnings. Each acts until the next one begins. */
class JointPath {
 public:
  /** Rests at a position from a time on. */
  static JointPath resting(double time_s, double position);

  /** The segment that acts at a time; before the first begins, that one. */
  const Segment& active(double time_s) const { return segments_[index(time_s)]; }
  bool last(double time_s) const { return index(time_s) + 1 == segments_.size(); }
  TrajectoryState at(double time_s) const { return active(time_s).at(time_s); }

  /** What is left of this way from now until a new one takes over at a later time. */
  JointPath cut(double now_s, double until_s) const;
  void add(const Segment& segment) { segments_.push_back(segment); }
  void forGoal(bool of_goal);
  std::vector<Segment>& segments() { return segments_; }

 private:
  std::size_t index(double time_s) const;

  std::vector<Segment> segments_;  // never empty
};

/** What leads a joint from `position` to rest within a time, as ros_controllers' stop ramp: the first half of the
 *  segment that reverses its velocity. @param duration_s  > 0 */
Segment stopRamp(double time_s, double position, double velocity, double duration_s);

/** A trajectory as trajectory_msgs/JointTrajectory has it. */
struct Trajectory {
  struct Point {
    std::vector<double> positions, velocities, accelerations;  ///< of the joints; the last two may be empty
    double time_s = 0.0;                                       ///< since the trajectory's start
  };
  std::vector<std::string> joints;
  std::optional<double> start_s;  ///< nothing: now
  std::vector<Point> points;      ///< none: the joints are to stop
};

/** The points of a trajectory that lie after now.
 *  @param note  set to what was dropped, if anything that its author did not expect
 *  @return index of the first of them
 *  @throws ParameterError: times that do not increase, numbers not finite or missing, all points in the past */
std::size_t firstPointAfter(const Trajectory& trajectory, double now_s, std::string& note);

/** The multiple of a turn that brings `next` to the position nearest to `previous`. */
double turnsBetween(double previous, double next);

}  // namespace aras_visual_servo_sim
