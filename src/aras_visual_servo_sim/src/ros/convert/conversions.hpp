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
ros::Time toRosTime(std::int64_t time_ns);
std::int64_t toNanoseconds(const ros::Time& time);

geometry_msgs::Pose toMessage(const Pose& pose);
/** @throws ParameterError if the quaternion is not of unit length (within 1e-3) or anything is not finite. An all-zero
 *  quaternion, what an unset message carries, is taken as the identity. */
Pose fromMessage(const geometry_msgs::Pose& message);
/** @param V  twist stacked [v; w] */
geometry_msgs::Twist toMessage(const Twist& V);

/** Intrinsics; the header's stamp is left to the caller. */
sensor_msgs::CameraInfo toMessage(const CameraModel& camera);

}  // namespace aras_visual_servo_sim
