#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "photometric/mappings/mapping.hpp"

namespace aras_visual_servo_camera {
namespace {

constexpr double kNothing = 1e-9;  // of the largest eigenvalue: a direction with less is rounding

// Grey levels in one row, padded so that they can be summed in lanes.
std::vector<float> rowOf(const cv::Mat& image) {
  std::vector<float> out(padded(static_cast<int>(image.total())), 0.0f);
  for (int v = 0; v < image.rows; ++v)
    std::copy_n(image.ptr<float>(v), image.cols, out.data() + static_cast<std::size_t>(v) * image.cols);
  return out;
}

double inner(const std::vector<float>& a, const std::vector<float>& b) {
  constexpr std::size_t kBlock = 1024;  // of single precision; blocks are added in double precision
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); i += kBlock)
    sum += dotOf(a.data() + i, b.data() + i, static_cast<int>(std::min(kBlock, a.size() - i)));
  return sum;
}

/** The principal components of views about the goal, which are drawn from the goal's image (T81). */
class Pca : public LinearMapping {
 public:
  explicit Pca(const PcaConfig& config) : config_(config) {}

  void setReference(const MappedPixels& pixels, const LevelView& view) override { learn(draw(pixels, view)); }

  std::vector<double> project(const cv::Mat& image, int) const override {
    const std::vector<float> row = rowOf(image);
    std::vector<double> out;
    for (const std::vector<float>& direction : directions_) out.push_back(inner(direction, row));
    return out;
  }

 private:
  // The views, less their mean.
  std::vector<std::vector<float>> draw(const MappedPixels& pixels, const LevelView& view) const {
    std::mt19937 random(static_cast<std::uint32_t>(config_.seed));
    const auto uniform = [&] { return 2.0 * (random() / 4294967295.0) - 1.0; };
    const std::vector<cv::Vec3d> rays = raysOf(pixels.mask, view);
    std::vector<std::vector<float>> views;
    for (int k = 0; k < config_.views; ++k) {
      cv::Vec3d p, turn;
      for (int i = 0; i < 3; ++i) p[i] = uniform() * config_.spread / view.plane.C;
      for (int i = 0; i < 3; ++i) turn[i] = uniform() * config_.spread;
      cv::Mat seen = drawn(pixels.reference, rays, view, p, turn);
      seen = seen.mul(pixels.mask);
      views.push_back(rowOf(seen));
    }
    std::vector<float> mean(views[0].size(), 0.0f);
    for (const auto& one : views)
      for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += one[i];
    for (auto& one : views)
      for (std::size_t i = 0; i < mean.size(); ++i) one[i] -= mean[i] / static_cast<float>(config_.views);
    return views;
  }

  // (x, y, 1) of each pixel; (0, 0, 0) where no ray reaches it.
  static std::vector<cv::Vec3d> raysOf(const cv::Mat& mask, const LevelView& view) {
    std::vector<cv::Vec3d> out;
    for (int v = 0; v < mask.rows; ++v) {
      for (int u = 0; u < mask.cols; ++u) {
        const auto ray = view.intrinsics.undistort(view.pitch * (u + view.border), view.pitch * (v + view.border));
        out.push_back(ray.valid ? cv::Vec3d(ray.x, ray.y, 1.0) : cv::Vec3d());
      }
    }
    return out;
  }

  // The reference as a camera displaced by p and turned by `turn` sees it; beyond its rim it is mirrored.
  static cv::Mat drawn(const cv::Mat& reference, const std::vector<cv::Vec3d>& rays, const LevelView& view,
                       const cv::Vec3d& p, const cv::Vec3d& turn) {
    const cv::Vec3d n(view.plane.A, view.plane.B, view.plane.C);
    const double angle = cv::norm(turn), s = angle > 0.0 ? std::sin(angle) / angle : 1.0;
    const double c = angle > 0.0 ? (1.0 - std::cos(angle)) / (angle * angle) : 0.5;
    cv::Mat at_u(reference.size(), CV_32F), at_v(reference.size(), CV_32F);
    for (int v = 0; v < reference.rows; ++v) {
      for (int u = 0; u < reference.cols; ++u) {
        const cv::Vec3d d = rays[static_cast<std::size_t>(v) * reference.cols + u], turned = turn.cross(d);
        const cv::Vec3d way = d + s * turned + c * turn.cross(turned);  // Rodrigues' formula
        const double depth = (1.0 - n.dot(p)) / n.dot(way);
        const cv::Vec3d point = p + depth * way;
        std::array<double, 2> px = {-1.0, -1.0};
        const double x = point[0] / point[2], y = point[1] / point[2];
        if (depth > 0.0 && point[2] > 0.0 && view.intrinsics.isWithinFold(x, y)) px = view.intrinsics.project(x, y);
        const auto within = [](double place) { return static_cast<float>(std::clamp(place, -1e4, 1e4)); };
        at_u.at<float>(v, u) = within(px[0] / view.pitch - view.border);
        at_v.at<float>(v, u) = within(px[1] / view.pitch - view.border);
      }
    }
    cv::Mat out;
    cv::remap(reference, out, at_u, at_v, cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
    return out;
  }

  // The eigenvectors of X^T X by those of X X^T, which is as small as there are few views.
  void learn(const std::vector<std::vector<float>>& views) {
    const int count = static_cast<int>(views.size());
    cv::Mat products(count, count, CV_64F), values, vectors;
    for (int i = 0; i < count; ++i)
      for (int j = i; j < count; ++j) products.at<double>(i, j) = products.at<double>(j, i) = inner(views[i], views[j]);
    cv::eigen(products, values, vectors);  // descending; eigenvectors are rows
    directions_.clear();
    for (int k = 0; k < config_.components; ++k) {
      const double value = values.at<double>(k);
      if (!(value > kNothing * values.at<double>(0))) break;
      std::vector<float> direction(views[0].size(), 0.0f);
      for (int i = 0; i < count; ++i) {
        const float weight = static_cast<float>(vectors.at<double>(k, i) / std::sqrt(value));
        for (std::size_t pixel = 0; pixel < direction.size(); ++pixel) direction[pixel] += weight * views[i][pixel];
      }
      directions_.push_back(std::move(direction));
    }
    if (directions_.size() < 6)
      throw DegenerateFeature("photometric reference: found views about the goal with " +
                              std::to_string(directions_.size()) + " principal components, allowed 6 at least");
  }

  PcaConfig config_;
  std::vector<std::vector<float>> directions_;  // of length 1, at right angles to each other
};

}  // namespace

std::unique_ptr<PhotometricMapping> makePca(const PcaConfig& config) { return std::make_unique<Pca>(config); }

}  // namespace aras_visual_servo_camera
