#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** Where a moving model is. Frames: W world, M model. */
struct ModelPlacement {
  Pose X_WM;
  Twist V_WM_W = Twist::Zero();  ///< twist of M in W, expressed in W, [v; w] [m/s; rad/s]
};

/** Motion with constant velocity and constant angular velocity. */
struct ConstantVelocity {
  Eigen::Vector3d linear_m_per_s, angular_rad_per_s;  ///< in W
  ModelPlacement at(const Pose& X_WM0, double t_s) const;
};

/** Motion along a circle on which the model starts; its attitude does not change. */
struct CircleMotion {
  double radius_m;                 ///< > 0
  double angular_speed_rad_per_s;  ///< of the radius, counter-clockwise about `axis`
  Eigen::Vector3d axis;            ///< normal of the circle's plane, unit length, in W
  double phase_rad;                ///< of the start; zero is W's x axis (y for an axis along x), in the plane
  ModelPlacement at(const Pose& X_WM0, double t_s) const;
};

/** Random walk: a new velocity is drawn for every interval, each component normal with mean zero. Farther than
 * `radius_m` from its start the model is turned back: the outward part of a drawn velocity changes its sign. */
struct RandomWalk {
  explicit RandomWalk(const MotionConfig& settings);
  double interval_s;                                                     ///< > 0
  Eigen::Vector3d speed_stddev_m_per_s, angular_speed_stddev_rad_per_s;  ///< of the components in W, >= 0
  double radius_m;                                                       ///< > 0, or 0 for no bound
  std::uint64_t seed;
  ModelPlacement at(const Pose& X_WM0, double t_s) const;

 private:
  /** State at the start of an interval. It is kept so that the walk is not repeated from its beginning each time. */
  struct Knot {
    std::int64_t index = 0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  };
  Twist velocityOf(const Knot& knot) const;
  mutable Knot knot_;
};

/** Motion from pose to pose at given times, straight and at constant speed from each to the next. */
struct WaypointMotion {
  explicit WaypointMotion(const MotionConfig& settings);
  struct Waypoint {
    double time_s;  ///< since the start of the motion, strictly increasing, >= 0
    Eigen::Vector3d p;
    std::optional<Eigen::Quaterniond> q;  ///< nothing: as at the waypoint before
  };
  std::vector<Waypoint> waypoints;  ///< not empty
  bool repeat;                      ///< after the last waypoint: start again, or stay there
  ModelPlacement at(const Pose& X_WM0, double t_s) const;
};

/** How a model of the scene moves by itself. It is a function of simulated time only, so that runs can be repeated. */
class ModelMotion {
 public:
  /** @param node  the YAML that the settings come from, which saved states keep */
  ModelMotion(const MotionConfig& settings, const YAML::Node& node);
  /** @param where  name for messages @throws ParameterError listing all faults */
  static ModelMotion fromYaml(const YAML::Node& node, const std::string& where);

  /** @param X_WM0  pose at the start of the motion @param t_s  time since then, >= 0 */
  ModelPlacement at(const Pose& X_WM0, double t_s) const;
  /** What fromYaml reads to make the same motion. */
  const std::string& yaml() const { return yaml_; }

 private:
  std::variant<ConstantVelocity, CircleMotion, RandomWalk, WaypointMotion> path_;
  double delay_s_;  ///< the model rests this long first
  std::string yaml_;
};

/** Adds what the schema of `motion` cannot express. */
void checkMotion(const MotionConfig& settings, const SectionCheck& section);

}  // namespace aras_visual_servo_sim
