#include "camera_triggers.hpp"

#include <std_msgs/Empty.h>

namespace aras_visual_servo_sim {

CameraTriggers::CameraTriggers(ros::NodeHandle& node, Simulation& simulation, const std::vector<CameraTopics>& topics) {
  for (std::size_t k = 0; k < topics.size(); ++k) {
    const int camera = static_cast<int>(k);
    if (!simulation.cameras()[camera].model().config().triggered) continue;
    subscribers_.push_back(node.subscribe<std_msgs::Empty>(
        topics[k].trigger, 1, [&simulation, camera](const std_msgs::EmptyConstPtr&) { simulation.trigger(camera); }));
  }
}

}  // namespace aras_visual_servo_sim
