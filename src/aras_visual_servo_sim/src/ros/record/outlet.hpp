#pragma once

#include <ros/node_handle.h>

#include <string>

#include "recording.hpp"

namespace aras_visual_servo_sim {

/** A topic of this node: over the wire to those who listen, and into the bag while it is recorded. */
template <typename Message>
class Outlet {
 public:
  Outlet() = default;
  Outlet(ros::NodeHandle& node, Recording& recording, const std::string& topic, std::uint32_t queue)
      : publisher_(node.advertise<Message>(topic, queue)), recording_(&recording), tap_(&recording.tap(topic)) {}

  void publish(const Message& message) {
    publisher_.publish(message);
    recording_->write(*tap_, message);
  }
  bool wanted() const { return tap_->open || publisher_.getNumSubscribers() > 0; }

 private:
  ros::Publisher publisher_;
  Recording* recording_ = nullptr;
  Tap* tap_ = nullptr;
};

}  // namespace aras_visual_servo_sim
