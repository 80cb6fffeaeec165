#include "joint_coupling.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace aras_visual_servo_sim {

JointCoupling::JointCoupling(const RobotModel& model)
    : coordinate_(model.dofs()), multiplier_(model.dofs(), 1.0), offset_(model.dofs(), 0.0) {
  for (int i = 0; i < model.dofs(); ++i) {
    if (model.movingJoint(i).mimic.joint >= 0) continue;
    coordinate_[i] = coordinates();
    joint_.push_back(i);
  }
  for (int i = 0; i < model.dofs(); ++i) {
    const Mimic& mimic = model.movingJoint(i).mimic;
    if (mimic.joint < 0) continue;
    coordinate_[i] = coordinate_[model.joints[mimic.joint].index];
    multiplier_[i] = mimic.multiplier;
    offset_[i] = mimic.offset;
  }
  dense_.resize(coordinates(), coordinates());
}

Joint JointCoupling::driven(const RobotModel& model, int coordinate) const {
  Joint joint = model.movingJoint(joint_[coordinate]);
  for (int i = 0; i < model.dofs(); ++i) {
    if (coordinate_[i] != coordinate || !follows(i)) continue;
    joint.damping += multiplier_[i] * multiplier_[i] * model.movingJoint(i).damping;
    const double size = std::abs(multiplier_[i]);
    joint.friction += size * model.movingJoint(i).friction;
    for (const Stribeck& each : model.movingJoint(i).stribeck) {
      if (size > 0.0) joint.stribeck.push_back({size * each.excess, each.velocity / size});
    }
  }
  return joint;
}

double JointCoupling::position(int joint, const Eigen::VectorXd& q) const {
  return follows(joint) ? multiplier_[joint] * q[joint_[coordinate_[joint]]] + offset_[joint] : q[joint];
}

void JointCoupling::complete(Eigen::VectorXd& q, Eigen::VectorXd& v) const {
  for (int i = 0; i < q.size(); ++i) {
    if (!follows(i)) continue;
    q[i] = position(i, q);
    v[i] = multiplier_[i] * v[joint_[coordinate_[i]]];
  }
}

void JointCoupling::reduce(const std::vector<double>& M, const Eigen::VectorXd& v_free, std::vector<double>& M_c,
                           Eigen::VectorXd& v_free_c) {
  const int n = static_cast<int>(coordinate_.size());
  const int m = coordinates();
  dense_.setZero();
  v_free_c.setZero();
  for (int i = 0; i < n; ++i) {
    const int a = coordinate_[i];
    for (int j = 0; j < n; ++j) {
      const double weighted = multiplier_[i] * M[i * n + j];
      dense_(a, coordinate_[j]) += weighted * multiplier_[j];
      v_free_c[a] += weighted * v_free[j];
    }
  }
  for (int a = 0; a < m; ++a) {
    for (int b = 0; b < m; ++b) M_c[a * m + b] = dense_(a, b);
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense_);  // in place: nothing is allocated
  factor.solveInPlace(v_free_c);
}

}  // namespace aras_visual_servo_sim
