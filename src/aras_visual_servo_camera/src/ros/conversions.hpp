#pragma once

#include <aras_visual_servo_msgs/MatchFeatures.h>
#include <aras_visual_servo_msgs/MomentFeatures.h>
#include <aras_visual_servo_msgs/PhotometricFeatures.h>
#include <aras_visual_servo_msgs/TagFeatures.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/matching/match_features.hpp"
#include "aras_visual_servo_camera/moments/moment_features.hpp"
#include "aras_visual_servo_camera/photometric/photometric_features.hpp"
#include "aras_visual_servo_camera/tags/tag_features.hpp"

namespace aras_visual_servo_camera {

/** @throws ParameterError  see intrinsicsOf */
CameraIntrinsics toIntrinsics(const sensor_msgs::CameraInfo& info);

/** A view into the message. @throws ShapeError for an encoding that formatNamed refuses, or too few bytes */
ImageView toView(const sensor_msgs::Image& image);

/** A view into a depth image. @throws ShapeError for an encoding other than 32FC1 and 16UC1, upper bytes first, or too
 *  few bytes */
DepthView toDepthView(const sensor_msgs::Image& image);

/** Everything but header and age_s. */
aras_visual_servo_msgs::MomentFeatures toMessage(const MomentFeatures& features);
aras_visual_servo_msgs::PhotometricFeatures toMessage(const PhotometricFeatures& features);
aras_visual_servo_msgs::MatchFeatures toMessage(const MatchFeatures& features);
aras_visual_servo_msgs::TagFeatures toMessage(const TagFeatures& features);

}  // namespace aras_visual_servo_camera
