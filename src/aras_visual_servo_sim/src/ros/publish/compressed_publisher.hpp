#pragma once

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>

#include <string>

#include "aras_visual_servo_sim/camera/camera_model.hpp"

namespace aras_visual_servo_sim {

/** The topic <image>/compressed of a camera, for image_transport's transport `compressed`: JPEG files of its images.
 *  Where that transport's own plugin is installed, which offers the topic itself, this does nothing. */
class CompressedPublisher {
 public:
  CompressedPublisher() = default;
  /** @param image_topic  of the camera */
  CompressedPublisher(ros::NodeHandle& node, const image_transport::ImageTransport& transport,
                      const std::string& image_topic, const CameraModel& camera);

  bool wanted() const { return publisher_.getNumSubscribers() > 0; }
  /** @throws RenderError */
  void publish(const Image& image, const ros::Time& stamp) const;

 private:
  ros::Publisher publisher_;
  std::string frame_, format_;
  int quality_ = 0;
};

}  // namespace aras_visual_servo_sim
