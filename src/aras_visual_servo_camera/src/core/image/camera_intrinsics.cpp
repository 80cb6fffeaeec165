#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"

#include <algorithm>
#include <aras_visual_servo_common/fault_list.hpp>
#include <aras_visual_servo_common/increasing_root.hpp>
#include <aras_visual_servo_common/text.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "aras_visual_servo_camera/config/sections.hpp"

namespace aras_visual_servo_camera {
namespace {

using aras_visual_servo_common::FaultList;
using aras_visual_servo_common::increasingRoot;
using aras_visual_servo_common::numberText;
using aras_visual_servo_common::Range;
using aras_visual_servo_common::ValueAndSlope;

// Limits of the focal length. K of one pixel is the identity, which drivers without a calibration send. At a fiftieth
// of the larger side the border of the image is 87 degrees off the axis; at a thousand sides it is 0.03 degrees off.
constexpr double kIdentity_px = 1.0, kLeastOfSide = 0.02, kMostOfSide = 1000.0;
const double kWidestRadius = std::tan(CameraIntrinsics::kWidestAngle);
constexpr int kNewtonSteps = 50;
constexpr double kNewtonResidual = 1e-13;  // normalised coordinates are of order 1: some hundred roundings

}  // namespace

CameraIntrinsics::CameraIntrinsics(int width_px, int height_px, const std::array<double, 9>& K,
                                   const std::string& distortion_model, const std::vector<double>& D)
    : width_(width_px), height_(height_px), fx_(K[0]), fy_(K[4]), cx_(K[2]), cy_(K[5]) {
  FaultList faults;
  const auto fault = [&faults](const std::string& key, const std::string& found, const std::string& allowed) {
    faults.add("camera_info." + key, found, allowed);
  };
  const auto& described = schemaSections().section("camera_info").properties;
  const auto within = [&](const std::string& key, const Range& range, double value) {
    if (!range.contains(value)) fault(key, numberText(value), range.text());
  };
  within("width", described.at("width")->range, width_);
  within("height", described.at("height")->range, height_);
  const Range& px = described.at("K")->items->range;
  const double side = std::max({width_, height_, 1}), least = kLeastOfSide * side, most = kMostOfSide * side;
  const auto focal = [&](const std::string& key, double found) {
    if (found > kIdentity_px && found >= least && found <= most) return;
    fault(key, numberText(found),
          (least > kIdentity_px ? ">= " + numberText(least) : "> " + numberText(kIdentity_px)) +
              ", <= " + numberText(most) + " px at this size (an uncalibrated camera has K = 0 or the identity)");
  };
  focal("K[0] (fx)", fx_);
  focal("K[4] (fy)", fy_);
  within("K[2] (cx)", px, cx_);
  within("K[5] (cy)", px, cy_);
  for (int k : {1, 3, 6, 7})
    if (K[k] != 0.0) fault("K[" + std::to_string(k) + "]", numberText(K[k]), "0");
  if (K[8] != 1.0) fault("K[8]", numberText(K[8]), "1");

  static const std::map<std::string, std::vector<std::size_t>> kLengths = {
      {"plumb_bob", {0, 4, 5}}, {"rational_polynomial", {0, 8}}, {"equidistant", {4}}};
  const auto model = kLengths.find(distortion_model);
  if (distortion_model.empty() || distortion_model == "none") {
    if (std::any_of(D.begin(), D.end(), [](double d) { return d != 0.0; }))
      fault("D", "coefficients other than 0", "zeros without a distortion_model");
  } else if (model == kLengths.end()) {
    fault("distortion_model", "'" + distortion_model + "'", "none, plumb_bob, rational_polynomial, equidistant");
  } else if (std::find(model->second.begin(), model->second.end(), D.size()) == model->second.end()) {
    std::string allowed;
    for (std::size_t length : model->second) allowed += (allowed.empty() ? "" : " or ") + std::to_string(length);
    fault("D", std::to_string(D.size()) + " coefficients", allowed + " for " + distortion_model);
  }
  for (double d : D) within("D", described.at("D")->items->range, d);
  faults.throwIfAny();

  std::copy_n(D.begin(), std::min(D.size(), D_.size()), D_.begin());
  if (distortion_model == "equidistant") {
    lens_ = Lens::kEquidistant;
    findReach();
  } else if (std::any_of(D_.begin(), D_.end(), [](double d) { return d != 0.0; })) {
    lens_ = Lens::kPolynomial;
    findFold();
  }
}

bool CameraIntrinsics::operator==(const CameraIntrinsics& o) const {
  return width_ == o.width_ && height_ == o.height_ && fx_ == o.fx_ && fy_ == o.fy_ && cx_ == o.cx_ && cy_ == o.cy_ &&
         lens_ == o.lens_ && D_ == o.D_;
}

// x_d = x (1 + k1 r2 + k2 r4 + k3 r6) / (1 + k4 r2 + k5 r4 + k6 r6) + 2 p1 x y + p2 (r2 + 2 x2), and y likewise (REP
// 104, OpenCV calib3d). J is its derivative.
void CameraIntrinsics::distortPolynomial(double x, double y, double xd[2], double J[4]) const {
  const double k1 = D_[0], k2 = D_[1], p1 = D_[2], p2 = D_[3], k3 = D_[4], k4 = D_[5], k5 = D_[6], k6 = D_[7];
  const double r2 = x * x + y * y;
  const double above = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)), below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double d_above = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3), d_below = k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6);
  const double radial = above / below;
  const double d_radial = (d_above * below - above * d_below) / (below * below);  // with respect to r2
  xd[0] = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  xd[1] = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  J[0] = radial + 2.0 * x * x * d_radial + 2.0 * p1 * y + 6.0 * p2 * x;
  J[1] = J[2] = 2.0 * x * y * d_radial + 2.0 * p1 * x + 2.0 * p2 * y;
  J[3] = radial + 2.0 * y * y * d_radial + 6.0 * p1 * y + 2.0 * p2 * x;
}

// theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), theta = atan r, (x_d, y_d) = (x, y) theta_d
// / r (Kannala and Brandt, IEEE PAMI 28(8), 2006, as OpenCV's fisheye model and REP 104's equidistant).
void CameraIntrinsics::distortEquidistant(double x, double y, double xd[2], double J[4]) const {
  constexpr double kSmall = 1e-8;  // below, theta_d / r = 1 to rounding
  const double r2 = x * x + y * y, r = std::sqrt(r2);
  const double theta = std::atan(r);
  const auto [theta_d, slope] = drawn(theta);
  const double scale = r < kSmall ? 1.0 : theta_d / r;
  // d(scale)/d(r2) = (d theta_d / dr - scale) / (2 r2), with d theta_d / dr = slope / (1 + r2)
  const double d_scale = r < kSmall ? 0.0 : (slope / (1.0 + r2) - scale) / (2.0 * r2);
  xd[0] = x * scale;
  xd[1] = y * scale;
  J[0] = scale + 2.0 * x * x * d_scale;
  J[1] = J[2] = 2.0 * x * y * d_scale;
  J[3] = scale + 2.0 * y * y * d_scale;
}

void CameraIntrinsics::distort(double x, double y, double xd[2], double J[4]) const {
  if (lens_ == Lens::kPolynomial) return distortPolynomial(x, y, xd, J);
  if (lens_ == Lens::kEquidistant) return distortEquidistant(x, y, xd, J);
  xd[0] = x;
  xd[1] = y;
  J[0] = J[3] = 1.0;
  J[1] = J[2] = 0.0;
}

std::array<double, 2> CameraIntrinsics::project(double x, double y) const {
  double xd[2], J[4];
  distort(x, y, xd, J);
  return {fx_ * xd[0] + cx_, fy_ * xd[1] + cy_};
}

/** How far from the axis the equidistant lens draws an angle. */
ValueAndSlope CameraIntrinsics::drawn(double theta) const {
  const double t2 = theta * theta;
  return {theta * (1.0 + t2 * (D_[0] + t2 * (D_[1] + t2 * (D_[2] + t2 * D_[3])))),
          1.0 + t2 * (3.0 * D_[0] + t2 * (5.0 * D_[1] + t2 * (7.0 * D_[2] + t2 * 9.0 * D_[3])))};
}

/** Sets reach_: up to this angle the equidistant lens draws ever farther from the axis. The search ends beyond
 * kWidestRay, because no ray there is used. */
void CameraIntrinsics::findReach() {
  constexpr double kStep = 0.02;  // [rad]
  double before = 0.0;
  for (double theta = kStep; reach_ <= kWidestRay; theta += kStep) {
    const double farther = drawn(theta).value;
    if (!(farther > before)) return;
    before = farther;
    reach_ = theta;
  }
}

