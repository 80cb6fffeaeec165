// The half of CameraModel that takes points to pixels and pixels to rays.
#include <algorithm>
#include <aras_visual_servo_common/increasing_root.hpp>
#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

using aras_visual_servo_common::increasingRoot;
using aras_visual_servo_common::ValueAndSlope;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargestRadius = 1e3;  // 89.94 degrees off the axis: no polynomial lens sees farther

}  // namespace

Eigen::Vector2d CameraModel::distort(double x, double y) const {
  const double* d = distortion_.data();
  const double r2 = x * x + y * y;
  switch (lens_) {
    case Lens::kNone:
      return {x, y};
    case Lens::kEquidistant:
      return distort(Eigen::Vector3d(x, y, 1.0));
    default: {
      double scale = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
      if (lens_ == Lens::kRational) scale /= 1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7]));
      return {x * scale + 2.0 * d[2] * x * y + d[3] * (r2 + 2.0 * x * x),
              y * scale + d[2] * (r2 + 2.0 * y * y) + 2.0 * d[3] * x * y};
    }
  }
}

/** Through the equidistant lens, whatever the sign of Z. */
Eigen::Vector2d CameraModel::distort(const Eigen::Vector3d& ray) const {
  const double r = std::sqrt(ray.x() * ray.x() + ray.y() * ray.y());
  if (r == 0.0) return Eigen::Vector2d::Zero();
  return ray.head<2>() * (fisheye_.radius(std::atan2(r, ray.z())) / r);
}

/** Distorted radius at normalised radius r, tangential part left out, and its slope. Of polynomial lenses. */
ValueAndSlope CameraModel::radial(double r) const {
  if (lens_ == Lens::kNone) return {r, 1.0};
  const double* d = distortion_.data();
  const double r2 = r * r;
  const double above = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  const double above_slope = d[0] + r2 * (2.0 * d[1] + r2 * 3.0 * d[4]);  // d(above)/d(r2)
  if (lens_ == Lens::kPlumbBob) return {r * above, above + 2.0 * r2 * above_slope};
  const double below = 1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7]));
  if (!(below > 0.0)) return {-kInfinity, 0.0};  // a pole counts as a fold
  const double below_slope = d[5] + r2 * (2.0 * d[6] + r2 * 3.0 * d[7]);
  return {r * above / below, (above + 2.0 * r2 * (above_slope - above * below_slope / below)) / below};
}

/** The radius up to which radial() grows: geometric steps of 0.2 %, so that a fold is placed to 0.2 %, from below. */
void CameraModel::findLensRadius() {
  lens_radius_ = kInfinity;
  if (lens_ == Lens::kNone) return;
  double before = 0.0;
  for (double r = 1e-3; r < kLargestRadius; r *= 1.002) {
    const double rd = radial(r).value;
    if (!(rd > before)) {
      lens_radius_ = r / 1.002 / 1.002;
      return;
    }
    before = rd;
  }
  lens_radius_ = kLargestRadius;
}

/** Solves radial(r) = rd for r in [0, lens_radius_]. */
std::optional<double> CameraModel::inverseRadial(double rd) const {
  if (rd <= 0.0) return 0.0;
  if (radial(lens_radius_).value < rd) return std::nullopt;
  return increasingRoot([this](double r) { return radial(r); }, rd, 0.0, lens_radius_,
                        std::min(rd, 0.5 * lens_radius_));
}

/** Of the polynomial lenses; with `compatibility: gazebo` also beyond a fold. Fixed point on the tangential part, which
 * is a small fraction of the radial one: each turn gains two digits. */
std::optional<Eigen::Vector2d> CameraModel::undistort(const Eigen::Vector2d& distorted) const {
  if (lens_ == Lens::kNone) return distorted;
  const double* d = distortion_.data();
  Eigen::Vector2d xy = Eigen::Vector2d::Zero(), before;
  for (int i = 0; i < 100; ++i) {
    before = xy;
    Eigen::Vector2d rest = distorted;
    const double x = xy.x(), y = xy.y(), r2 = xy.squaredNorm();
    rest -=
        Eigen::Vector2d(2.0 * d[2] * x * y + d[3] * (r2 + 2.0 * x * x), d[2] * (r2 + 2.0 * y * y) + 2.0 * d[3] * x * y);
    const double rd = rest.norm();
    const std::optional<double> r = inverseRadial(rd);
    if (!r && !config_.told) return std::nullopt;
    if (!r) return Eigen::Vector2d(rest * (lens_radius_ / rd));  // the nearest that there is
    xy = rd > 0.0 ? Eigen::Vector2d(rest * (*r / rd)) : rest;
    if (d[2] == 0.0 && d[3] == 0.0) break;  // no tangential part: this was all
    if ((xy - before).norm() <= 1e-15 * (1.0 + xy.norm())) break;
  }
  if (!((distort(xy.x(), xy.y()) - distorted).norm() <= 1e-11 * (1.0 + distorted.norm()))) return std::nullopt;
  return xy;
}

