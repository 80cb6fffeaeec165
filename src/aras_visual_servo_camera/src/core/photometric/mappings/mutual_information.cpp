#include <algorithm>
#include <array>
#include <cmath>

#include "photometric/mappings/mapping.hpp"

namespace aras_visual_servo_camera {
namespace {

constexpr double kGreys = 255.0;
constexpr double kEmpty = 1e-12;  // a probability below this is none

// The four cubic B-splines that are not zero at a place between the middles of two bins, with their slopes.
struct Spline {
  int first;
  double value[4], slope[4];

  Spline(double grey, int bins) {
    const double place = std::clamp(grey, 0.0, kGreys) * (bins - 1) / kGreys;
    first = std::min(static_cast<int>(place), bins - 2);  // bins are counted with one more below the first
    const double t = place - first, s = 1.0 - t;
    value[0] = s * s * s / 6.0;
    value[1] = (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0;
    value[2] = (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0;
    value[3] = t * t * t / 6.0;
    slope[0] = -0.5 * s * s;
    slope[1] = t * (1.5 * t - 2.0);
    slope[2] = s * (2.0 - 1.5 * s);
    slope[3] = 0.5 * t * t;
  }
};

/** Mutual information of image and reference, over histograms of cubic B-splines (T84).
 *
 *  What H and b stand for here: b is the gradient of the information that is missing, less what it is at the goal, and
 * H its Hessian at the goal, both learnt from the reference. The gradient is not quite zero at the goal, because the
 * splines blur the histogram and greys come and go at the rim. Both are multiplied by pixels times the square of a
 * bin's width, which makes them of the size of those of the grey levels.
 */
class MutualInformation : public PhotometricMapping {
 public:
  explicit MutualInformation(const MutualInformationConfig& config) : bins_(config.bins), size_(config.bins + 2) {}

  void setReference(const MappedPixels& pixels, const LevelView&) override {
    const Joint joint(pixels, *this);
    most_ = joint.information();
    hessian_ = joint.hessian(pixels);
    at_goal_ = joint.gradient(pixels);
  }

  NormalEquations equations(const MappedPixels& pixels, int) const override {
    const Joint joint(pixels, *this);
    NormalEquations out;
    out.H = hessian_;
    out.b = joint.gradient(pixels);
    for (int k = 0; k < 6; ++k) out.b[k] -= at_goal_[k];
    out.cost = joint.scale * (most_ - joint.information());
    return out;
  }

 private:
  // Of the greys of image (rows) and reference (columns): how probable each pair is, and each grey of the image.
  struct Joint {
    Joint(const MappedPixels& pixels, const MutualInformation& mapping)
        : bins(mapping.bins_), size(mapping.size_), pairs(size * size, 0.0), ours(size, 0.0), theirs(size, 0.0) {
      double count = 0.0;
      forEach(pixels, [&](int, int, const Spline& now, const Spline& star) {
        count += 1.0;
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 4; ++j) pairs[(now.first + i) * size + star.first + j] += now.value[i] * star.value[j];
      });
      per_pixel = count > 0.0 ? 1.0 / count : 0.0;
      const double width = kGreys / (bins - 1);
      scale = count * width * width;
      for (int i = 0; i < size; ++i) {
        for (int j = 0; j < size; ++j) {
          pairs[i * size + j] *= per_pixel;
          ours[i] += pairs[i * size + j];
          theirs[j] += pairs[i * size + j];
        }
      }
      // The logarithm by which the probability of a pair counts in the slope of the information.
      logs.assign(pairs.size(), 0.0);
      for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
          if (pairs[i * size + j] > kEmpty) logs[i * size + j] = std::log(pairs[i * size + j] / ours[i]);
    }

    template <typename Act>
    void forEach(const MappedPixels& pixels, Act act) const {
      for (int v = 0; v < pixels.mask.rows; ++v) {
        const float *now = pixels.image.ptr<float>(v), *star = pixels.reference.ptr<float>(v);
        const float* mask = pixels.mask.ptr<float>(v);
        for (int u = 0; u < pixels.mask.cols; ++u)
          if (mask[u] != 0.0f) act(u, v, Spline(now[u], bins), Spline(star[u], bins));
      }
    }

    double information() const {
      double sum = 0.0;
      for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
          if (pairs[i * size + j] > kEmpty) sum += pairs[i * size + j] * (logs[i * size + j] - std::log(theirs[j]));
      return sum;
    }

    // Of -scale times the information, by the six motions.
    Vector6 gradient(const MappedPixels& pixels) const {
      Vector6 out{};
      forEach(pixels, [&](int u, int v, const Spline& now, const Spline& star) {
        double weight = 0.0;
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 4; ++j)
            weight += now.slope[i] * star.value[j] * logs[(now.first + i) * size + star.first + j];
        for (int k = 0; k < 6; ++k) out[k] -= weight * pixels.columns[k].at<float>(v, u);
      });
      for (double& one : out) one *= per_pixel * scale * (bins - 1) / kGreys;
      return out;
    }

    // At the goal, where image and reference are one: the derivative by the motion of one of them and that of the
    // other, which is minus that by either of them twice, since information does not change when both move alike.
    cv::Matx66d hessian(const MappedPixels& pixels) const {
      std::vector<std::array<double, 6>> by_ours(pairs.size(), std::array<double, 6>{}), by_theirs = by_ours;
      cv::Matx66d out = cv::Matx66d::zeros();
      forEach(pixels, [&](int u, int v, const Spline& now, const Spline& star) {
        double L[6], weight = 0.0;
        for (int k = 0; k < 6; ++k) L[k] = pixels.columns[k].at<float>(v, u);
        for (int i = 0; i < 4; ++i) {
          for (int j = 0; j < 4; ++j) {
            const int pair = (now.first + i) * size + star.first + j;
            weight += now.slope[i] * star.slope[j] * logs[pair];
            for (int k = 0; k < 6; ++k) {
              by_ours[pair][k] += now.slope[i] * star.value[j] * L[k];
              by_theirs[pair][k] += now.value[i] * star.slope[j] * L[k];
            }
          }
        }
        for (int k = 0; k < 6; ++k)
          for (int l = 0; l < 6; ++l) out(k, l) += weight * L[k] * L[l];
      });
      for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
        if (pairs[pair] <= kEmpty) continue;
        for (int k = 0; k < 6; ++k)
          for (int l = 0; l < 6; ++l)
            out(k, l) += 0.5 * per_pixel / pairs[pair] *
                         (by_ours[pair][k] * by_theirs[pair][l] + by_theirs[pair][k] * by_ours[pair][l]);
      }
      const double width = kGreys / (bins - 1);
      return out * (per_pixel * scale / (width * width));
    }

    int bins, size;
    std::vector<double> pairs, ours, theirs, logs;
    double per_pixel = 0.0, scale = 0.0;
  };

  int bins_, size_;
  double most_ = 0.0;  // the information at the goal [nat]
  cv::Matx66d hessian_;
  Vector6 at_goal_{};  // the gradient there
};

}  // namespace

std::unique_ptr<PhotometricMapping> makeMutualInformation(const MutualInformationConfig& config) {
  return std::make_unique<MutualInformation>(config);
}

}  // namespace aras_visual_servo_camera
