#include "robot_frames.hpp"

#include <ros/console.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>

#include "convert/conversions.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint32_t kFrameQueue = 1000;  // messages: at 100 Hz ten seconds
const ros::Duration kLongestGap(0.034);      // between two transforms of a link: a picture of 30 Hz shows each

}  // namespace

RobotFrames::RobotFrames(ros::NodeHandle& node, const Simulation& simulation, bool base, bool links)
    : simulation_(simulation) {
  if (base) addBase();
  if (links) addLinks();
  base_moves_ = any(Kind::kBase);
  links_move_ = any(Kind::kLink);
  if (base_moves_ || links_move_) moving_ = node.advertise<tf2_msgs::TFMessage>("/tf", kFrameQueue);
  if (!any(Kind::kFixed)) return;
  fixed_ = node.advertise<tf2_msgs::TFMessage>("/tf_static", kFrameQueue, true);
  send(fixed_, {Kind::kFixed}, ros::Time());
}

void RobotFrames::addBase() {
  const RobotModel& model = simulation_.model();
  const std::string& root = model.links.front().name;
  const bool free = simulation_.body().floatingBase();
  const Joint* floating = model.floatingJoint();
  const Pose X_WR = simulation_.body().linkPose(0);
  if (root != kWorldFrame) {
    edges_.push_back({kWorldFrame, root, -1, 0, free && !floating ? Kind::kBase : Kind::kFixed});
  } else if (free && !floating) {
    ROS_WARN("the root link is called world and moves: its transforms are not published");
  } else if (!X_WR.matrix().isIdentity()) {
    ROS_WARN("the root link is called world and sim/base_pose puts it elsewhere: transforms do not show that");
  }
  if (!floating) return;
  const std::string& child = model.links[floating->child_link].name;
  edges_.push_back({root, child, 0, floating->child_link, free ? Kind::kBase : Kind::kFixed});
}

void RobotFrames::addLinks() {
  const RobotModel& model = simulation_.model();
  for (const Joint& joint : model.joints) {
    if (joint.type == JointType::kFloating) continue;
    edges_.push_back({model.links[joint.parent_link].name, model.links[joint.child_link].name, joint.parent_link,
                      joint.child_link, joint.moves() ? Kind::kLink : Kind::kFixed});
  }
}

bool RobotFrames::any(Kind kind) const {
  return std::any_of(edges_.begin(), edges_.end(), [kind](const Edge& edge) { return edge.kind == kind; });
}

void RobotFrames::publish(const ros::Time& stamp, bool of_image) {
  const bool links = links_move_ && (of_image || stamp < links_sent_ || stamp - links_sent_ >= kLongestGap);
  if (links) links_sent_ = stamp;
  if (links) {
    send(moving_, {Kind::kBase, Kind::kLink}, stamp);
  } else if (base_moves_) {
    send(moving_, {Kind::kBase}, stamp);
  }
}

void RobotFrames::send(ros::Publisher& publisher, const std::vector<Kind>& kinds, const ros::Time& stamp) const {
  tf2_msgs::TFMessage message;
  const MultibodyWorld& world = simulation_.body();
  for (const Edge& edge : edges_) {
    if (std::count(kinds.begin(), kinds.end(), edge.kind) == 0) continue;
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
