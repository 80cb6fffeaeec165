#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** Publishes where the robot is as transforms.
 *
 *  Where it stands, which robot_state_publisher cannot know from joint_states: from `world` to the root link if that
 * has another name, and from the root link to the child of its floating joint. And, if told so, from each link to the
 * next one, as robot_state_publisher does. What never moves goes to the latched /tf_static, the rest to /tf. */
class RobotFrames {
 public:
  /** @param base, links  false: another node publishes where the base is, or the links */
  RobotFrames(ros::NodeHandle& node, const Simulation& simulation, bool base, bool links);

  /** Publishes the present transforms of what moves, with this stamp: the base always, the links with images and in the
   *  gaps between them. */
  void publish(const ros::Time& stamp, bool of_image);

 private:
  enum class Kind { kFixed, kBase, kLink };
  struct Edge {
    std::string parent, child;
    int parent_link, child_link;  ///< -1: the world
    Kind kind;
  };
  void addBase();
  void addLinks();
  bool any(Kind kind) const;
  void send(ros::Publisher& publisher, const std::vector<Kind>& kinds, const ros::Time& stamp) const;

  const Simulation& simulation_;
  std::vector<Edge> edges_;
  bool base_moves_ = false, links_move_ = false;
  ros::Time links_sent_;
  ros::Publisher moving_, fixed_;
};

}  // namespace aras_visual_servo_sim
