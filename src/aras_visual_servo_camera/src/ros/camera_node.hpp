#pragma once

#include <aras_visual_servo_msgs/SetReference.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "aras_visual_servo_camera/matching/match_extractor.hpp"
#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"
#include "aras_visual_servo_camera/tags/tag_extractor.hpp"
#include "pairing.hpp"

namespace aras_visual_servo_camera {

/** Says the same thing at most once per period of wall time (simulated time may stand still). */
class Throttle {
 public:
  void error(const std::string& text);

 private:
  std::string last_text_;
  std::chrono::steady_clock::time_point last_{};
};

/** camera/image_raw and camera/camera_info in; camera/features out, one per pair, in order.
 *
 *  Where the configuration asks for depths, an image waits for the one of the same stamp on camera/depth/image_raw.
 *
 *  Also camera/converted_image (what the moments saw) and camera/overlay, made only when somebody listens, and the
 *  service camera/set_reference. Without valid intrinsics nothing is published and the reason is logged. All callbacks
 *  run on the queue of the node handle, one at a time. */
class CameraNode {
 public:
  /** @throws ParameterError listing all faults of the parameters */
  CameraNode(ros::NodeHandle node, const ros::NodeHandle& private_node);

 private:
  using Image = sensor_msgs::Image;
  using CameraInfo = sensor_msgs::CameraInfo;

  void subscribe(ros::NodeHandle node, const ros::NodeHandle& private_node);
  void onPair(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info);
  /** @param depth  null: none is asked for, or none came */
  void process(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info,
               const sensor_msgs::ImageConstPtr& depth);
  /** The depth image, if there is one that can be read. */
  std::optional<DepthView> depthOf(const sensor_msgs::ImageConstPtr& depth);
  void useIntrinsics(const CameraInfo& info);
  void publish(const Image& image, const ImageView& view);
  void reportUnpaired(const ros::WallTimerEvent& event);
  void setReference(const aras_visual_servo_msgs::SetReference::Request& request,
                    aras_visual_servo_msgs::SetReference::Response* response);
  bool onSetReference(aras_visual_servo_msgs::SetReference::Request& request,
                      aras_visual_servo_msgs::SetReference::Response& response);

  VisionConfig config_;
  std::unique_ptr<MomentExtractor> extractor_;
  std::unique_ptr<PhotometricExtractor> photometric_;  // only where the configuration has it, as
  std::unique_ptr<MatchExtractor> matches_;            // these
  std::unique_ptr<TagExtractor> tag_;
  ros::Time last_stamp_;
  int quiet_reports_ = 0;  // since the counts of pairs_ began
  Throttle throttle_;

  ros::Publisher features_pub_, photometric_pub_, matches_pub_, tag_pub_, converted_pub_, overlay_pub_;
  ros::ServiceServer reference_service_;
  InfoPairing pairs_;
  image_transport::Subscriber image_sub_;
  ros::Subscriber info_sub_, depth_sub_;
  ros::WallTimer timer_, depth_timer_;
  std::unique_ptr<DepthPairing> depths_;  // null when no depths are asked for
};

}  // namespace aras_visual_servo_camera