/** How far from the axis the radial part of the polynomial lens draws a ray at distance r. @see distortPolynomial() */
ValueAndSlope CameraIntrinsics::drawnByPolynomial(double r) const {
  const double r2 = r * r;
  const double above = 1.0 + r2 * (D_[0] + r2 * (D_[1] + r2 * D_[4]));
  const double below = 1.0 + r2 * (D_[5] + r2 * (D_[6] + r2 * D_[7]));
  const double d_above = D_[0] + r2 * (2.0 * D_[1] + r2 * 3.0 * D_[4]);
  const double d_below = D_[5] + r2 * (2.0 * D_[6] + r2 * 3.0 * D_[7]);
  if (!(below > 0.0)) return {std::numeric_limits<double>::infinity(), -1.0};  // at a pole, or beyond one
  return {r * above / below, (above * below + 2.0 * r2 * (d_above * below - above * d_below)) / (below * below)};
}

/** Sets fold_: up to there the radial part of the polynomial lens draws ever farther from the axis. A rational lens may
 * do so again beyond, which makes a second ray for the same pixel. */
void CameraIntrinsics::findFold() {
  constexpr double kStep = 0.002;  // [rad]
  double before = 0.0;
  for (double theta = kStep; theta <= kWidestAngle; theta += kStep) {
    const double r = std::tan(theta);
    if (drawnByPolynomial(r).slope > 0.0) {
      before = r;
      continue;
    }
    double low = before, high = r;
    for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high))
      (drawnByPolynomial(middle).slope > 0.0 ? low : high) = middle;
    fold_ = low;
    drawn_fold_ = drawnByPolynomial(low).value;
    return;
  }
}

double CameraIntrinsics::farthestCorner() const {
  return std::hypot(std::max(cx_ + 0.5, width_ - 0.5 - cx_) / fx_, std::max(cy_ + 0.5, height_ - 0.5 - cy_) / fy_);
}

double CameraIntrinsics::foldRadius() const {
  double rd = drawn_fold_;
  if (lens_ == Lens::kEquidistant && reach_ <= kWidestRay) rd = drawn(reach_).value;
  return rd < farthestCorner() ? rd * std::sqrt(fx_ * fy_) : std::numeric_limits<double>::infinity();
}

std::string CameraIntrinsics::foldWarning() const {
  const auto whole = [](double px) { return std::to_string(std::lround(px)); };
  if (!std::isfinite(foldRadius())) return "";
  return "camera_info.D: the lens is not one-to-one from " + whole(foldRadius()) +
         " px on, measured from the optical axis, and the image reaches " +
         whole(farthestCorner() * std::sqrt(fx_ * fy_)) + " px; features beyond are not valid";
}

/** The angle from the axis at which the equidistant lens draws at rd, or infinity. */
double CameraIntrinsics::angleOf(double rd) const {
  if (rd > drawn(reach_).value) return std::numeric_limits<double>::infinity();
  return increasingRoot([this](double theta) { return drawn(theta); }, rd, 0.0, reach_, std::min(rd, 0.5 * reach_));
}

CameraIntrinsics::Undistorted CameraIntrinsics::undistort(double u_px, double v_px) const {
  const double xd = (u_px - cx_) / fx_, yd = (v_px - cy_) / fy_;
  Undistorted out;
  out.x = xd;
  out.y = yd;
  if (lens_ == Lens::kEquidistant) {  // the angle by itself is the solution to rounding; what follows polishes it
    const double rd = std::hypot(xd, yd), theta = angleOf(rd);
    if (theta > kWidestAngle) return out;
    if (rd > 0.0) {
      out.x *= std::tan(theta) / rd;
      out.y *= std::tan(theta) / rd;
    }
  }
  if (lens_ != Lens::kPolynomial) return solve(xd, yd, out);
  const double rd = std::hypot(xd, yd);
  if (!(rd <= drawn_fold_)) return out;
  out = solve(xd, yd, out);
  if (out.valid && isWithinFold(out.x, out.y)) return out;
  // Newton's method went astray, or beyond the fold: begin where the radial part leads.
  const double most = std::min(fold_, kWidestRadius);
  if (!(rd > 0.0 && rd <= drawnByPolynomial(most).value)) return Undistorted();
  const double r =
      increasingRoot([this](double at) { return drawnByPolynomial(at); }, rd, 0.0, most, std::min(rd, most));
  out = solve(xd, yd, {xd * r / rd, yd * r / rd});
  out.valid = out.valid && isWithinFold(out.x, out.y);
  return out;
}

