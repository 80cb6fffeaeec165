#include "aras_visual_servo_sim/camera_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "aras_visual_servo_sim/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargestRadius = 1e3;  // 89.94 degrees off the axis: no lens here sees farther

template <typename T>
std::string fault(const char* key, const T& found, const char* allowed) {
  std::ostringstream text;
  text.precision(17);
  text << key << ": found " << found << ", allowed " << allowed;
  return text.str();
}

void require(std::vector<std::string>& faults, bool good, const char* key, double found, const char* allowed) {
  if (!good) faults.push_back(fault(key, found, allowed));
}

}  // namespace

CameraModel::CameraModel(const CameraConfig& config) : config_(config) {
  std::vector<std::string> faults;
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  constexpr int kLargestImage = 16384;
  require(faults, config.width >= 1 && config.width <= kLargestImage, "width", config.width, "1 .. 16384 px");
  require(faults, config.height >= 1 && config.height <= kLargestImage, "height", config.height, "1 .. 16384 px");
  require(faults, positive(config.rate_hz), "rate_hz", config.rate_hz, "finite and > 0");
  require(faults, positive(config.near_m), "near_m", config.near_m, "finite and > 0");
  require(faults, std::isfinite(config.far_m) && config.far_m > config.near_m, "far_m", config.far_m,
          "finite and > near_m");
  require(faults, config.drop_probability >= 0.0 && config.drop_probability <= 0.99, "drop_probability",
          config.drop_probability, "0 .. 0.99");
  require(faults, config.exposure_s >= 0.0 && config.exposure_s < 1.0 / config.rate_hz, "exposure_s", config.exposure_s,
          ">= 0 and < 1 / rate_hz");
  require(faults, config.latency_s >= 0.0 && config.latency_s <= 10.0, "latency_s", config.latency_s, "0 .. 10 s");
  require(faults, config.exposure_samples >= 1 && config.exposure_samples <= 256, "exposure_samples",
          config.exposure_samples, "1 .. 256");
  require(faults, std::isfinite(config.baseline_m), "baseline_m", config.baseline_m, "finite");
  require(faults, std::isfinite(config.noise_mean), "noise_mean", config.noise_mean, "finite");
  require(faults, std::isfinite(config.noise_stddev) && config.noise_stddev >= 0.0, "noise_stddev", config.noise_stddev,
          "finite and >= 0");
  try {
    encoding_ = encodingFromName(config.encoding);
  } catch (const ParameterError& error) {
    faults.push_back(error.what());
  }
  if (config.sampling == "center") {
    sampling_ = Sampling::kCenter;
  } else if (config.sampling != "coverage") {
    faults.push_back(fault("sampling", "'" + config.sampling + "'", "coverage, center"));
  }
  readLens(faults);

  if (config.horizontal_fov_rad && (config.fx_px || config.fy_px)) {
    faults.push_back("horizontal_fov_rad: found together with fx_px or fy_px, allowed one or the other");
  } else if (config.horizontal_fov_rad) {
    const double field = *config.horizontal_fov_rad;
    require(faults, positive(field) && field < M_PI, "horizontal_fov_rad", field, "in (0, pi)");
    const double half = 0.5 * field;
    fx_ = fy_ = 0.5 * config.width / (lens_ == Lens::kEquidistant ? half : std::tan(half));
  } else if (config.fx_px && config.fy_px) {
    fx_ = *config.fx_px;
    fy_ = *config.fy_px;
    require(faults, positive(fx_), "fx_px", fx_, "finite and > 0");
    require(faults, positive(fy_), "fy_px", fy_, "finite and > 0");
  } else {
    faults.push_back("horizontal_fov_rad: found nothing, allowed either it or both fx_px and fy_px");
  }
  // A principal point outside the image is legal (a cropped image) but ten images away it is a mistake.
  cx_ = config.cx_px.value_or(0.5 * (config.width - 1));
  cy_ = config.cy_px.value_or(0.5 * (config.height - 1));
  require(faults, std::abs(cx_) <= 10.0 * config.width, "cx_px", cx_, "within 10 image widths of 0");
  require(faults, std::abs(cy_) <= 10.0 * config.height, "cy_px", cy_, "within 10 image heights of 0");
  if (faults.empty()) {
    findLensRadius();
    if (!findImageRadius()) {
      faults.push_back("distortion: found coefficients whose lens folds over inside the image, at " +
                       std::to_string(lens_radius_) + " from the axis, allowed one to one over the image");
    }
  }
  if (faults.empty()) return;
  std::string text = "camera '" + config.name + "':";
  for (const std::string& line : faults) text += "\n  " + line;
  throw ParameterError(text);
}

