#pragma once

#include <Eigen/Core>
#include <vector>

#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** Eliminates mimic joints: the joints that move on their own are the coordinates q_c, and q = K q_c + c (T49).
 *
 *  A follower's inertia, weight, damping and friction act on the coordinate through its multiplier. Without mimic
 *  joints coordinate i is joint i. Vectors of joints: RobotModel::joint_names order; of coordinates: the same without
 *  the followers. */
class JointCoupling {
 public:
  explicit JointCoupling(const RobotModel& model);

  bool any() const { return coordinates() < static_cast<int>(coordinate_.size()); }
  int coordinates() const { return static_cast<int>(joint_.size()); }
  int joint(int coordinate) const { return joint_[coordinate]; }
  int coordinate(int joint) const { return coordinate_[joint]; }
  bool follows(int joint) const { return joint_[coordinate_[joint]] != joint; }

  /** The joint of a coordinate, with the damping and friction of its followers. */
  Joint driven(const RobotModel& model, int coordinate) const;

  /** Position a joint has at the positions of the others. */
  double position(int joint, const Eigen::VectorXd& q) const;
  /** Adds a row over the joints' velocities, entry by entry, to one over the coordinates'. */
  template <typename Row>
  void add(int joint, double entry, Row&& row) const {
    row[coordinate_[joint]] += multiplier_[joint] * entry;
  }
  /** Sets the entries of the followers from those of the joints they follow. */
  void complete(Eigen::VectorXd& q, Eigen::VectorXd& v) const;

  /** Inertia of the coordinates, K^T M K, and the velocities they would have without any effort but that of the
   *  coupling: M_c v_c = K^T M v_free. Row-major. */
  void reduce(const std::vector<double>& M, const Eigen::VectorXd& v_free, std::vector<double>& M_c,
              Eigen::VectorXd& v_free_c);

 private:
  std::vector<int> joint_, coordinate_;
  std::vector<double> multiplier_, offset_;  // by joint
  Eigen::MatrixXd dense_;
};

}  // namespace aras_visual_servo_sim
