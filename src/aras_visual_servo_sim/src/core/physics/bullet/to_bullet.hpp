#pragma once

#include <LinearMath/btTransform.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** Vectors, rotations and poses as Bullet has them. */
inline btVector3 toBullet(const Eigen::Vector3d& v) { return btVector3(v.x(), v.y(), v.z()); }

inline btQuaternion toBullet(const Eigen::Quaterniond& q) { return btQuaternion(q.x(), q.y(), q.z(), q.w()); }

inline btTransform toBullet(const Pose& X) { return btTransform(toBullet(X.q), toBullet(X.p)); }

}  // namespace aras_visual_servo_sim