/** Walks the image border, pixel edges included; a border point without a ray is a fault. */
void CameraModel::findImageRadius(FaultList& faults) {
  constexpr int kSteps = 64;
  findLensRadius();
  image_radius_ = 0.0;
  for (int k = 0; k <= 4 * kSteps && image_radius_ < kInfinity; ++k) {
    const int side = k / kSteps;  // a fifth one for the last corner
    const double along = double(k % kSteps) / kSteps, across = side < 2 ? 0.0 : 1.0;
    const double u = (side == 4 ? 1.0 : side % 2 == 0 ? along : across) * width() - 0.5;
    const double v = (side == 4 ? 1.0 : side % 2 == 0 ? across : along) * height() - 0.5;
    const auto xy = undistort({(u - cx_) / fx_, (v - cy_) / fy_});
    image_radius_ = xy ? std::max(image_radius_, xy->norm()) : kInfinity;
  }
  if (image_radius_ * 1.01 < lens_radius_) return;
  if (config_.told) {
    image_radius_ = lens_radius_ / 1.01;  // drawn up to the fold; beyond, as what is nearest
    return;
  }
  faults.add(
      "distortion",
      "coefficients whose lens folds over inside the image, at " + std::to_string(lens_radius_) + " from the axis",
      "one to one over the image");
}

/** Radius of a pixel position from the principal point, in focal lengths. */
double CameraModel::lensRadiusOf(double u, double v) const { return std::hypot((u - cx_) / fx_, (v - cy_) / fy_); }

void CameraModel::findImageAngle(FaultList& faults) {
  fisheye_ = EquidistantLens({distortion_[0], distortion_[1], distortion_[2], distortion_[3]});
  const double right = width() - 0.5, bottom = height() - 0.5;
  const double corner = std::max(
      {lensRadiusOf(-0.5, -0.5), lensRadiusOf(right, -0.5), lensRadiusOf(-0.5, bottom), lensRadiusOf(right, bottom)});
  const double fold = fisheye_.fold();
  if (fold <= config_.cutoff_angle_rad.value_or(EquidistantLens::kWidest) &&
      fisheye_.radius(fisheye_.reach()) <= corner) {
    faults.add(
        "distortion",
        "coefficients whose lens folds over " + std::to_string(fold) + " rad from the axis, in the field of view",
        "one to one over the image or up to a cutoff_angle_rad");
    return;
  }
  fisheye_.cutOff(config_.cutoff_angle_rad.value_or(EquidistantLens::kWidest));
  shows_lens_circle_ = fisheye_.radius(fisheye_.reach()) < corner;
  image_angle_ = std::min(fisheye_.reach(), fisheye_.angle(corner));
}

bool CameraModel::isWithinLens(double u, double v) const {
  return lens_ != Lens::kEquidistant || lensRadiusOf(u, v) <= fisheye_.radius(fisheye_.reach());
}

std::optional<Eigen::Vector2d> CameraModel::project(const Eigen::Vector3d& p_C) const {
  if (lens_ == Lens::kEquidistant) {
    if (p_C.isZero(0.0) || std::atan2(p_C.head<2>().norm(), p_C.z()) > fisheye_.reach()) return std::nullopt;
    return toPixel(p_C);
  }
  if (!(p_C.z() > 0.0)) return std::nullopt;
  const double x = p_C.x() / p_C.z(), y = p_C.y() / p_C.z();
  if (x * x + y * y > lens_radius_ * lens_radius_) return std::nullopt;
  return toPixel(x, y);
}

