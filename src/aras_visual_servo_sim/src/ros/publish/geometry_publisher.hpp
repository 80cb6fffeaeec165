#pragma once

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>
#include <sensor_msgs/Image.h>

#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "camera_topics.hpp"

namespace aras_visual_servo_sim {

/** <camera>/depth/image_raw (32FC1, metres, NaN where there is nothing) and <camera>/segmentation/image_raw (16UC1, the
 *  numbers of the parameter ~segmentation_ids) with the frames of every camera, drawn only for those who listen. */
class GeometryPublisher {
 public:
  GeometryPublisher(const ros::NodeHandle& node, Simulation& simulation, const std::vector<CameraTopics>& topics);

  void publish(int camera, const ros::Time& stamp);

 private:
  struct Output {
    image_transport::Publisher depth, ids;
  };
  void tellIds(const Scene& scene);

  Simulation& simulation_;
  std::map<std::string, int> ids_;
  std::vector<Output> cameras_;
};

}  // namespace aras_visual_servo_sim
