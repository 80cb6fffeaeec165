#include "photometric/photometric_level.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {
namespace {

constexpr double kReach = 3.0;  // standard deviations of a Gaussian that its kernel reaches

int extent(int full, int level) {
  for (int k = 0; k < level; ++k) full = (full + 1) / 2;
  return full;
}

// L_x of a point, rows x and y (Chaumette and Hutchinson, IEEE RAM 13(4), 2006), zeta = 1/Z.
void pointRows(double x, double y, double zeta, double rows[2][6]) {
  const double values[2][6] = {{-zeta, 0.0, x * zeta, x * y, -(1.0 + x * x), y},
                               {0.0, -zeta, y * zeta, 1.0 + y * y, -x * y, -x}};
  std::copy_n(&values[0][0], 12, &rows[0][0]);
}

}  // namespace

PhotometricLevel::PhotometricLevel(const CameraIntrinsics& intrinsics, int level, const PhotometricConfig& config)
    : config_(config),
      mapping_(makeMapping(config)),
      view_{intrinsics, Plane{}, std::ldexp(1.0, level), 0},
      width_(extent(intrinsics.width(), level)),
      height_(extent(intrinsics.height(), level)) {
  const double pitch = view_.pitch;
  const int reach = static_cast<int>(std::ceil(kReach * config.smoothing_px));
  border_ = std::max(reach, static_cast<int>(std::ceil(config.border_px / pitch)));
  view_.border = border_;
  focal_ = {intrinsics.fx() / pitch, intrinsics.fy() / pitch};
  scale_ = std::sqrt(focal_[0] * focal_[1]);
  const cv::Size size(width_, height_);
  for (cv::Mat* table : {&x_, &y_, &mask_, &zeta_}) *table = cv::Mat::zeros(size, CV_32F);
  if (intrinsics.distorted())
    for (cv::Mat& table : duv_dxy_) table = cv::Mat::zeros(size, CV_32F);
  for (int v = border_; v < height_ - border_; ++v) {
    for (int u = border_; u < width_ - border_; ++u) {
      const CameraIntrinsics::Undistorted ray = intrinsics.undistort(pitch * u, pitch * v);
      if (!ray.valid) continue;
      ++pixels_;
      x_.at<float>(v, u) = static_cast<float>(ray.x);
      y_.at<float>(v, u) = static_cast<float>(ray.y);
      mask_.at<float>(v, u) = 1.0f;
      if (!intrinsics.distorted()) continue;
      const auto& J = ray.jacobian;  // d(x, y)/d(u, v); inverted here
      const double det = (J[0] * J[3] - J[1] * J[2]) * pitch;
      const double inverse[4] = {J[3] / det, -J[1] / det, -J[2] / det, J[0] / det};
      for (int k = 0; k < 4; ++k) duv_dxy_[k].at<float>(v, u) = static_cast<float>(inverse[k]);
    }
  }
  if (pixels_ == 0)
    throw ParameterError("vision.photometric.levels: found " + std::to_string(config.levels) +
                         ", allowed so many that pixels are left inside border_px and the reach of smoothing_px");

  gauss_.create(1, 2 * reach + 1, CV_32F);
  derivative_.create(1, 2 * reach + 1, CV_32F);
  double mass = 0.0, slope = 0.0;
  const auto weight = [&](int i) { return std::exp(-0.5 * i * i / (config.smoothing_px * config.smoothing_px)); };
  for (int i = -reach; i <= reach; ++i) {
    mass += weight(i);
    slope += i * i * weight(i);
  }
  for (int i = -reach; i <= reach; ++i) {  // exact for a constant, the derivative for a ramp
    gauss_.at<float>(i + reach) = static_cast<float>(weight(i) / mass);
    derivative_.at<float>(i + reach) = static_cast<float>(i * weight(i) / slope);
  }
  columns_.resize(9 * static_cast<std::size_t>(padded(width_)));
}

