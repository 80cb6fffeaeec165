#pragma once

#include <aras_visual_servo_msgs/JointControllerState.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TwistStamped.h>
#include <image_transport/image_transport.h>
#include <nav_msgs/Path.h>
#include <ros/node_handle.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/JointState.h>

#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/simulation/cameras/frame_schedule.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "camera_topics.hpp"
#include "compressed_publisher.hpp"
#include "convert/parameters.hpp"
#include "convert/wire_time.hpp"
#include "geometry_publisher.hpp"
#include "record/recording.hpp"
#include "robot_frames.hpp"

namespace aras_visual_servo_sim {

/** Publishes the messages that are due at a tick, each with the stamp of the state it describes.
 *
 *  Order at an image: clock, joint_states, ground truth, camera_info, image. Of a camera with latency the last two come
 * that much later, after the clock, with the stamp of the others. Outside lockstep joint_states are late by
 *  joint_state_delay_s. */
class StatePublisher {
 public:
  /** @param topics  of every camera of the simulation */
  StatePublisher(const ros::NodeHandle& node, Simulation& simulation, const NodeParameters& parameters,
                 const std::vector<CameraTopics>& topics, const WireTime& time, Recording& recording);

  /** Tick of the next sample after the present one. */
  std::int64_t nextTick() const;

  /** Publishes what is due at the present tick and was not published yet.
   *  @return the cameras, by index, whose images went out */
  std::vector<int> publishDue();

  void publishClock();
  /** Forgets which samples were published; to be called after a reset of the simulation. */
  void reset();
  /** To be called after a restored state: publishes its samples again. A frame that was taken at its tick already is
   * sent once more, and so are joint states and camera poses of the frames in flight. @return as publishDue */
  std::vector<int> resume();

  /** Stamp of the image of a camera that went out at the present tick, in the simulation's time [ns]. */
  std::int64_t imageNs(int camera) const;

  std::uint64_t frames() const { return frames_; }
  /** Frames that could not be rendered, and those of drop_probability. */
  std::uint64_t droppedFrames() const { return dropped_frames_ + simulation_.cameras().droppedFrames(); }

 private:
  struct CameraOutput {
    image_transport::Publisher image;
    Tap* image_tap = nullptr;
    CompressedPublisher compressed;
    Outlet<sensor_msgs::CameraInfo> info;
    Outlet<geometry_msgs::PoseStamped> pose;
    Outlet<geometry_msgs::TwistStamped> twist;
    sensor_msgs::CameraInfo info_message;
    sensor_msgs::Image image_format;  ///< all but stamp and data
  };
  struct ControllerOutput {
    std::string name;
    bool always;
    ros::Publisher state;
  };

  void advertiseCamera(int camera, const CameraTopics& topics);
  void publishPresentJoints(bool of_image);
  void publishJoints(const ros::Time& stamp, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                     const Eigen::VectorXd& efforts, bool of_image);
  void publishControllers(const ros::Time& stamp);
  void publishTarget(const ros::Time& stamp);
  void publishCamera(int camera, const ros::Time& stamp, const Pose& X_WC, const Twist& V_WC_C);
  FrameWanted wantedOf(int camera) const;
  void publishImage(const FrameWanted& frame);
  void publishLate();
  void publishPath(const ros::Time& stamp, const geometry_msgs::Pose& pose);

  ros::NodeHandle node_;
  image_transport::ImageTransport transport_;
  Simulation& simulation_;
  const WireTime& time_;
  Recording& recording_;
  bool render_always_;
  FrameSchedule clock_schedule_, joint_schedule_;
  std::int64_t next_clock_ = 0, next_joints_ = 0;  ///< indices into the schedules
  std::int64_t sampled_tick_ = -1;
  std::int64_t joint_delay_ticks_;
  std::deque<std::pair<std::int64_t, sensor_msgs::JointState>> late_joints_;  ///< with the ticks at which they are due
  std::uint64_t frames_ = 0, dropped_frames_ = 0;
  Outlet<rosgraph_msgs::Clock> clock_;
  Outlet<sensor_msgs::JointState> joints_, image_joints_;
  Outlet<geometry_msgs::PoseStamped> target_pose_;
  Outlet<geometry_msgs::TwistStamped> target_twist_;
  ros::Publisher path_;
  std::vector<CameraOutput> cameras_;
  GeometryPublisher geometry_;
  RobotFrames robot_frames_;
  std::vector<ExtraJoint> extra_joints_;
  std::vector<ControllerOutput> controllers_;
  sensor_msgs::JointState joint_message_;
  nav_msgs::Path path_message_;
  ros::WallTime path_sent_;
};

}  // namespace aras_visual_servo_sim
