#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>
#include <ros/time.h>
#include <sensor_msgs/CameraInfo.h>

#include <cstdint>
#include <string>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** Frame id of the world frame W, whatever the robot's root link is called. */
inline const std::string kWorldFrame = "world";

/** Simulated nanoseconds since the last reset, as a ROS time and back. */
inline ros::Time toRosTime(std::int64_t time_ns) { return ros::Time().fromNSec(static_cast<std::uint64_t>(time_ns)); }
inline std::int64_t toNanoseconds(const ros::Time& time) { return static_cast<std::int64_t>(time.toNSec()); }

geometry_msgs::Pose toMessage(const Pose& pose);
/** What an all-zero quaternion is, which an unset message carries. */
enum class Unset { kIdentity, kRefused };

/** @throws ParameterError if the quaternion is not of unit length (within 1e-3), the position too far away, or anything
 *  not finite */
Pose fromMessage(const geometry_msgs::Pose& message, Unset unset);
/** @param V  twist stacked [v; w] */
geometry_msgs::Twist toMessage(const Twist& V);

/** Intrinsics; the header's stamp is left to the caller. */
sensor_msgs::CameraInfo toMessage(const CameraModel& camera);

}  // namespace aras_visual_servo_sim