void PhotometricLevel::setPlane(const Plane& plane) {
  view_.plane = plane;
  flow_ = cv::Matx66d::zeros();
  for (int v = border_; v < height_ - border_; ++v) {
    for (int u = border_; u < width_ - border_; ++u) {
      if (mask_.at<float>(v, u) == 0.0f) continue;
      const double x = x_.at<float>(v, u), y = y_.at<float>(v, u), zeta = plane.A * x + plane.B * y + plane.C;
      if (!(zeta > 0.0) || !std::isfinite(zeta))
        throw ParameterError(
            "photometric reference: found a plane that is not in front of every pixel, allowed 1/Z > 0");
      zeta_.at<float>(v, u) = static_cast<float>(zeta);
      double rows[2][6];
      pointRows(x, y, zeta, rows);
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) flow_(i, j) += rows[0][i] * rows[0][j] + rows[1][i] * rows[1][j];
    }
  }
  flow_ *= 1.0 / pixels_;
}

double PhotometricLevel::motion(const Vector6& step, int stage) const {
  double square = 0.0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) square += step[i] * flow_(i, j) * step[j];
  return scale_ * std::sqrt(std::max(0.0, square)) / (mapping_ ? mapping_->pitch(stage) : 1.0);
}

void PhotometricLevel::smooth(const cv::Mat& image, cv::Mat* out) const {
  cv::sepFilter2D(image, *out, CV_32F, gauss_, gauss_, cv::Point(-1, -1), 0.0, cv::BORDER_REPLICATE);
}

// The gradient of the smoothed image, by the chain rule in normalised coordinates.
void PhotometricLevel::differentiate(const cv::Mat& image, Gradient* out) {
  const cv::Point middle(-1, -1);
  cv::sepFilter2D(image, du_, CV_32F, derivative_, gauss_, middle, 0.0, cv::BORDER_REPLICATE);
  cv::sepFilter2D(image, dv_, CV_32F, gauss_, derivative_, middle, 0.0, cv::BORDER_REPLICATE);
  for (cv::Mat* rim : {&out->x, &out->y})
    if (rim->empty()) *rim = cv::Mat::zeros(height_, width_, CV_32F);
  for (int v = border_; v < height_ - border_; ++v) {
    const float *du = du_.ptr<float>(v), *dv = dv_.ptr<float>(v);
    float *gx = out->x.ptr<float>(v), *gy = out->y.ptr<float>(v);
    if (duv_dxy_[0].empty()) {
      const float fx = static_cast<float>(focal_[0]), fy = static_cast<float>(focal_[1]);
      for (int u = 0; u < width_; ++u) {
        gx[u] = fx * du[u];
        gy[u] = fy * dv[u];
      }
      continue;
    }
    const float *ux = duv_dxy_[0].ptr<float>(v), *uy = duv_dxy_[1].ptr<float>(v);
    const float *vx = duv_dxy_[2].ptr<float>(v), *vy = duv_dxy_[3].ptr<float>(v);
    for (int u = 0; u < width_; ++u) {
      gx[u] = du[u] * ux[u] + dv[u] * vx[u];
      gy[u] = du[u] * uy[u] + dv[u] * vy[u];
    }
  }
}

void PhotometricLevel::setReference(const cv::Mat& image) {
  smooth(image, &reference_);
  differentiate(image, &reference_gradient_);
}

NormalEquations PhotometricLevel::ofReference() {
  if (!mapping_) return sum(reference_gradient_, reference_);
  map(reference_gradient_, reference_);
  mapping_->setReference(mapped_, view_);
  return mapping_->equations(mapped_, 0);
}

void PhotometricLevel::look(const cv::Mat& image) {
  smooth(image, &smoothed_);
  if (config_.interaction != GradientOf::kDesired) differentiate(image, &gradient_);
  if (config_.interaction == GradientOf::kMean) {
    cv::addWeighted(gradient_.x, 0.5, reference_gradient_.x, 0.5, 0.0, gradient_.x);
    cv::addWeighted(gradient_.y, 0.5, reference_gradient_.y, 0.5, 0.0, gradient_.y);
  }
  if (mapping_) map(gradientOfLook(), smoothed_);
}

const PhotometricLevel::Gradient& PhotometricLevel::gradientOfLook() const {
  return config_.interaction == GradientOf::kDesired ? reference_gradient_ : gradient_;
}

NormalEquations PhotometricLevel::equations(int stage) {
  return mapping_ ? mapping_->equations(mapped_, stage) : sum(gradientOfLook(), smoothed_);
}