void CameraModel::readLens(std::vector<std::string>& faults) {
  const std::string& name = config_.distortion_model;
  std::size_t count = 5;
  if (name == "plumb_bob") {
    lens_ = Lens::kPlumbBob;
  } else if (name == "rational_polynomial") {
    lens_ = Lens::kRational;
    count = 8;
  } else if (name == "equidistant") {
    lens_ = Lens::kEquidistant;
    count = 4;
  } else if (name != "none") {
    faults.push_back(fault("distortion_model", "'" + name + "'", "none, plumb_bob, rational_polynomial, equidistant"));
  }
  const std::vector<double>& given = config_.distortion;
  distortion_ = given;
  distortion_.resize(count, 0.0);
  if (!given.empty() && given.size() != count) {
    faults.push_back("distortion: found " + std::to_string(given.size()) + " coefficients, allowed 0 or " +
                     std::to_string(count) + " for " + name);
  }
  bool all_zero = true;
  for (const double coefficient : given) {
    require(faults, std::isfinite(coefficient), "distortion", coefficient, "finite");
    if (coefficient != 0.0) all_zero = false;
  }
  if (name == "none" && !all_zero) faults.push_back("distortion: found coefficients, allowed only zeros for none");
  if (lens_ != Lens::kEquidistant && all_zero) lens_ = Lens::kNone;  // draws faster, same result
}

Eigen::Vector2d CameraModel::distort(double x, double y) const {
  const double* d = distortion_.data();
  const double r2 = x * x + y * y;
  switch (lens_) {
    case Lens::kNone:
      return {x, y};
    case Lens::kEquidistant: {
      const double r = std::sqrt(r2);
      const double scale = r > 1e-12 ? radial(r) / r : 1.0;
      return {x * scale, y * scale};
    }
    default: {
      double scale = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
      if (lens_ == Lens::kRational) scale /= 1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7]));
      return {x * scale + 2.0 * d[2] * x * y + d[3] * (r2 + 2.0 * x * x),
              y * scale + d[2] * (r2 + 2.0 * y * y) + 2.0 * d[3] * x * y};
    }
  }
}

/** Distorted radius of a point at normalised radius r, tangential part left out. */
double CameraModel::radial(double r) const {
  const double* d = distortion_.data();
  const double r2 = r * r;
  switch (lens_) {
    case Lens::kNone:
      return r;
    case Lens::kEquidistant: {
      const double theta = std::atan(r), t2 = theta * theta;
      return theta * (1.0 + t2 * (d[0] + t2 * (d[1] + t2 * (d[2] + t2 * d[3]))));
    }
    default: {
      const double numerator = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
      if (lens_ == Lens::kPlumbBob) return r * numerator;
      const double denominator = 1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7]));
      return denominator > 0.0 ? r * numerator / denominator : -kInfinity;  // a pole counts as a fold
    }
  }
}

/** The radius up to which radial() grows: geometric steps of 0.2 %, so that a fold is placed to 0.2 %, from below. */
void CameraModel::findLensRadius() {
  lens_radius_ = kInfinity;
  if (lens_ == Lens::kNone) return;
  double before = 0.0;
  for (double r = 1e-3; r < kLargestRadius; r *= 1.002) {
    const double rd = radial(r);
    if (!(rd > before)) {
      lens_radius_ = r / 1.002 / 1.002;
      return;
    }
    before = rd;
  }
  lens_radius_ = kLargestRadius;
}

/** Solves radial(r) = rd for r in [0, lens_radius_] by Newton's method kept inside a shrinking bracket. */
std::optional<double> CameraModel::inverseRadial(double rd) const {
  if (rd <= 0.0) return 0.0;
  double low = 0.0, high = lens_radius_;
  if (radial(high) < rd) return std::nullopt;
  double r = std::min(rd, 0.5 * high);
  for (int i = 0; i < 200; ++i) {
    const double error = radial(r) - rd;
    (error > 0.0 ? high : low) = r;
    if (std::abs(error) <= 1e-16 * rd) break;
    const double h = 1e-6 * std::max(r, 1e-6);
    const double slope = (radial(r + h) - radial(r - h)) / (2.0 * h);
    double next = r - error / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - r) <= 1e-16 * r) break;
    r = next;
  }
  return r;
}

