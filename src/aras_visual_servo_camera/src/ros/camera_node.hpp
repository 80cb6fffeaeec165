#pragma once

#include <aras_visual_servo_msgs/SetReference.h>
#include <message_filters/subscriber.h>
#include <message_filters/time_synchronizer.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "aras_visual_servo_camera/matching/match_extractor.hpp"
#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"
#include "aras_visual_servo_camera/tags/tag_extractor.hpp"

namespace aras_visual_servo_camera {

/** Says the same thing at most once per period of wall time (simulated time may stand still). */
class Throttle {
 public:
  void error(const std::string& text);

 private:
  std::string last_text_;
  std::chrono::steady_clock::time_point last_{};
};

/** Brings images together with the depth images of the same stamp, in the order of the images.
 *
 *  An image waits for its depth image. It is handed on without one as soon as the depth image of a later image is here,
 *  after kPatience of wall time, and at once as long as none has come since another waited in vain. */
class DepthPairing {
 public:
  using Image = sensor_msgs::ImageConstPtr;
  using Info = sensor_msgs::CameraInfoConstPtr;
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kPatience{2};

  /** @param hand_on  is given each image with its depth image, or null */
  explicit DepthPairing(std::function<void(const Image&, const Info&, const Image&)> hand_on)
      : hand_on_(std::move(hand_on)) {}

  void addImage(const Image& image, const Info& info, Clock::time_point now);
  void addDepth(const Image& depth, Clock::time_point now);
  /** Hand on what has waited long enough. Call it now and then. */
  void look(Clock::time_point now);

 private:
  struct Waiting {
    Image image;
    Info info;
    Clock::time_point since;
  };

  std::deque<Image>::const_iterator depthOf(const Waiting& waiting) const;
  bool isOverdue(Clock::time_point now) const;

  std::function<void(const Image&, const Info&, const Image&)> hand_on_;
  std::deque<Waiting> waiting_;
  std::deque<Image> depths_;
  bool coming_ = true;
};

/** camera/image_raw and camera/camera_info of the same stamp in; camera/features out, one per pair, in order.
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
  unsigned images_since_report_ = 0, infos_since_report_ = 0, pairs_since_report_ = 0;
  Throttle throttle_;

  ros::Publisher features_pub_, photometric_pub_, matches_pub_, tag_pub_, converted_pub_, overlay_pub_;
  ros::ServiceServer reference_service_;
  message_filters::Subscriber<Image> image_sub_;
  message_filters::Subscriber<CameraInfo> info_sub_;
  message_filters::TimeSynchronizer<Image, CameraInfo> synchronizer_;
  ros::WallTimer timer_, depth_timer_;
  ros::Subscriber depth_sub_;
  std::unique_ptr<DepthPairing> depths_;  // null when no depths are asked for
};

}  // namespace aras_visual_servo_camera
