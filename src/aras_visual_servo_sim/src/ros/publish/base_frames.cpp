#include "base_frames.hpp"

#include <ros/console.h>
#include <tf2_msgs/TFMessage.h>

#include "convert/conversions.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint32_t kQueue = 1000;  // messages: at 100 Hz ten seconds

}  // namespace

BaseFrames::BaseFrames(ros::NodeHandle& node, const Simulation& simulation, bool enabled) : simulation_(simulation) {
  if (!enabled) return;
  const RobotModel& model = simulation.model();
  const std::string& root = model.links.front().name;
  const bool free = simulation.world().floatingBase();
  const Joint* floating = model.floatingJoint();
  const Pose X_WR = simulation.world().linkPose(0);
  if (root != kWorldFrame) {
    edges_.push_back({kWorldFrame, root, -1, 0, free && !floating});
  } else if (free && !floating) {
    ROS_WARN("the root link is called world and moves: its transforms are not published");
  } else if (!X_WR.matrix().isIdentity()) {
    ROS_WARN("the root link is called world and sim/base_pose puts it elsewhere: transforms do not show that");
  }
  if (floating) edges_.push_back({root, model.links[floating->child_link].name, 0, floating->child_link, free});
  bool any_rests = false;
  for (const Edge& edge : edges_) (edge.moves ? any_moves_ : any_rests) = true;
  if (any_moves_) moving_ = node.advertise<tf2_msgs::TFMessage>("/tf", kQueue);
  if (!any_rests) return;
  fixed_ = node.advertise<tf2_msgs::TFMessage>("/tf_static", kQueue, true);
  send(fixed_, false, ros::Time());
}

void BaseFrames::publish(const ros::Time& stamp) {
  if (any_moves_) send(moving_, true, stamp);
}

void BaseFrames::send(ros::Publisher& publisher, bool moving, const ros::Time& stamp) const {
  tf2_msgs::TFMessage message;
  const MultibodyWorld& world = simulation_.world();
  for (const Edge& edge : edges_) {
    if (edge.moves != moving) continue;
    const Pose X_WP = edge.parent_link < 0 ? Pose{} : world.linkPose(edge.parent_link);
    const geometry_msgs::Pose pose = toMessage(X_WP.inverse() * world.linkPose(edge.child_link));
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = stamp;
    transform.header.frame_id = edge.parent;
    transform.child_frame_id = edge.child;
    transform.transform.translation.x = pose.position.x;
    transform.transform.translation.y = pose.position.y;
    transform.transform.translation.z = pose.position.z;
    transform.transform.rotation = pose.orientation;
    message.transforms.push_back(transform);
  }
  publisher.publish(message);
}

}  // namespace aras_visual_servo_sim
