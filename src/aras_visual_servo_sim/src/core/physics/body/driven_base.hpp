#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/archive.hpp"
#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** A body that has a pose and moves exactly with the twist it is told: a perfect positioning device, without inertia.
 *
 *  Six entries of joint vectors speak of it, `coordinates`. As positions they are the place p_WB [m] and the rotation
 *  vector of R_WB [rad], of length at most pi; as velocities the twist V_WB_B in the body's own axes, [v; w]. So the
 *  velocities are not the derivatives of the positions: the rotation vector only writes the attitude down. The
 *  attitude itself is a unit quaternion, and a step multiplies the pose by the exponential of the twist, so that no
 *  attitude is special. */
class DrivenBase {
 public:
  using Coordinates = Eigen::Matrix<double, 6, 1>;

  /** px, py, pz, rx, ry, rz: sorted, as all names of joint vectors. */
  static const std::vector<std::string>& coordinates();
  /** Index into coordinates(). @throws UnknownNameError */
  static int index(const std::string& coordinate);

  /** Puts it there, at rest. */
  void place(const Pose& X_WB);
  /** The same by coordinates; those not named stay. */
  void place(const std::map<int, double>& positions);

  /** Entries of the twist from now on; those not named stay. @param expiry_tick  from then on the twist is zero */
  void command(const std::map<int, double>& velocities, std::int64_t now_tick, std::int64_t expiry_tick);

  /** Moves on by one period, which begins at a tick. */
  void step(std::int64_t tick, double dt_s);

  const Pose& pose() const { return X_WB_; }
  /** V_WB_B of the last step, zero after place(). */
  const Twist& twist() const { return moved_; }
  Coordinates positions() const;

  /** Reads or writes the whole state. */
  void visit(Archive& archive) { archive(X_WB_, told_, moved_, expiry_tick_); }

 private:
  Pose X_WB_;
  Twist told_ = Twist::Zero(), moved_ = Twist::Zero();
  std::int64_t expiry_tick_ = 0;
};

/** X_AB of a twist V_AB_B held for one second from A = B on. */
Pose exponential(const Twist& V);

/** Rotation vector of a unit quaternion [rad], of length at most pi, and back. */
Eigen::Vector3d rotationVector(const Eigen::Quaterniond& q);
Eigen::Quaterniond quaternionFromVector(const Eigen::Vector3d& rotation_vector);

}  // namespace aras_visual_servo_sim
