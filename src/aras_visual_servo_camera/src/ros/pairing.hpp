#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <chrono>
#include <deque>
#include <functional>

namespace aras_visual_servo_camera {

/** Brings images together with the camera_info of the nearest stamp, in the order of the images.
 *
 *  An image waits until a camera_info of its stamp, or one as near as `slop`, is here. It is given up once the next
 *  camera_info is later than that, because each topic keeps its order. */
class InfoPairing {
 public:
  using Image = sensor_msgs::ImageConstPtr;
  using Info = sensor_msgs::CameraInfoConstPtr;

  /** @param slop  largest difference of the stamps
   *  @param hand_on  is given each pair */
  InfoPairing(const ros::Duration& slop, std::function<void(const Image&, const Info&)> hand_on)
      : slop_(slop), hand_on_(std::move(hand_on)) {}

  void addImage(const Image& image);
  void addInfo(const Info& info);

  /** What came and what became of it. Images from before the first pair are not lost: the other topic had not begun. */
  struct Counts {
    unsigned images = 0, infos = 0, pairs = 0, lost = 0;
  };
  const Counts& counts() const { return counts_; }
  /** Counts from 0 again. */
  void resetCounts() { counts_ = Counts(); }

 private:
  void look();
  void giveUp();

  ros::Duration slop_;
  std::function<void(const Image&, const Info&)> hand_on_;
  std::deque<Image> waiting_;
  std::deque<Info> infos_;
  ros::Time last_stamp_;
  bool paired_ = false;
  Counts counts_;
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

}  // namespace aras_visual_servo_camera
