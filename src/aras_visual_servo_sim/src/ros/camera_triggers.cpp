#include "camera_triggers.hpp"

#include <std_msgs/Empty.h>

#include <algorithm>

namespace aras_visual_servo_sim {

CameraTriggers::CameraTriggers(ros::NodeHandle& node, Simulation& simulation) {
  for (std::size_t k = 0; k < simulation.cameraNames().size(); ++k) {
    const int camera = static_cast<int>(k);
    if (!simulation.camera(camera).config().triggered) continue;
    const std::string& name = simulation.cameraNames()[k];
    std::string topic = "image_trigger";
    for (const CameraTag& tag : simulation.model().cameras) {
      const bool same =
          tag.camera_name.substr(std::min(tag.camera_name.find_first_not_of('/'), tag.camera_name.size())) == name;
      if (same && !tag.trigger_topic.empty()) topic = tag.trigger_topic;
    }
    subscribers_.push_back(node.subscribe<std_msgs::Empty>(
        name + "/" + topic, 1, [&simulation, camera](const std_msgs::EmptyConstPtr&) { simulation.trigger(camera); }));
  }
}

}  // namespace aras_visual_servo_sim
