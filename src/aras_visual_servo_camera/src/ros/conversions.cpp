#include "conversions.hpp"

#include <sensor_msgs/image_encodings.h>

#include <algorithm>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/config/sections.hpp"

namespace aras_visual_servo_camera {

namespace {

/** Requires that rows hold their pixels and the message its rows, of which the last may end with its pixels. */
void requireBytes(const std::string& what, const sensor_msgs::Image& image, std::size_t bytes_per_pixel) {
  const std::size_t row = image.width * bytes_per_pixel;
  if (image.step < row)
    throw ShapeError(what + ".step: found " + std::to_string(image.step) + " bytes a row, allowed at least " +
                     std::to_string(row) + " for " + std::to_string(image.width) + " pixels of " + image.encoding);
  const std::size_t least = image.height == 0 ? 0 : std::size_t{image.step} * (image.height - 1) + row;
  if (image.data.size() < least)
    throw ShapeError(what + ".data: found " + std::to_string(image.data.size()) + " bytes, allowed at least " +
                     std::to_string(least) + ": " + std::to_string(image.height) + " rows of " +
                     std::to_string(image.step) + ", the last of them at least " + std::to_string(row));
}

}  // namespace

CameraIntrinsics toIntrinsics(const sensor_msgs::CameraInfo& info) {
  // What no image can have becomes a number that the core refuses.
  const auto whole = [](std::uint32_t number) { return static_cast<int>(std::min<std::uint32_t>(number, 1u << 30)); };
  CameraInfoConfig fields;
  fields.width = whole(info.width);
  fields.height = whole(info.height);
  std::copy(info.K.begin(), info.K.end(), fields.K.begin());
  fields.distortion_model = info.distortion_model;
  fields.D = info.D;
  fields.binning_x = whole(info.binning_x);
  fields.binning_y = whole(info.binning_y);
  fields.roi.x_offset = whole(info.roi.x_offset);
  fields.roi.y_offset = whole(info.roi.y_offset);
  fields.roi.width = whole(info.roi.width);
  fields.roi.height = whole(info.roi.height);
  return intrinsicsOf(fields);
}

ImageView toView(const sensor_msgs::Image& image) {
  const PixelFormat format = formatNamed(image.encoding);
  requireBytes("image", image, bytesOf(format));
  return {image.data.data(),      static_cast<int>(image.width), static_cast<int>(image.height), image.step, format,
          image.is_bigendian != 0};
}

DepthView toDepthView(const sensor_msgs::Image& image) {
  namespace enc = sensor_msgs::image_encodings;
  const bool millimetres = image.encoding == enc::TYPE_16UC1 || image.encoding == enc::MONO16;
  if (!millimetres && image.encoding != enc::TYPE_32FC1)
    throw ShapeError("depth image encoding: found '" + image.encoding + "', allowed 32FC1 [m], 16UC1 [mm]");
  if (image.is_bigendian)
    throw ShapeError("depth image: found is_bigendian " + std::to_string(image.is_bigendian) + ", allowed 0");
  requireBytes("depth image", image, millimetres ? 2 : 4);
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
