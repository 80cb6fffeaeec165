#include "compressed_publisher.hpp"

#include <sensor_msgs/CompressedImage.h>

#include <algorithm>
#include <vector>

#include "aras_visual_servo_sim/image/sensor/jpeg.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint32_t kNewest = 1;
constexpr int kQuality = 80;  // of compressed_image_transport, when nothing else is said

bool pluginIsThere(const image_transport::ImageTransport& transport) {
  const std::vector<std::string> transports = transport.getDeclaredTransports();
  return std::find(transports.begin(), transports.end(), "image_transport/compressed") != transports.end();
}

}  // namespace

CompressedPublisher::CompressedPublisher(ros::NodeHandle& node, const image_transport::ImageTransport& transport,
                                         const std::string& image_topic, const CameraModel& camera)
    : frame_(camera.config().frame),
      format_(std::string(encodingName(camera.encoding())) + "; jpeg compressed " +
              (channelsOf(camera.encoding()) == 1 ? "mono8" : "bgr8")),
      quality_(kQuality) {
  if (pluginIsThere(transport)) return;
  const auto& sensor = camera.config().sensor;
  if (sensor && sensor->jpeg_quality > 0) quality_ = sensor->jpeg_quality;
  publisher_ = node.advertise<sensor_msgs::CompressedImage>(image_topic + "/compressed", kNewest);
}

void CompressedPublisher::publish(const Image& image, const ros::Time& stamp) const {
  sensor_msgs::CompressedImage message;
  message.header.stamp = stamp;
  message.header.frame_id = frame_;
  message.format = format_;
  message.data = jpegOf(image, quality_);
  publisher_.publish(message);
}

}  // namespace aras_visual_servo_sim
