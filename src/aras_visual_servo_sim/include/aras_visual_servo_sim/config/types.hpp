#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace aras_visual_servo_sim {

/** Twist stacked [v; w], 6 x 1, [m/s; rad/s]. The name says whose, seen from where, expressed in which frame. */
using Twist = Eigen::Matrix<double, 6, 1>;

/** Rigid transform X_AB: pose of frame B in frame A. p is p_AB [m], q is R_AB as a unit quaternion. */
struct Pose {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();

  /** X_AC = X_AB * X_BC. */
  Pose operator*(const Pose& X_BC) const { return Pose{p + q * X_BC.p, q * X_BC.q}; }

  /** p_A = X_AB * p_B. */
  Eigen::Vector3d operator*(const Eigen::Vector3d& p_B) const { return p + q * p_B; }

  /** X_BA. */
  Pose inverse() const {
    const Eigen::Quaterniond q_BA = q.conjugate();
    return Pose{-(q_BA * p), q_BA};
  }

  /** Homogeneous matrix, 4 x 4. */
  Eigen::Matrix4d matrix() const {
    Eigen::Matrix4d X = Eigen::Matrix4d::Identity();
    X.topLeftCorner<3, 3>() = q.toRotationMatrix();
    X.topRightCorner<3, 1>() = p;
    return X;
  }
};

/** Rotation from URDF's roll, pitch, yaw [rad]: R = Rz(yaw) Ry(pitch) Rx(roll). */
inline Eigen::Quaterniond quaternionFromRpy(const Eigen::Vector3d& rpy_rad) {
  return Eigen::AngleAxisd(rpy_rad.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(rpy_rad.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy_rad.x(), Eigen::Vector3d::UnitX());
}

/** Colour, each component in 0..1. */
struct Rgba {
  double r = 0.5, g = 0.5, b = 0.5, a = 1.0;
};

}  // namespace aras_visual_servo_sim
