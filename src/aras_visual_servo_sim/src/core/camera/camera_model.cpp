#include "aras_visual_servo_sim/camera/camera_model.hpp"

#include <algorithm>
#include <aras_visual_servo_common/text.hpp>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/image/sensor/sensor.hpp"

namespace aras_visual_servo_sim {
namespace {

using aras_visual_servo_common::numberText;

/** A principal point outside the image is legal (a cropped image) but ten images away it is a mistake. */
constexpr double kFarthestCenter = 10.0;

/** Checks keys of a camera that may come from elsewhere than YAML. */
struct Checking {
  const Schema& section;
  FaultList& faults;
  template <typename T>
  void operator()(const char* key, const T& value) const {
    checkValue(section, key, value, faults);
  }
  void operator()(const char* key, const std::string& value) const {
    const bool is_choice = !section.property(YAML::Node(), key)->choices.empty();
    if (is_choice) checkValue(section, key, value, faults);  // any text is allowed as a name, also ""
  }
  void operator()(const char* key, const std::optional<double>& value) const {
    if (value) checkValue(section, key, *value, faults);
  }
  void operator()(const char*, bool) const {}
  void operator()(const char*, const std::optional<SensorConfig>&) const {}  // comes from YAML alone
};

}  // namespace

CameraModel::CameraModel(const CameraConfig& config) : config_(config) {
  FaultList faults;
  CameraKeys::visitKeys(config, Checking{CameraKeys::schema(), faults});
  if (config.far_m <= config.near_m) {
    faults.add("far_m", numberText(config.far_m), "> near_m, " + numberText(config.near_m));
  }
  if (config.exposure_s >= 1.0 / config.rate_hz) {
    faults.add("exposure_s", numberText(config.exposure_s), "< 1 / rate_hz, " + numberText(1.0 / config.rate_hz));
  }
  if (config.sensor) checkSensor(faults);
  sampling_ = config.sampling == "center" ? Sampling::kCenter : Sampling::kCoverage;
  readLens(faults);
  readFocalLength(faults);
  cx_ = config.cx_px.value_or(0.5 * (config.width - 1));
  cy_ = config.cy_px.value_or(0.5 * (config.height - 1));
  if (std::abs(cx_) > kFarthestCenter * config.width) {
    faults.add("cx_px", numberText(cx_), "within 10 image widths of 0");
  }
  if (std::abs(cy_) > kFarthestCenter * config.height) {
    faults.add("cy_px", numberText(cy_), "within 10 image heights of 0");
  }
  if (faults.empty()) {
    encoding_ = encodingFromName(config.encoding);
    lens_ == Lens::kEquidistant ? findImageAngle(faults) : findImageRadius(faults);
  }
  if (faults.empty()) return;
  FaultList named;
  named.adopt(ParameterError(faults.lines()), "camera '" + config.name + "': ");
  named.throwIfAny();
}

void CameraModel::checkSensor(FaultList& faults) const {
  const SensorConfig& sensor = *config_.sensor;
  if (sensor.black_level_dn >= mostDn(sensor)) {
    faults.add("sensor.black_level_dn", numberText(sensor.black_level_dn),
               "< 2^adc_bits - 1, " + numberText(mostDn(sensor)));
  }
  if (const auto& lens = sensor.depth_of_field; lens) {
    if (lens->focal_length_m >= lens->focus_distance_m) {
      faults.add("sensor.depth_of_field.focal_length_m", numberText(lens->focal_length_m),
                 "< focus_distance_m, " + numberText(lens->focus_distance_m));
    }
    if (sensor.defocus_px > 0.0) {
      faults.add("sensor.defocus_px", numberText(sensor.defocus_px), "0 beside depth_of_field");
    }
  }
  if (sensor.jpeg_quality > 0 && (config_.encoding == "mono16" || config_.encoding == "rgb16")) {
    faults.add("sensor.jpeg_quality", numberText(sensor.jpeg_quality),
               "0 with " + config_.encoding + ": JPEG has 8 bits a value");
  }
  if (sensor.auto_white_balance && (config_.encoding == "mono8" || config_.encoding == "mono16")) {
    faults.add("sensor.auto_white_balance", "a section", "none with " + config_.encoding + ", which has no colours");
  }
  const double all_s = config_.exposure_s + sensor.row_time_s * (config_.height - 1);
  if (sensor.row_time_s > 0.0 && all_s >= 1.0 / config_.rate_hz) {
    faults.add("sensor.row_time_s", numberText(sensor.row_time_s),
               "a time with which all rows, " + numberText(all_s) + " s, take < 1 / rate_hz, " +
                   numberText(1.0 / config_.rate_hz));
  }
  if (config_.noise_stddev != 0.0 || config_.noise_mean != 0.0) {
    faults.add("noise_stddev and noise_mean",
               numberText(config_.noise_stddev) + " and " + numberText(config_.noise_mean),
               "0 with a sensor, whose own keys are dark_noise_e and black_level_dn");
  }
}

CameraModel CameraModel::row(int v) const {
  CameraModel model = *this;
  model.config_.height = 1;
  model.config_.cy_px = model.cy_ = cy_ - v;
  model.rays_ = std::make_shared<Rays>();
  return model;
}

void CameraModel::readFocalLength(FaultList& faults) {
  const std::optional<double>& field = config_.horizontal_fov_rad;
  const bool focal = config_.fx_px && config_.fy_px;
  if (field ? config_.fx_px || config_.fy_px : !focal) {
    faults.add("horizontal_fov_rad", field ? "it together with fx_px or fy_px" : "nothing",
               "either it or both fx_px and fy_px");
  } else if (focal) {
    fx_ = *config_.fx_px;
    fy_ = *config_.fy_px;
  } else {
    const bool fisheye = lens_ == Lens::kEquidistant;
    if (*field >= (fisheye ? 2.0 * M_PI : M_PI)) {
      faults.add("horizontal_fov_rad", numberText(*field),
                 fisheye ? "< 2 pi" : "< pi, or through an equidistant lens < 2 pi");
    }
    const double half = 0.5 * *field;
    fx_ = fy_ = 0.5 * config_.width / (fisheye ? half : std::tan(half));
  }
}

void CameraModel::readLens(FaultList& faults) {
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
  }
  const std::vector<double>& given = config_.distortion;
  distortion_ = given;
  distortion_.resize(count, 0.0);
  if (!given.empty() && given.size() != count) {
    faults.add("distortion", std::to_string(given.size()) + " coefficients",
               "0 or " + std::to_string(count) + " for " + name);
  }
  const bool all_zero = std::all_of(given.begin(), given.end(), [](double coefficient) { return coefficient == 0.0; });
  if (name == "none" && !all_zero) faults.add("distortion", "coefficients", "only zeros for none");
  if (lens_ != Lens::kEquidistant && all_zero) lens_ = Lens::kNone;  // draws faster, same result
  if (config_.cutoff_angle_rad && lens_ != Lens::kEquidistant) {
    faults.add("cutoff_angle_rad", numberText(*config_.cutoff_angle_rad), "only with distortion_model equidistant");
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
