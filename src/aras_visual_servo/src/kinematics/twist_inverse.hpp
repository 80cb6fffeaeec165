#pragma once

#include <Eigen/Core>
#include <vector>

namespace aras_visual_servo {

/** Damped inverse of one Jacobian J_BC_C, (6, n), rows [v; w]: from camera twists to joint velocities.
 *
 *  The Jacobian is scaled, rows by `rows`, columns by `ease`, and taken apart into singular directions (LAPACK's
 * dgesdd). Sums are taken in the order of their terms and nothing depends on the processor, so that equal inputs give
 * equal bytes. */
class TwistInverse {
 public:
  using Vector = Eigen::VectorXd;
  using Twist = Eigen::Matrix<double, 6, 1>;
  using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;
  using JacobianRef = Eigen::Ref<const Jacobian, 0, Eigen::OuterStride<>>;
  using VectorRef = Eigen::Ref<const Vector>;
  using TwistRef = Eigen::Ref<const Twist>;

  /** @param rows  6 factors of the twist.  @param ease  n, of the joints: 1 / the cost of moving each
   *  @throws ShapeError, NotFiniteError */
  TwistInverse(const TwistRef& rows, const VectorRef& ease, const JacobianRef& jacobian);
  virtual ~TwistInverse() = default;

  /** min(6, n) singular values of the scaled Jacobian, the largest first. */
  const std::vector<double>& sigmas() const { return sigmas_; }

  /** Has to be called once before anything below: which direction is damped, and by how much.
   *  @param damping2  lambda^2 of each direction: its gain is sigma / (sigma^2 + lambda^2)
   *  @param threshold  a tilt direction below it does not count for the manipulability
   *  @param free_below  directions with a singular value below it become free, smoothly
   *  @param rounding  a singular value up to it is never inverted
   *  @throws ShapeError */
  void damp(const std::vector<double>& damping2, double threshold, double free_below, double rounding);

  /** Smallest singular value, without a tilt direction below the threshold. */
  double manipulability() const { return manipulability_; }

  /** Joint velocities of a twist, n. */
  virtual Vector jointVelocity(const TwistRef& twist) const;
  /** The part of a twist that jointVelocity() achieves. */
  virtual Twist achieved(const TwistRef& twist) const;
  /** Norm of the part of a twist that is not achieved, in scaled rows. */
  virtual double lost(const TwistRef& twist) const;
  /** The achieved part of a turn about the camera's x and y, with the translation that keeps a point where it is.
   *  @param turn  w_x, w_y [rad/s].  @param p_C  the point in the camera frame [m] */
  Twist turnAbout(const Eigen::Vector2d& turn, const Eigen::Vector3d& p_C) const;
  /** What has to be added to q_dot, which was found with `jacobian`, so that the twist is right with the Jacobian
   *  `half_way`. Its norm is at most `most_part` of that of q_dot. */
  Vector turning(const JacobianRef& jacobian, const JacobianRef& half_way, const VectorRef& q_dot,
                 double most_part) const;
  /** The part of joint velocities that does not move the camera. */
  Vector free(const VectorRef& wish) const;
  /** The part of joint velocities along the directions that count as free: the null space. */
  Vector nullPart(const VectorRef& q_dot) const;
  /** The part of `wish` that does not change how fast the distance to the goal shrinks (T41): all but the part along
   *  J^T twist, since the law's twist is the remaining displacement times the gain. */
  Vector freeOfNorm(const VectorRef& wish, const TwistRef& twist) const;
  /** Norm of a twist in scaled rows. */
  double size(const TwistRef& twist) const;

 protected:
  /** (rows * twist) in the first `count` left singular directions. */
  Vector inDirections(const TwistRef& twist, Eigen::Index count) const;
  /** ease * (sum of y_i times right singular direction i). */
  Vector toJoints(const Vector& y) const;
  /** (sum of y_i times left singular direction i) / rows. */
  Twist toTwist(const Vector& y) const;

  std::vector<double> sigmas_;

 private:
  /** The wish in the right singular directions. */
  Vector ofJoints(const VectorRef& wish) const;

  Twist rows_;
  Vector ease_;
  Eigen::Matrix<double, 6, 6> U_;
  Eigen::MatrixXd Vt_;  // (n, n)
  Vector gains_, kept_, free_;
  double manipulability_ = 0.0;
};

/** q_dot = alpha J^T V, with the alpha that fits this V best. It is never unbounded, but the camera moves along V only
 *  where J is well-conditioned. */
class TwistTranspose : public TwistInverse {
 public:
  using TwistInverse::TwistInverse;
  Vector jointVelocity(const TwistRef& twist) const override;
  Twist achieved(const TwistRef& twist) const override;
  double lost(const TwistRef& twist) const override;

 private:
  Vector joints(const TwistRef& twist) const;
};

}  // namespace aras_visual_servo
