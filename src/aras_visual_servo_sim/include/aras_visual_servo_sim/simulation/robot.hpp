#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/simulation/commands.hpp"
#include "aras_visual_servo_sim/simulation/models/contacts.hpp"
#include "aras_visual_servo_sim/simulation/simulation_config.hpp"

namespace aras_visual_servo_sim {

/** A robot of a world: its model, its body with the controllers, and the commands to it. World::spawn makes it. */
class Robot {
 public:
  /** @param name  unique in its world, "" for the robot of a Simulation @param number  likewise */
  Robot(const std::string& name, int number, RobotModel model, const SimulationConfig& config, std::int64_t period_ns,
        const PackagePaths& packages);
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  const std::string& name() const { return name_; }
  int number() const { return number_; }
  const RobotModel& model() const { return model_; }
  MultibodyWorld& body() { return *body_; }
  const MultibodyWorld& body() const { return *body_; }
  const Commands& commands() const { return commands_; }
  /** Time of the world [s]. */
  double nowS() const { return 1e-9 * static_cast<double>(nowNs()); }
  /** The links as the world names them, see scoped. */
  std::vector<std::string> scopedLinks() const;

  // --- commands, see Commands
  void setCommand(const JointCommand& command, std::optional<std::int64_t> stamp_ns = std::nullopt) {
    commands_.apply(command, stamp_ns, nowNs(), *body_);
  }
  /** Moves a driven base, see MultibodyWorld::twistCommand; else as setCommand. */
  void setTwist(const Twist& V_WL_L, const std::string& link, std::optional<std::int64_t> stamp_ns = std::nullopt);
  void setControllerCommand(const std::string& controller, double value) { commands_.apply(controller, value, *body_); }
  void refuse(const std::string& reason) { commands_.refuse(reason, *body_); }
  /** Places joints, at rest. @throws as MultibodyWorld::setJointPositions */
  void setJointPositions(const std::map<std::string, double>& positions);
  /** Places a floating base, with a twist [v; w] in world axes; a driven one takes no twist.
   *  @throws as MultibodyWorld::setBasePose; nothing changes then */
  void setBase(const Pose& X_WB, const Twist& V_WB_W);

 private:
  friend class World;

  std::int64_t nowNs() const { return body_->ticks() * period_ns_; }
  /** @throws ParameterError naming each initial position of a joint that the robot does not have */
  void checkStart() const;
  /** Makes the body, at the start: a joint that is not named stands at 0, or where its limits exclude 0 at the nearer
   *  one. @throws as MultibodyWorld and its setJointPositions */
  void makeBody();
  /** Puts the body back to its start, at rest. */
  void putBack();

  std::string name_;
  int number_;
  RobotModel model_;
  WorldConfig config_;
  std::int64_t period_ns_;
  /** Where the body stands when it is made. */
  struct Start {
    std::map<std::string, double> positions;  // of the configuration, by joint name [m or rad]
    Eigen::VectorXd q;
    Pose X_WB;
  } start_;
  Contacts contacts_;
  Commands commands_;
  std::unique_ptr<MultibodyWorld> body_;
  std::function<void()> placed_;  // tells the world that joints or base were placed
};

/** The robots of a world, in the order in which they were spawned. */
using Robots = std::vector<std::shared_ptr<Robot>>;

/** The robot of a number. @pre it is there */
const Robot& robotOf(const Robots& robots, int number);
/** The robot that has a link, and the index of the link. @param link  as the world names it @throws UnknownNameError */
std::pair<const Robot*, int> findLink(const Robots& robots, const std::string& link);

}  // namespace aras_visual_servo_sim
