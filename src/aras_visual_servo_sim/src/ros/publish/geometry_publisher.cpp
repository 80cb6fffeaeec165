#include "geometry_publisher.hpp"

#include <sensor_msgs/image_encodings.h>

#include <cstring>

#include "convert/parameters.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint32_t kPoseQueue = 10;

}  // namespace

GeometryPublisher::GeometryPublisher(const ros::NodeHandle& node, Simulation& simulation,
                                     const std::vector<CameraTopics>& topics, Recording& recording)
    : simulation_(simulation), recording_(recording) {
  image_transport::ImageTransport transport(node);
  const auto output = [&](const std::string& topic) -> Output {
    return {transport.advertise(topic, kPoseQueue), &recording.tap(topic)};
  };
  for (const CameraTopics& camera : topics) cameras_.push_back({output(camera.depth), output(camera.segmentation)});
  tellIds(simulation.scene());
}

void GeometryPublisher::tellIds(const Scene& scene) {
  std::map<std::string, int> ids;
  for (const auto& [name, id] : segmentationIds(scene)) ids[name] = id;
  if (ids == ids_) return;
  ids_ = ids;
  ros::NodeHandle("~").setParam(kSegmentationIds, ids);
}

template <typename T>
void GeometryPublisher::send(const Output& output, const GeometryImage& image, const std::vector<T>& values,
                             const std::string& encoding, const std::string& frame, const ros::Time& stamp) {
  sensor_msgs::Image message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.width = static_cast<std::uint32_t>(image.width);
  message.height = static_cast<std::uint32_t>(image.height);
  message.encoding = encoding;
  message.step = static_cast<std::uint32_t>(image.width * sizeof(T));
  message.data.resize(values.size() * sizeof(T));
  std::memcpy(message.data.data(), values.data(), message.data.size());
  output.publisher.publish(message);
  recording_.write(*output.tap, message);
}

bool GeometryPublisher::wanted(int camera) const {
  return cameras_[camera].depth.wanted() || cameras_[camera].ids.wanted();
}

void GeometryPublisher::publish(int camera, const ros::Time& stamp) {
  const CameraOutput& output = cameras_[camera];
  const bool depth = output.depth.wanted(), ids = output.ids.wanted();
  const GeometryImage& image = simulation_.cameras()[camera].geometry;
  const std::string& frame = simulation_.cameras()[camera].model().config().frame;
  namespace encodings = sensor_msgs::image_encodings;
  if (depth) send(output.depth, image, image.depth_m, encodings::TYPE_32FC1, frame, stamp);
  if (!ids) return;
  tellIds(simulation_.shownScene(camera));
  send(output.ids, image, image.ids, encodings::TYPE_16UC1, frame, stamp);
}

}  // namespace aras_visual_servo_sim