// L = -(gx, gy) L_x, written out: with q = gx x + gy y it is
// [gx zeta, gy zeta, -q zeta, -gy - y q, gx + x q, x gy - y gx].
void PhotometricLevel::fillRow(int v, const Gradient& gradient, const cv::Mat& image, float* const* column) const {
  const int width = width_ - 2 * border_, count = illuminationColumns(config_.illumination);
  const float *gx = gradient.x.ptr<float>(v) + border_, *gy = gradient.y.ptr<float>(v) + border_;
  const float *x = x_.ptr<float>(v) + border_, *y = y_.ptr<float>(v) + border_, *zeta = zeta_.ptr<float>(v) + border_;
  const float *star = reference_.ptr<float>(v) + border_, *mask = mask_.ptr<float>(v) + border_;
  const float* now = image.ptr<float>(v) + border_;
  float* e = column[6 + count];
  for (int u = 0; u < width; ++u) {
    const float q = gx[u] * x[u] + gy[u] * y[u];
    column[0][u] = gx[u] * zeta[u];
    column[1][u] = gy[u] * zeta[u];
    column[2][u] = -q * zeta[u];
    column[3][u] = -gy[u] - y[u] * q;
    column[4][u] = gx[u] + x[u] * q;
    column[5][u] = x[u] * gy[u] - y[u] * gx[u];
    e[u] = mask[u] * (now[u] - star[u]);
  }
  if (count > 0) std::copy_n(mask, width, column[6]);
  if (count > 1)
    for (int u = 0; u < width; ++u) column[7][u] = mask[u] * star[u];
}

NormalEquations PhotometricLevel::sum(const Gradient& gradient, const cv::Mat& image) {
  const int n = padded(width_ - 2 * border_);
  std::fill(columns_.begin(), columns_.end(), 0.0f);  // what pads a row adds nothing
  float* column[9];
  for (int k = 0; k < 9; ++k) column[k] = columns_.data() + static_cast<std::size_t>(k) * n;
  ColumnSums sums(7 + illuminationColumns(config_.illumination));
  for (int v = border_; v < height_ - border_; ++v) {
    fillRow(v, gradient, image, column);
    sums.add(columns_.data(), n);
  }
  return sums.equations();
}

// The columns of all rows as images, for the mapping. Gradients of pixels without a ray are those of one at (0, 0), so
// that the mask is laid over them.
void PhotometricLevel::map(const Gradient& gradient, const cv::Mat& image) {
  const cv::Rect inside(border_, border_, width_ - 2 * border_, height_ - 2 * border_);
  mapped_.columns.resize(7 + illuminationColumns(config_.illumination));
  for (cv::Mat& one : mapped_.columns) one.create(inside.size(), CV_32F);
  mapped_.image = image(inside);
  mapped_.reference = reference_(inside);
  mapped_.mask = mask_(inside);
  for (int v = 0; v < inside.height; ++v) {
    float* column[9];
    for (std::size_t k = 0; k < mapped_.columns.size(); ++k) column[k] = mapped_.columns[k].ptr<float>(v);
    fillRow(v + border_, gradient, image, column);
  }
  for (int k = 0; k < 6; ++k) mapped_.columns[k] = mapped_.columns[k].mul(mapped_.mask);
}

double PhotometricLevel::rms(const cv::Mat& a, const cv::Mat& b) const {
  const int n = padded(width_), count = illuminationColumns(config_.illumination);
  std::vector<float> columns(3 * static_cast<std::size_t>(n), 0.0f);
  ColumnSums sums(1 + count);
  for (int v = border_; v < height_ - border_; ++v) {
    const float *now = a.ptr<float>(v), *star = b.ptr<float>(v), *mask = mask_.ptr<float>(v);
    float* e = columns.data() + static_cast<std::size_t>(count) * n;
    for (int u = 0; u < width_; ++u) e[u] = mask[u] * (now[u] - star[u]);
    if (count > 0) std::copy_n(mask, width_, columns.data());
    if (count > 1)
      for (int u = 0; u < width_; ++u) columns[n + u] = mask[u] * star[u];
    sums.add(columns.data(), n);
  }
  for (int k = 0; k < count; ++k) sums.eliminate(k);
  return std::sqrt(std::max(0.0, sums.at(count, count)) / pixels_);
}

}  // namespace aras_visual_servo_camera
