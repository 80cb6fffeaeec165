#include "aras_visual_servo_sim/camera/camera_model.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

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
    const bool fisheye = lens_ == Lens::kEquidistant;
    require(faults, positive(field) && field < (fisheye ? 2.0 * M_PI : M_PI), "horizontal_fov_rad", field,
            fisheye ? "in (0, 2 pi)" : "in (0, pi), or through an equidistant lens (0, 2 pi)");
    const double half = 0.5 * field;
    fx_ = fy_ = 0.5 * config.width / (fisheye ? half : std::tan(half));
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
  if (faults.empty()) lens_ == Lens::kEquidistant ? findImageAngle(faults) : findImageRadius(faults);
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
  if (!config_.cutoff_angle_rad) return;
  const double cutoff = *config_.cutoff_angle_rad;
  if (lens_ != Lens::kEquidistant) {
    faults.push_back(fault("cutoff_angle_rad", cutoff, "only with distortion_model equidistant"));
  } else {
    require(faults, cutoff > 0.0 && cutoff <= EquidistantLens::kWidest, "cutoff_angle_rad", cutoff, "in (0, 2.18]");
  }
}

Eigen::Matrix3d CameraModel::K() const {
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  const std::optional<ToldIntrinsics>& told = config_.told;
  K(0, 0) = told ? told->f_px : fx_;
  K(1, 1) = told ? told->f_px : fy_;
  K(0, 2) = told ? told->cx_px : cx_;
  K(1, 2) = told ? told->cy_px : cy_;
  return K;
}

Eigen::Matrix<double, 3, 4> CameraModel::P() const {
  Eigen::Matrix<double, 3, 4> P = Eigen::Matrix<double, 3, 4>::Zero();
  P.leftCols<3>() = K();
  P(0, 3) = -P(0, 0) * config_.baseline_m;
  return P;
}

std::string CameraModel::distortionModel() const {
  return config_.told || config_.distortion_model == "none" ? "plumb_bob" : config_.distortion_model;
}

}  // namespace aras_visual_servo_sim
