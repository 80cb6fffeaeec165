#include "conversions.hpp"

#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <array>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {

CameraIntrinsics toIntrinsics(const sensor_msgs::CameraInfo& info) {
  if (info.binning_x > 1 || info.binning_y > 1)
    throw ParameterError("camera_info.binning: found " + std::to_string(info.binning_x) + " x " +
                         std::to_string(info.binning_y) + ", allowed 0 or 1");
  const auto& roi = info.roi;
  const bool whole = (roi.width == 0 || roi.width == info.width) && (roi.height == 0 || roi.height == info.height);
  if (roi.x_offset != 0 || roi.y_offset != 0 || !whole)
    throw ParameterError("camera_info.roi: found a part of the image, allowed the whole image");
  std::array<double, 9> K;
  std::copy(info.K.begin(), info.K.end(), K.begin());
  return CameraIntrinsics(static_cast<int>(info.width), static_cast<int>(info.height), K, info.distortion_model,
                          info.D);
}

ImageView toView(const sensor_msgs::Image& image) {
  const PixelFormat format = formatNamed(image.encoding);
  if (isDeep(format) && (image.is_bigendian || image.step % 2 != 0))
    throw ShapeError("image: found is_bigendian " + std::to_string(image.is_bigendian) + " and rows of " +
                     std::to_string(image.step) + " bytes, allowed 0 and an even number with " + image.encoding);
  const std::size_t row = static_cast<std::size_t>(image.width) * bytesOf(format);
  if (image.step < row || image.data.size() < static_cast<std::size_t>(image.step) * image.height)
    throw ShapeError("image: found " + std::to_string(image.data.size()) + " bytes in rows of " +
                     std::to_string(image.step) + ", allowed at least " + std::to_string(row * image.height));
  return {image.data.data(), static_cast<int>(image.width), static_cast<int>(image.height), image.step, format};
}

DepthView toDepthView(const sensor_msgs::Image& image) {
  namespace enc = sensor_msgs::image_encodings;
  const bool millimetres = image.encoding == enc::TYPE_16UC1 || image.encoding == enc::MONO16;
  if (!millimetres && image.encoding != enc::TYPE_32FC1)
    throw ShapeError("depth image encoding: found '" + image.encoding + "', allowed 32FC1 [m], 16UC1 [mm]");
  const std::size_t row = static_cast<std::size_t>(image.width) * (millimetres ? 2 : 4);
  if (image.is_bigendian || image.step < row || image.data.size() < static_cast<std::size_t>(image.step) * image.height)
    throw ShapeError("depth image: found is_bigendian " + std::to_string(image.is_bigendian) + " and " +
                     std::to_string(image.data.size()) + " bytes in rows of " + std::to_string(image.step) +
                     ", allowed 0 and at least " + std::to_string(row * image.height));
  return {image.data.data(), static_cast<int>(image.width), static_cast<int>(image.height), image.step, millimetres};
}

// One field of a message. @see the lists beside the structs
#define ARAS_COPY(field) msg.field = f.field;

aras_visual_servo_msgs::MomentFeatures toMessage(const MomentFeatures& f) {
  aras_visual_servo_msgs::MomentFeatures msg;
  ARAS_MOMENT_FIELDS(ARAS_COPY)
  return msg;
}

aras_visual_servo_msgs::PhotometricFeatures toMessage(const PhotometricFeatures& f) {
  aras_visual_servo_msgs::PhotometricFeatures msg;
  ARAS_PHOTOMETRIC_FIELDS(ARAS_COPY)
  return msg;
}

aras_visual_servo_msgs::MatchFeatures toMessage(const MatchFeatures& f) {
  aras_visual_servo_msgs::MatchFeatures msg;
  ARAS_MATCH_FIELDS(ARAS_COPY)
  return msg;
}

aras_visual_servo_msgs::TagFeatures toMessage(const TagFeatures& f) {
  aras_visual_servo_msgs::TagFeatures msg;
  ARAS_TAG_FIELDS(ARAS_COPY)
  return msg;
}

}  // namespace aras_visual_servo_camera