/** Fixed point on the tangential part, which is a small fraction of the radial one: each turn gains two digits. */
std::optional<Eigen::Vector2d> CameraModel::undistort(const Eigen::Vector2d& distorted) const {
  if (lens_ == Lens::kNone) return distorted;
  const double* d = distortion_.data();
  const bool tangential = lens_ != Lens::kEquidistant;
  Eigen::Vector2d xy = Eigen::Vector2d::Zero(), before;
  for (int i = 0; i < 100; ++i) {
    before = xy;
    Eigen::Vector2d rest = distorted;
    if (tangential) {
      const double x = xy.x(), y = xy.y(), r2 = xy.squaredNorm();
      rest -= Eigen::Vector2d(2.0 * d[2] * x * y + d[3] * (r2 + 2.0 * x * x),
                              d[2] * (r2 + 2.0 * y * y) + 2.0 * d[3] * x * y);
    }
    const double rd = rest.norm();
    const std::optional<double> r = inverseRadial(rd);
    if (!r) return std::nullopt;
    xy = rd > 0.0 ? Eigen::Vector2d(rest * (*r / rd)) : rest;
    if ((xy - before).norm() <= 1e-15 * (1.0 + xy.norm())) break;
  }
  if (!((distort(xy.x(), xy.y()) - distorted).norm() <= 1e-11 * (1.0 + distorted.norm()))) return std::nullopt;
  return xy;
}

/** Walks the image border, pixel edges included. @return false if some border point has no ray */
bool CameraModel::findImageRadius() {
  constexpr int kSteps = 64;
  image_radius_ = 0.0;
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < kSteps; ++i) {
      const double along = double(i) / kSteps;
      const double across = side < 2 ? 0.0 : 1.0;
      const double u = (side % 2 == 0 ? along : across) * width() - 0.5;
      const double v = (side % 2 == 0 ? across : along) * height() - 0.5;
      const auto xy = undistort({(u - cx_) / fx_, (v - cy_) / fy_});
      if (!xy) return false;
      image_radius_ = std::max(image_radius_, xy->norm());
    }
  }
  const auto corner = undistort({(width() - 0.5 - cx_) / fx_, (height() - 0.5 - cy_) / fy_});
  if (!corner) return false;
  image_radius_ = std::max(image_radius_, corner->norm());
  return image_radius_ * 1.01 < lens_radius_;
}

std::optional<Eigen::Vector2d> CameraModel::project(const Eigen::Vector3d& p_C) const {
  if (!(p_C.z() > 0.0)) return std::nullopt;
  const double x = p_C.x() / p_C.z(), y = p_C.y() / p_C.z();
  if (x * x + y * y > lens_radius_ * lens_radius_) return std::nullopt;
  return toPixel(x, y);
}

Eigen::Vector3d CameraModel::unproject(double u, double v) const {
  if (!std::isfinite(u) || !std::isfinite(v)) {
    throw NotFiniteError("unproject: pixel (" + std::to_string(u) + ", " + std::to_string(v) + ") is not finite");
  }
  const auto xy = undistort({(u - cx_) / fx_, (v - cy_) / fy_});
  if (!xy) {
    throw ParameterError("unproject: no ray of camera '" + config_.name + "' reaches pixel (" + std::to_string(u) +
                         ", " + std::to_string(v) + "): outside the range of its lens");
  }
  return {xy->x(), xy->y(), 1.0};
}

const std::vector<Eigen::Vector3d>& CameraModel::cornerRays() const {
  std::call_once(corner_rays_->once, [this] {
    corner_rays_->rays.reserve(std::size_t(width() + 1) * (height() + 1));
    for (int v = 0; v <= height(); ++v) {
      for (int u = 0; u <= width(); ++u) corner_rays_->rays.push_back(unproject(u - 0.5, v - 0.5));
    }
  });
  return corner_rays_->rays;
}

Eigen::Vector3d CameraModel::pixelRay(int u, int v) const {
  if (lens_ == Lens::kNone) return {(u - cx_) / fx_, (v - cy_) / fy_, 1.0};
  const Eigen::Vector3d* top = cornerRays().data() + std::size_t(v) * (width() + 1) + u;
  const Eigen::Vector3d* bottom = top + width() + 1;
  return 0.25 * (top[0] + top[1] + bottom[0] + bottom[1]);
}

Eigen::Matrix3d CameraModel::K() const {
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  K(0, 0) = fx_;
  K(1, 1) = fy_;
  K(0, 2) = cx_;
  K(1, 2) = cy_;
  return K;
}

Eigen::Matrix<double, 3, 4> CameraModel::P() const {
  Eigen::Matrix<double, 3, 4> P = Eigen::Matrix<double, 3, 4>::Zero();
  P.leftCols<3>() = K();
  P(0, 3) = -fx_ * config_.baseline_m;
  return P;
}

std::string CameraModel::distortionModel() const {
  return config_.distortion_model == "none" ? "plumb_bob" : config_.distortion_model;
}

}  // namespace aras_visual_servo_sim
