#include "camera_topics.hpp"

namespace aras_visual_servo_sim {
namespace {

std::string withoutSlashes(std::string name) {
  name.erase(0, name.find_first_not_of('/'));
  return name;
}

const CameraTag* tagOf(const RobotModel& robot, const std::string& camera) {
  for (const CameraTag& tag : robot.cameras) {
    if (withoutSlashes(tag.camera_name) == camera) return &tag;
  }
  return nullptr;
}

std::string orElse(const std::string& name, const std::string& otherwise) {
  return name.empty() ? otherwise : withoutSlashes(name);
}

}  // namespace

std::vector<CameraTopics> cameraTopics(const Simulation& simulation, bool gazebo_names) {
  std::vector<CameraTopics> topics;
  for (const std::string& name : simulation.cameras().names()) {
    const CameraTag* found = tagOf(simulation.model(), name);
    const CameraTag tag = found ? *found : CameraTag();
    std::string base = name + "/";
    if (found && gazebo_names) {
      std::string space = withoutSlashes(tag.robot_namespace.value_or(""));
      if (tag.robot_namespace && space.empty()) space = simulation.model().name;
      base = "/" + (space.empty() ? "" : space + "/") + base;
    }
    topics.push_back({base + orElse(tag.image_topic, "image_raw"), base + orElse(tag.camera_info_topic, "camera_info"),
                      base + "depth/image_raw", base + "segmentation/image_raw",
                      base + orElse(tag.trigger_topic, "image_trigger")});
  }
  return topics;
}

}  // namespace aras_visual_servo_sim
