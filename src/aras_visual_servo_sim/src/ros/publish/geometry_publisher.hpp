#pragma once

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>
#include <sensor_msgs/Image.h>

#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "camera_topics.hpp"
#include "record/recording.hpp"

namespace aras_visual_servo_sim {

/** <camera>/depth/image_raw (32FC1, metres, NaN where there is nothing) and <camera>/segmentation/image_raw (16UC1, the
 *  numbers of the parameter ~segmentation_ids) with the frames of every camera, drawn only if someone listens or
 *  records. */
class GeometryPublisher {
 public:
  GeometryPublisher(const ros::NodeHandle& node, Simulation& simulation, const std::vector<CameraTopics>& topics,
                    Recording& recording);

  bool wanted(int camera) const;
  /** What was drawn last of a camera. */
  void publish(int camera, const ros::Time& stamp);

 private:
  struct Output {
    image_transport::Publisher publisher;
    Tap* tap;
    bool wanted() const { return tap->open || publisher.getNumSubscribers() > 0; }
  };
  struct CameraOutput {
    Output depth, ids;
  };
  template <typename T>
  void send(const Output& output, const GeometryImage& image, const std::vector<T>& values, const std::string& encoding,
            const std::string& frame, const ros::Time& stamp);
  void tellIds(const Scene& scene);

  Simulation& simulation_;
  std::map<std::string, int> ids_;
  Recording& recording_;
  std::vector<CameraOutput> cameras_;
};

}  // namespace aras_visual_servo_sim
