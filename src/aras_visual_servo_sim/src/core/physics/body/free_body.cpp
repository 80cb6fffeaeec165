#include "free_body.hpp"

namespace aras_visual_servo_sim {

using Eigen::Vector3d;

namespace {

/** Principal moments of a uniform solid of mass 1. */
Vector3d unitMoments(const Geometry& geometry, const Vector3d& box) {
  const double r2 = geometry.radius_m * geometry.radius_m;
  if (geometry.type == Geometry::Type::kSphere) return Vector3d::Constant(0.4 * r2);
  if (geometry.type == Geometry::Type::kCylinder) {
    const double across = (3.0 * r2 + geometry.length_m * geometry.length_m) / 12.0;
    return {across, across, 0.5 * r2};
  }
  const Vector3d s = box.cwiseProduct(box);
  return Vector3d(s.y() + s.z(), s.x() + s.z(), s.x() + s.y()) / 12.0;
}

}  // namespace

FreeBody::FreeBody(const Obstacle& obstacle, const Vector3d& size_m)
    : mass_kg_(obstacle.mass_kg),
      moments_(obstacle.mass_kg * unitMoments(obstacle.geometry, size_m)),
      X_WB_(obstacle.X_WO) {}

void FreeBody::restore(const Pose& X_WB, const Twist& v) {
  X_WB_ = X_WB;
  v_ = v;
}

Eigen::Matrix3d FreeBody::inertia() const {
  const Eigen::Matrix3d R = X_WB_.q.toRotationMatrix();
  return R * moments_.asDiagonal() * R.transpose();
}

Twist FreeBody::freeVelocity(const Vector3d& gravity_m_s2, double dt_s) const {
  const Vector3d omega = v_.tail<3>();
  Twist f;
  f << mass_kg_ * gravity_m_s2, -omega.cross(inertia() * omega);
  return v_ + dt_s * answer(f);
}

Twist FreeBody::answer(const Twist& f) const {
  const Eigen::Matrix3d R = X_WB_.q.toRotationMatrix();
  Twist a;
  a << f.head<3>() / mass_kg_, R * (R.transpose() * f.tail<3>()).cwiseQuotient(moments_);
  return a;
}

void FreeBody::advance(const Twist& v, double dt_s) {
  v_ = v;
  X_WB_.p += dt_s * v.head<3>();
  const Vector3d turn = dt_s * v.tail<3>();
  const double angle = turn.norm();
  if (angle > 0.0) {
    X_WB_.q = (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * X_WB_.q).normalized();
  }
}

}  // namespace aras_visual_servo_sim
