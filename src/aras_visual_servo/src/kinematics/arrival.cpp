#include "arrival.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "joint_wish.hpp"

namespace aras_visual_servo {
namespace {

using Vector6 = Arrival::Vector6;

/** Below this cosine the sine of the angle is too small to find the axis from it. */
constexpr double kNearHalfTurn = -0.9;
constexpr double kNoTurn = 1e-9;

double positionOf(const Vector6& pose) { return std::sqrt(pose[0] * pose[0] + pose[1] * pose[1] + pose[2] * pose[2]); }
/** A pose times a matrix, written out: Eigen's own sums depend on the width of the processor's registers. */
Vector6 transformed(const Arrival::Matrix6& matrix, const Vector6& pose) {
  Vector6 result;
  for (int i = 0; i < 6; ++i) {
    result[i] = 0.0;
    for (int j = 0; j < 6; ++j) result[i] += matrix(i, j) * pose[j];
  }
  return result;
}

/** The variances of the components of matrix * x, where x has this covariance. */
Vector6 varianceThrough(const Arrival::Matrix6& matrix, const Arrival::Matrix6& covariance) {
  Vector6 result;
  for (int i = 0; i < 6; ++i) {
    double sum = 0.0;
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k) sum += matrix(i, j) * covariance(j, k) * matrix(i, k);
    result[i] = std::max(sum, 0.0);
  }
  return result;
}

double rotationOf(const Vector6& pose) { return std::sqrt(pose[3] * pose[3] + pose[4] * pose[4] + pose[5] * pose[5]); }

}  // namespace

Vector6 between(const PoseRef& X_A, const PoseRef& X_B) {
  Eigen::Vector3d p;
  Eigen::Matrix3d R;  // written out: Eigen's own sums depend on the width of the processor's registers
  for (int i = 0; i < 3; ++i) {
    p[i] = 0.0;
    for (int k = 0; k < 3; ++k) p[i] += X_A(k, i) * (X_B(k, 3) - X_A(k, 3));
    for (int j = 0; j < 3; ++j) R(i, j) = X_A(0, i) * X_B(0, j) + X_A(1, i) * X_B(1, j) + X_A(2, i) * X_B(2, j);
  }
  Vector6 result;
  result << p, 0.5 * (R(2, 1) - R(1, 2)), 0.5 * (R(0, 2) - R(2, 0)), 0.5 * (R(1, 0) - R(0, 1));
  const double cosine = 0.5 * (R(0, 0) + R(1, 1) + R(2, 2) - 1.0), sine = rotationOf(result);
  if (cosine < kNearHalfTurn) {
    const Eigen::AngleAxisd turn(R);  // by way of the quaternion
    result.tail<3>() = turn.angle() * turn.axis();
  } else if (sine >= kNoTurn) {
    result.tail<3>() *= std::atan2(sine, cosine) / sine;
  }
  return result;
}

Arrival::Arrival(const Numbers& thresholds, std::int64_t hold_ns, std::int64_t kept_ns, const Limits& limits,
                 double sure, int taught_images, Model model)
    : thresholds_(thresholds),
      hold_ns_(hold_ns),
      kept_ns_(kept_ns),
      limits_(limits),
      sure_(sure),
      taught_images_(taught_images),
      model_(std::move(model)) {}

void Arrival::clear() {
  errors_.clear();
  seen_.clear();
}

std::pair<Arrival::Numbers, double> Arrival::features(std::int64_t stamp_ns, const Numbers& e, double tilt_rad,
                                                      const Eigen::Ref<const Vector6>& moved) {
  requireSize("e", static_cast<Eigen::Index>(e.size()), static_cast<Eigen::Index>(thresholds_.size()));
  errors_.push_back({stamp_ns, e, tilt_rad, moved});
  while (stamp_ns - errors_.front().stamp_ns > kept_ns_) errors_.pop_front();
  const auto first = std::find_if(errors_.begin(), errors_.end(),
                                  [&](const Errors& errors) { return stamp_ns - errors.stamp_ns <= hold_ns_; });
  double most = first->tilt_rad;
  Numbers parts(e.size(), 0.0);
  for (auto errors = first; errors != errors_.end(); ++errors) {
    for (std::size_t i = 0; i < parts.size(); ++i) parts[i] += errors->e[i];
    most = std::max(most, errors->tilt_rad);
  }
  const auto held = static_cast<double>(errors_.end() - first);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i] = std::abs(parts[i] / held) / thresholds_[i];
    if (!(parts[i] < 1.0)) parts[i] = std::min(parts[i], noisyPart(i, parts[i], held, moved));
  }
  return {parts, most / limits_.tilt_rad};
}

