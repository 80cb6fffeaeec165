#pragma once

#include "tags/tag_finder.hpp"

namespace aras_visual_servo_camera {

/** What the library kAprilTagLibrary has under the name kNewAprilTagFinder: makes a finder of the tags of a family. */
using NewAprilTagFinder = TagFinder*(const char* family);

constexpr const char* kAprilTagLibrary = "libaras_visual_servo_camera_apriltag.so";
constexpr const char* kNewAprilTagFinder = "aras_visual_servo_camera_new_apriltag_finder";

}  // namespace aras_visual_servo_camera