/** Through the equidistant lens, and on along its tangent beyond. */
Eigen::Vector3d CameraModel::fisheyeRay(double u, double v) const {
  const Eigen::Vector2d d((u - cx_) / fx_, (v - cy_) / fy_);
  const double rd = d.norm(), theta = fisheye_.angle(rd);
  if (rd == 0.0) return Eigen::Vector3d::UnitZ();
  const Eigen::Vector2d xy = d * (std::sin(theta) / rd);
  return {xy.x(), xy.y(), std::cos(theta)};
}

Eigen::Vector3d CameraModel::unproject(double u, double v) const {
  if (!std::isfinite(u) || !std::isfinite(v)) {
    throw NotFiniteError("unproject: pixel (" + std::to_string(u) + ", " + std::to_string(v) + ") is not finite");
  }
  const bool fisheye = lens_ == Lens::kEquidistant;
  const auto xy = fisheye ? std::nullopt : undistort({(u - cx_) / fx_, (v - cy_) / fy_});
  if (fisheye ? !isWithinLens(u, v) : !xy) {
    throw ParameterError("unproject: no ray of camera '" + config_.name + "' reaches pixel (" + std::to_string(u) +
                         ", " + std::to_string(v) + "): outside the range of its lens");
  }
  return fisheye ? fisheyeRay(u, v) : Eigen::Vector3d(xy->x(), xy->y(), 1.0);
}

void CameraModel::makeCornerRays() const {
  std::call_once(rays_->corners_once, [this] {
    rays_->corners.reserve(std::size_t(width() + 1) * (height() + 1));
    for (int v = 0; v <= height(); ++v) {
      for (int u = 0; u <= width(); ++u) {
        rays_->corners.push_back(lens_ == Lens::kEquidistant ? fisheyeRay(u - 0.5, v - 0.5)
                                                             : unproject(u - 0.5, v - 0.5));
      }
    }
    rays_->has_corners.store(true, std::memory_order_release);
  });
}

const std::vector<RayCone>& CameraModel::blockCones() const {
  std::call_once(rays_->cones_once, [this] {
    const auto corner = [this](int u, int v) -> Eigen::Vector3d {
      if (lens_ != Lens::kNone) return cornerRays()[std::size_t(v) * (width() + 1) + u].normalized();
      return Eigen::Vector3d((u - 0.5 - cx_) / fx_, (v - 0.5 - cy_) / fy_, 1.0).normalized();
    };
    for (int v0 = 0; v0 < height(); v0 += kBlock) {
      for (int u0 = 0; u0 < width(); u0 += kBlock) {
        const int u1 = std::min(u0 + kBlock, width()), v1 = std::min(v0 + kBlock, height());
        RayCone cone;
        cone.axis = (corner(u0, v0) + corner(u1, v0) + corner(u0, v1) + corner(u1, v1)).normalized();
        cone.cosine = 1.0;
        for (int v = v0; v <= v1; ++v) {
          for (int u = u0; u <= u1; ++u) cone.cosine = std::min(cone.cosine, cone.axis.dot(corner(u, v)));
        }
        constexpr double kMargin = 1e-9, kWidest = 0.01;  // rounding; beyond, any ray may be one of them
        cone.cosine = cone.cosine > kWidest ? cone.cosine - kMargin : 0.0;
        cone.sine = std::sqrt(1.0 - cone.cosine * cone.cosine);
        rays_->cones.push_back(cone);
      }
    }
  });
  return rays_->cones;
}

Eigen::Vector3d CameraModel::pixelRay(int u, int v) const {
  if (lens_ == Lens::kNone) return {(u - cx_) / fx_, (v - cy_) / fy_, 1.0};
  if (lens_ == Lens::kEquidistant) {
    std::call_once(rays_->centers_once, [this] {
      rays_->centers.reserve(std::size_t(width()) * height());
      for (int row = 0; row < height(); ++row) {
        for (int column = 0; column < width(); ++column) rays_->centers.push_back(fisheyeRay(column, row));
      }
    });
    return rays_->centers[std::size_t(v) * width() + u];
  }
  const Eigen::Vector3d* top = cornerRays().data() + std::size_t(v) * (width() + 1) + u;
  const Eigen::Vector3d* bottom = top + width() + 1;
  return 0.25 * (top[0] + top[1] + bottom[0] + bottom[1]);
}

}  // namespace aras_visual_servo_sim