double Arrival::noisyPart(std::size_t i, double part, double held, const Vector6& moved) const {
  double sum = 0.0, squares = 0.0, count = 0.0, last = 0.0;
  for (const Errors& errors : errors_) {
    if (!isNear(errors.moved, moved)) continue;
    if (count > 0.0) squares += 0.5 * (errors.e[i] - last) * (errors.e[i] - last);
    last = errors.e[i];
    sum += last;
    count += 1.0;
  }
  if (count < 2.0) return part;
  // From image to image errors differ by noise; a mean is uncertain by its standard error.
  const double noise = sure_ * std::sqrt(squares / (count - 1.0)) / thresholds_[i];
  return std::max(std::abs(sum / count) / thresholds_[i] + noise / std::sqrt(count), part - noise / std::sqrt(held));
}

bool Arrival::isNear(const Vector6& place, const Vector6& moved) const {
  const Vector6 way = place - moved;
  return positionOf(way) < limits_.position_m && rotationOf(way) < limits_.rotation_rad;
}

Arrival::Place Arrival::place(std::int64_t stamp_ns, const Eigen::Ref<const Vector6>& moved,
                              const Eigen::Ref<const Vector6>& pose, double edge_variance) {
  seen_.push_back({stamp_ns, moved, pose - moved});
  while (stamp_ns - seen_.front().stamp_ns > kept_ns_) seen_.pop_front();

  // The mean of the images from whose place the camera has hardly moved, and its variance.
  std::vector<const Seen*> near;
  Vector6 mean = Vector6::Zero();
  for (const Seen& seen : seen_) {
    if (!isNear(seen.moved, moved)) continue;
    near.push_back(&seen);
    mean += seen.off;
  }
  const auto count = static_cast<double>(near.size());
  mean /= count;
  const double of_mean = sure_ * sure_ / count / count, of_goal = sure_ * sure_ / taught_images_ / count;

  Matrix6 squares = Matrix6::Zero();
  for (const Seen* seen : near)
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) squares(i, j) += (seen->off[i] - mean[i]) * (seen->off[j] - mean[j]);

  Place place{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < model_.planes.size(); ++k) {
    const Matrix6& plane = model_.planes[k];
    const Vector6 scatter = varianceThrough(plane, squares), noise = of_mean * scatter;
    // What differs between images of one place is noise, and so are the steps of grey levels then.
    const Vector6 edges =
        sure_ * sure_ *
        (edge_variance * varianceThrough(plane, model_.edges) - 0.5 * scatter / count).cwiseMax(Vector6::Zero());
    const Vector6 fixed = edges + of_goal * scatter, limits_met = fixed.cwiseSqrt();
    place.open = std::max(
        {place.open, positionOf(limits_met) / limits_.position_m, rotationOf(limits_met) / limits_.rotation_rad});
    for (const Seen& seen : seen_) {
      if (seen.stamp_ns < stamp_ns - hold_ns_) continue;
      const Vector6 where = transformed(plane, mean + seen.moved);
      const double off = std::max(positionOf(where) / limits_.position_m, rotationOf(where) / limits_.rotation_rad);
      place.off = std::max(place.off, off);
      const Vector6 by_images = (where.cwiseAbs2() + noise).cwiseSqrt();
      const Vector6 farthest = (where.cwiseAbs2() + noise + fixed).cwiseSqrt();
      const double position_m = positionOf(farthest), rotation_rad = rotationOf(farthest);
      place.known = std::max({place.known, position_m / limits_.position_m, rotation_rad / limits_.rotation_rad});
      if (&seen == &seen_.back()) {
        place.position_m = std::max(place.position_m, position_m);
        place.rotation_rad = std::max(place.rotation_rad, rotation_rad);
      }
      if (k > 0) continue;
      const Vector6 way = seen.moved - moved;
      place.moved =
          std::max({place.moved, positionOf(way) / limits_.position_m, rotationOf(way) / limits_.rotation_rad});
      place.position = std::max(place.position, positionOf(by_images) / limits_.position_m);
      place.turn = std::max(place.turn, rotationOf(by_images) / limits_.rotation_rad);
    }
  }
  return place;
}

}  // namespace aras_visual_servo
