#include "twist_inverse.hpp"

#include <algorithm>
#include <aras_visual_servo_common/errors.hpp>
#include <cmath>
#include <limits>
#include <string>

#include "joint_wish.hpp"

extern "C" void dgesdd_(const char* jobz, const int* m, const int* n, double* a, const int* lda, double* s, double* u,
                        const int* ldu, double* vt, const int* ldvt, double* work, const int* lwork, int* iwork,
                        int* info);

namespace aras_visual_servo {
namespace {

using aras_visual_servo_common::NotFiniteError;
using aras_visual_servo_common::ShapeError;

constexpr int kRows = 6;

/** Sum of the products, in the order of the terms: Eigen's own sums depend on the width of the processor's registers.
 */
template <typename A, typename B>
double inOrder(const A& a, const B& b) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < b.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

TwistInverse::TwistInverse(const TwistRef& rows, const VectorRef& ease, const JacobianRef& jacobian)
    : rows_(rows), ease_(ease) {
  if (jacobian.cols() != ease.size() || ease.size() == 0)
    throw ShapeError("jacobian: " + std::to_string(jacobian.cols()) + " columns, expected " +
                     std::to_string(ease.size()));
  const int n = static_cast<int>(ease.size()), least = std::min(kRows, n);
  Eigen::MatrixXd scaled(kRows, n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < kRows; ++i) scaled(i, j) = jacobian(i, j) * (rows[i] * ease[j]);
  if (!scaled.allFinite()) throw NotFiniteError("jacobian: found an entry that is not finite, allowed finite numbers");

  sigmas_.resize(least);
  Vt_.resize(n, n);
  std::vector<int> whole(8 * least);
  int info = 0;
  const auto decompose = [&](double* work, int size) {
    dgesdd_("A", &kRows, &n, scaled.data(), &kRows, sigmas_.data(), U_.data(), &kRows, Vt_.data(), &n, work, &size,
            whole.data(), &info);
  };
  // How much room it wants depends on n alone: it is asked once.
  thread_local int asked_for = 0;
  thread_local std::vector<double> work;
  if (asked_for != n) {
    double wanted = 0.0;
    decompose(&wanted, -1);
    work.resize(static_cast<std::size_t>(wanted));
    asked_for = n;
  }
  decompose(work.data(), static_cast<int>(work.size()));
  if (info != 0) throw NotFiniteError("jacobian: its singular values were not found");
}

void TwistInverse::damp(const std::vector<double>& damping2, double threshold, double free_below, double rounding) {
  const auto count = static_cast<Eigen::Index>(sigmas_.size());
  requireSize("damping2", static_cast<Eigen::Index>(damping2.size()), count);
  gains_ = Vector::Zero(count);
  kept_ = Vector::Zero(kRows);
  free_ = Vector::Ones(ease_.size());
  manipulability_ = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < count; ++i) {
    const double sigma = sigmas_[i], lambda2 = damping2[i];
    if (lambda2 == 0.0 && sigma > rounding) {
      gains_[i] = 1.0 / sigma;
      kept_[i] = 1.0;
      free_[i] = 0.0;
    } else {
      gains_[i] = lambda2 > 0.0 ? sigma / (sigma * sigma + lambda2) : 0.0;
      kept_[i] = gains_[i] * sigma;
      const double part = sigma / free_below, rest = 1.0 - part * part;
      free_[i] = sigma >= free_below ? 0.0 : rest * rest;
    }
    if (sigma >= threshold) {
      manipulability_ = sigma;
    } else if (U_(3, i) * U_(3, i) + U_(4, i) * U_(4, i) < 0.5) {
      manipulability_ = std::min(manipulability_, sigma);
    }
  }
}

TwistInverse::Vector TwistInverse::inDirections(const TwistRef& twist, Eigen::Index count) const {
  const Twist scaled = rows_.cwiseProduct(twist);
  Vector y(count);
  for (Eigen::Index i = 0; i < count; ++i) y[i] = inOrder(scaled, U_.col(i));
  return y;
}

TwistInverse::Vector TwistInverse::toJoints(const Vector& y) const {
  Vector joints(ease_.size());
  for (Eigen::Index j = 0; j < joints.size(); ++j) joints[j] = ease_[j] * inOrder(y, Vt_.col(j).head(y.size()));
  return joints;
}

TwistInverse::Twist TwistInverse::toTwist(const Vector& y) const {
  Twist twist;
  for (Eigen::Index i = 0; i < kRows; ++i) twist[i] = inOrder(U_.row(i), y) / rows_[i];
  return twist;
}

TwistInverse::Vector TwistInverse::ofJoints(const VectorRef& wish) const {
  requireSize("joint velocities", wish.size(), ease_.size());
  const Vector eased = wish.cwiseQuotient(ease_);
  Vector y(eased.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) y[i] = inOrder(Vt_.row(i), eased);
  return y;
}

TwistInverse::Vector TwistInverse::jointVelocity(const TwistRef& twist) const {
  return toJoints(gains_.cwiseProduct(inDirections(twist, gains_.size())));
}

TwistInverse::Twist TwistInverse::achieved(const TwistRef& twist) const {
  return toTwist(kept_.cwiseProduct(inDirections(twist, kRows)));
}

double TwistInverse::lost(const TwistRef& twist) const {
  const Vector missed = (1.0 - kept_.array()).matrix().cwiseProduct(inDirections(twist, kRows));
  return std::sqrt(inOrder(missed, missed));
}

TwistInverse::Twist TwistInverse::turnAbout(const Eigen::Vector2d& turn, const Eigen::Vector3d& p_C) const {
  Twist twist = Twist::Zero();
  twist.segment<2>(3) = turn;
  const Twist done = achieved(twist);
  const double wx = done[3], wy = done[4];
  twist << -wy * p_C.z(), wx * p_C.z(), wy * p_C.x() - wx * p_C.y(), wx, wy, 0.0;  // v = -w x p
  return twist;
}

TwistInverse::Vector TwistInverse::turning(const JacobianRef& jacobian, const JacobianRef& half_way,
                                           const VectorRef& q_dot, double most_part) const {
  requireSize("joint velocities", q_dot.size(), ease_.size());
  if (jacobian.cols() != q_dot.size() || half_way.cols() != q_dot.size())
    throw ShapeError("jacobian: " + std::to_string(jacobian.cols()) + " and " + std::to_string(half_way.cols()) +
                     " columns, expected " + std::to_string(q_dot.size()));
  Twist change;
  for (int row = 0; row < kRows; ++row) {
    change[row] = 0.0;
    for (Eigen::Index j = 0; j < q_dot.size(); ++j) change[row] += (jacobian(row, j) - half_way(row, j)) * q_dot[j];
  }
  Vector correction = jointVelocity(change);
  const double most = most_part * std::sqrt(inOrder(q_dot, q_dot)), size = std::sqrt(inOrder(correction, correction));
  if (size > most) correction *= most / size;
  return correction;
}

TwistInverse::Vector TwistInverse::free(const VectorRef& wish) const {
  return toJoints(free_.cwiseProduct(ofJoints(wish)));
}

TwistInverse::Vector TwistInverse::nullPart(const VectorRef& q_dot) const {
  Vector y = ofJoints(q_dot);
  for (Eigen::Index i = 0; i < y.size(); ++i) y[i] = free_[i] > 0.0 ? y[i] : 0.0;
  return toJoints(y);
}

TwistInverse::Vector TwistInverse::freeOfNorm(const VectorRef& wish, const TwistRef& twist) const {
  requireSize("joint velocities", wish.size(), ease_.size());
  const Vector eased = wish.cwiseQuotient(ease_);
  Vector y = inDirections(twist, static_cast<Eigen::Index>(sigmas_.size()));
  for (Eigen::Index i = 0; i < y.size(); ++i) y[i] *= sigmas_[i];
  Vector along(eased.size());  // J^T e
  for (Eigen::Index j = 0; j < along.size(); ++j) along[j] = inOrder(y, Vt_.col(j).head(y.size()));
  const double size2 = inOrder(along, along);
  if (!(size2 > 0.0)) return ease_.cwiseProduct(eased);
  return ease_.cwiseProduct(eased - along * (inOrder(along, eased) / size2));
}

double TwistInverse::size(const TwistRef& twist) const {
  const Twist scaled = rows_.cwiseProduct(twist);
  return std::sqrt(inOrder(scaled, scaled));
}

TwistTranspose::Vector TwistTranspose::joints(const TwistRef& twist) const {
  const Eigen::Map<const Vector> sigmas(sigmas_.data(), static_cast<Eigen::Index>(sigmas_.size()));
  const Vector y = inDirections(twist, sigmas.size()), z = sigmas.cwiseProduct(sigmas).cwiseProduct(y);
  const double size2 = inOrder(z, z), alpha = size2 > 0.0 ? inOrder(z, y) / size2 : 0.0;
  return (alpha * sigmas).cwiseProduct(y);
}

TwistTranspose::Vector TwistTranspose::jointVelocity(const TwistRef& twist) const { return toJoints(joints(twist)); }

TwistTranspose::Twist TwistTranspose::achieved(const TwistRef& twist) const {
  const Eigen::Map<const Vector> sigmas(sigmas_.data(), static_cast<Eigen::Index>(sigmas_.size()));
  return toTwist(sigmas.cwiseProduct(joints(twist)));
}

double TwistTranspose::lost(const TwistRef& twist) const { return size(twist - achieved(twist)); }

}  // namespace aras_visual_servo
