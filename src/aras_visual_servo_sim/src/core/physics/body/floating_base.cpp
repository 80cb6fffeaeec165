#include "floating_base.hpp"

namespace aras_visual_servo_sim {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

Matrix3d cross(const Vector3d& a) {
  Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

}  // namespace

FloatingBase::FloatingBase(double mass_kg, const Vector3d& com_m, const Matrix3d& inertia_kg_m2, int joints)
    : mass_kg_(mass_kg), com_m_(com_m), inertia_kg_m2_(inertia_kg_m2), M_bj_(6, joints), response_(6, joints) {}

void FloatingBase::place(const Pose& X_WB) { restore({X_WB.p, X_WB.q.normalized()}, v_); }

void FloatingBase::restore(const Pose& X_WB, const Twist& v) {
  p_ = X_WB.p;
  q_ = X_WB.q;
  R_ = q_.toRotationMatrix();
  v_ = v;
}

void FloatingBase::setColumn(int index, const Vector3d& P, const Vector3d& L) {
  M_bj_.col(index) << P, L - com().cross(P);
}

void FloatingBase::eliminate(double mass, const Vector3d& first, const Matrix3d& second, std::vector<double>& M) {
  // About the centre of mass of the base: itself, and the rest moved there from the world origin.
  const Vector3d c = com();
  const Vector3d moment = first - mass * c;
  const Matrix3d S = cross(c);
  const Matrix3d F = cross(first);
  M_bb_.topLeftCorner<3, 3>() = (mass_kg_ + mass) * Matrix3d::Identity();
  M_bb_.topRightCorner<3, 3>() = -cross(moment);
  M_bb_.bottomLeftCorner<3, 3>() = cross(moment);
  M_bb_.bottomRightCorner<3, 3>() = R_ * inertia_kg_m2_ * R_.transpose() + second + S * F + F * S - mass * S * S;
  response_ = M_bj_;
  factor_.compute(M_bb_);
  if (response_.cols() > 0) factor_.solveInPlace(response_);  // Eigen takes the address of the first element
  const int n = static_cast<int>(M_bj_.cols());
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      const double taken = M_bj_.col(i).dot(response_.col(j));
      M[i * n + j] -= taken;
      if (i != j) M[j * n + i] -= taken;
    }
  }
}

void FloatingBase::advance(const Eigen::VectorXd& v, const Eigen::VectorXd& v_free, double dt_s) {
  v_ = v_free_;
  for (int i = 0; i < v.size(); ++i) v_ -= (v[i] - v_free[i]) * response_.col(i);
  const Vector3d c = com() + dt_s * v_.head<3>();
  const Vector3d turn = dt_s * v_.tail<3>();
  const double angle = turn.norm();
  if (angle > 0.0) q_ = (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * q_).normalized();
  R_ = q_.toRotationMatrix();
  p_ = c - R_ * com_m_;
}

double FloatingBase::kineticEnergy(const Eigen::VectorXd& v) const {
  const Twist moved = v_ + response_ * v;
  return 0.5 * moved.dot(M_bb_ * moved);
}

}  // namespace aras_visual_servo_sim
