#include <algorithm>
#include <cmath>

#include "photometric/mappings/mapping.hpp"

namespace aras_visual_servo_camera {
namespace {

constexpr double kReach = 4.0;  // standard deviations that a Gaussian reaches here; beyond is 0.03 % of its peak

// One Gaussian about every pitch-th of n pixels. Their squares add up as those of the smoothed pixels would.
std::vector<Window> gaussians(int n, double extension) {
  const int pitch = std::max(1, static_cast<int>(std::floor(extension)));
  const int count = std::max(1, n / pitch), begin = (n - 1 - (count - 1) * pitch) / 2;
  const double scale = std::sqrt(pitch) / (extension * std::sqrt(2.0 * M_PI));
  std::vector<Window> out;
  for (int k = 0; k < count; ++k) {
    const int middle = begin + k * pitch, reach = static_cast<int>(std::ceil(kReach * extension));
    const int first = std::max(0, middle - reach), last = std::min(n - 1, middle + reach);
    Window window{first, {}};
    for (int i = first; i <= last; ++i) {
      const double away = (i - middle) / extension;
      window.weights.push_back(static_cast<float>(scale * std::exp(-0.5 * away * away)));
    }
    out.push_back(std::move(window));
  }
  return out;
}

/** The photometric Gaussian mixture: every pixel is a Gaussian whose height is its grey level (T83).
 *
 *  What is compared is their sum, at places as far apart as the Gaussians extend: what lies between is known from these
 *  but for less than 1 % (the spectrum of a Gaussian at half the frequency of the places). */
class Mixture : public LinearMapping {
 public:
  explicit Mixture(const MixtureConfig& config) {
    for (double extension = config.extension_px; extension > config.final_extension_px; extension *= 0.5)
      extensions_.insert(extensions_.begin(), extension);
    extensions_.insert(extensions_.begin(), config.final_extension_px);
  }

  int stages() const override { return static_cast<int>(extensions_.size()); }
  double pitch(int stage) const override { return extensions_[stage]; }

  void setReference(const MappedPixels& pixels, const LevelView&) override {
    sums_.clear();
    for (const double extension : extensions_) {
      std::vector<Window> along_u = gaussians(pixels.mask.cols, extension);
      std::vector<Window> along_v = gaussians(pixels.mask.rows, extension);
      std::vector<std::pair<int, int>> all;
      for (int v = 0; v < static_cast<int>(along_v.size()); ++v)
        for (int u = 0; u < static_cast<int>(along_u.size()); ++u) all.emplace_back(u, v);
      sums_.emplace_back(std::move(along_u), std::move(along_v), std::move(all));
    }
  }

  std::vector<double> project(const cv::Mat& image, int stage) const override { return sums_[stage].of(image); }

 private:
  std::vector<double> extensions_;  // in pixels, the smallest first
  std::vector<SeparableSums> sums_;
};

}  // namespace

std::unique_ptr<PhotometricMapping> makeMixture(const MixtureConfig& config) {
  return std::make_unique<Mixture>(config);
}

}  // namespace aras_visual_servo_camera