/** Newton's method on the lens model. */
CameraIntrinsics::Undistorted CameraIntrinsics::solve(double xd, double yd, Undistorted out) const {
  double at[2], J[4];
  for (int step = 0; step < kNewtonSteps; ++step) {
    distort(out.x, out.y, at, J);
    const double ex = xd - at[0], ey = yd - at[1], det = J[0] * J[3] - J[1] * J[2];
    if (!(J[0] > 0.0 && J[3] > 0.0 && det > 0.0)) return out;  // beyond the fold of the lens polynomial: no ray
    if (std::abs(ex) + std::abs(ey) <= kNewtonResidual * (1.0 + std::abs(xd) + std::abs(yd))) {
      out.valid = std::hypot(out.x, out.y) <= kWidestRadius;
      out.jacobian = {J[3] / det / fx_, -J[1] / det / fy_, -J[2] / det / fx_, J[0] / det / fy_};
      return out;
    }
    out.x += (J[3] * ex - J[1] * ey) / det;
    out.y += (J[0] * ey - J[2] * ex) / det;
  }
  return out;
}

CameraIntrinsics::Ray CameraIntrinsics::rayOf(double u_px, double v_px) const {
  if (lens_ != Lens::kEquidistant) {
    const Undistorted at = undistort(u_px, v_px);
    if (!at.valid) return Ray{};
    const double length = std::sqrt(at.x * at.x + at.y * at.y + 1.0);
    const double area = at.jacobian[0] * at.jacobian[3] - at.jacobian[1] * at.jacobian[2];
    return {at.x / length, at.y / length, 1.0 / length, area / (length * length * length)};
  }
  const double xd = (u_px - cx_) / fx_, yd = (v_px - cy_) / fy_, rd = std::hypot(xd, yd);
  const double theta = angleOf(rd);
  if (!(theta <= kWidestRay)) return Ray{};
  const double slope = drawn(theta).slope;
  const double scale = rd > 0.0 ? std::sin(theta) / rd : 1.0;  // d(solid angle) = sin(theta) d(theta) d(direction)
  return {scale * xd, scale * yd, std::cos(theta), scale / (slope * fx_ * fy_)};
}

CameraIntrinsics intrinsicsOf(const CameraInfoConfig& info) {
  const CameraIntrinsics sensor(info.width, info.height, info.K, info.distortion_model, info.D);
  CameraIntrinsics image = sensor;
  FaultList faults;
  // Along one axis.
  const auto readOut = [&faults](const std::string& axis, const std::string& side, int binning, int offset, int extent,
                                 int* size, double* focal, double* centre) {
    const int whole = *size, pixels = std::max(binning, 1);
    if (extent == 0) extent = whole;
    if (pixels == 1 && offset == 0 && extent == whole) return;
    const std::int64_t end = std::int64_t{offset} + extent;
    if (end > whole)
      faults.add("camera_info.roi." + axis + "_offset + " + side, std::to_string(end),
                 "<= camera_info." + side + ", " + std::to_string(whole));
    if (!(*centre > -0.5 && *centre < whole - 0.5))
      faults.add("camera_info." + side,
                 std::to_string(whole) + " with binning or roi and an optical axis at " + numberText(*centre),
                 "the size of the whole sensor, which K belongs to");
    if (extent < pixels)
      faults.add("camera_info.binning_" + axis, std::to_string(pixels),
                 "<= " + std::to_string(extent) + " pixels read out");
    *size = extent / pixels;
    *focal /= pixels;
    *centre = (*centre - offset + 0.5) / pixels - 0.5;
  };
  const auto& roi = info.roi;
  readOut("x", "width", info.binning_x, roi.x_offset, roi.width, &image.width_, &image.fx_, &image.cx_);
  readOut("y", "height", info.binning_y, roi.y_offset, roi.height, &image.height_, &image.fy_, &image.cy_);
  faults.throwIfAny();
  return image;
}

CameraIntrinsics readCameraInfo(const YAML::Node& node) {
  return intrinsicsOf(aras_visual_servo_common::readSection<CameraInfoConfig>(node, "camera_info", [](auto&&...) {}));
}

}  // namespace aras_visual_servo_camera
