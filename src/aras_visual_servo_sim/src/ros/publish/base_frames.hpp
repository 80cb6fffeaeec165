#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** Publishes where the robot stands as transforms, which robot_state_publisher cannot know from joint_states.
 *
 *  From `world` to the root link if that has another name, and from the root link to the child of its floating joint.
 * What never moves goes to the latched /tf_static, the rest to /tf with the stamp of the joint states. */
class BaseFrames {
 public:
  /** @param enabled  false: nothing is published, because another node publishes where the base is */
  BaseFrames(ros::NodeHandle& node, const Simulation& simulation, bool enabled);

  /** Publishes the present transforms of everything that moves, with this stamp. */
  void publish(const ros::Time& stamp);

 private:
  struct Edge {
    std::string parent, child;
    int parent_link, child_link;  ///< -1: the world
    bool moves;
  };
  void send(ros::Publisher& publisher, bool moving, const ros::Time& stamp) const;

  const Simulation& simulation_;
  std::vector<Edge> edges_;
  bool any_moves_ = false;
  ros::Publisher moving_, fixed_;
};

}  // namespace aras_visual_servo_sim
