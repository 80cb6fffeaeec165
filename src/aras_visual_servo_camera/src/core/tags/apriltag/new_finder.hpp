#pragma once

#include "tags/tag_finder.hpp"

namespace aras_visual_servo_camera {

/** The function kNewAprilTagFinder of the library kAprilTagLibrary: it makes a finder of the tags of a family. The
 * caller deletes it. */
using NewAprilTagFinder = TagFinder*(const char* family);

constexpr const char* kAprilTagLibrary = "libaras_visual_servo_camera_apriltag.so";
constexpr const char* kNewAprilTagFinder = "aras_visual_servo_camera_new_apriltag_finder";

}  // namespace aras_visual_servo_camera
