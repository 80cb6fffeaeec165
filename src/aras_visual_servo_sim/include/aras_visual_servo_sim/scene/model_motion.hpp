#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <string>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** Where a moving model is. Frames: W world, M model. */
struct ModelPlacement {
  Pose X_WM;
  Twist V_WM_W = Twist::Zero();  ///< twist of M in W, expressed in W, [v; w] [m/s; rad/s]
};

/** How a model of the scene moves by itself: schema/motion.yaml. It is a function of simulated time only, so that runs
 *  can be repeated. */
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
  /** State of a random walk at the start of an interval, kept so that it is not walked from its beginning each time. */
  struct Knot {
    std::int64_t index = 0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  };
  ModelPlacement onCircle(const Pose& X_WM0, double t_s) const;
  ModelPlacement onRandomWalk(const Pose& X_WM0, double t_s) const;
  Twist velocityOf(const Knot& knot) const;
  ModelPlacement onWaypoints(const Pose& X_WM0, double t_s) const;
  Eigen::Quaterniond attitudeAt(std::size_t waypoint, const Eigen::Quaterniond& start) const;

  MotionConfig settings_;  // its axis of unit length
  std::string yaml_;
  mutable Knot knot_;
};

/** Adds what the schema of `motion` cannot express. */
void checkMotion(const MotionConfig& settings, const SectionCheck& section);

}  // namespace aras_visual_servo_sim
