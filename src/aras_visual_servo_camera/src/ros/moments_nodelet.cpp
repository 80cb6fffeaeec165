#include <nodelet/nodelet.h>

#include <pluginlib/class_list_macros.hpp>

#include "camera_node.hpp"

namespace aras_visual_servo_camera {

/** camera_node inside a nodelet manager: images of a simulator in the same manager arrive without a copy. */
class MomentsNodelet : public nodelet::Nodelet {
  void onInit() override { camera_ = std::make_unique<CameraNode>(getNodeHandle(), getPrivateNodeHandle()); }

  std::unique_ptr<CameraNode> camera_;
};

}  // namespace aras_visual_servo_camera

PLUGINLIB_EXPORT_CLASS(aras_visual_servo_camera::MomentsNodelet, nodelet::Nodelet)
