#include <algorithm>
#include <cmath>
#include <string>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "photometric/mappings/mapping.hpp"

namespace aras_visual_servo_camera {
namespace {

// The first `count` cosines of a row of n pixels, of length 1 each (DCT-II).
std::vector<Window> cosines(int n, int count) {
  std::vector<Window> out;
  for (int k = 0; k < count; ++k) {
    Window window{0, std::vector<float>(n)};
    const double scale = std::sqrt((k == 0 ? 1.0 : 2.0) / n);
    for (int i = 0; i < n; ++i) window.weights[i] = static_cast<float>(scale * std::cos(M_PI * k * (i + 0.5) / n));
    out.push_back(std::move(window));
  }
  return out;
}

// The first indices of a rectangle in the order of the zig-zag: diagonal by diagonal, to and fro.
std::vector<std::pair<int, int>> zigZag(int width, int height, int count) {
  std::vector<std::pair<int, int>> out;
  for (int sum = 0; sum < width + height - 1; ++sum) {
    const int first = std::max(0, sum - height + 1), last = std::min(sum, width - 1);
    for (int k = first; k <= last && static_cast<int>(out.size()) < count; ++k) {
      const int u = sum % 2 == 0 ? k : first + last - k;
      out.emplace_back(u, sum - u);
    }
  }
  return out;
}

/** Coefficients of the cosine transform of the image, the lowest frequencies (T82). */
class Dct : public LinearMapping {
 public:
  explicit Dct(const DctConfig& config) : config_(config) {}

  void setReference(const MappedPixels& pixels, const LevelView&) override {
    const int width = pixels.mask.cols, height = pixels.mask.rows;
    if (config_.coefficients > width * height)
      throw ParameterError("vision.photometric.dct.coefficients: found " + std::to_string(config_.coefficients) +
                           ", allowed at most " + std::to_string(width * height) +
                           ", the pixels of the coarsest level");
    const std::vector<std::pair<int, int>> kept = zigZag(width, height, config_.coefficients);
    int along_u = 0, along_v = 0;
    for (const auto& [u, v] : kept) {
      along_u = std::max(along_u, u + 1);
      along_v = std::max(along_v, v + 1);
    }
    sums_ = SeparableSums(cosines(width, along_u), cosines(height, along_v), kept);
  }

  std::vector<double> project(const cv::Mat& image, int) const override { return sums_.of(image); }

 private:
  DctConfig config_;
  SeparableSums sums_;
};

}  // namespace

std::unique_ptr<PhotometricMapping> makeDct(const DctConfig& config) { return std::make_unique<Dct>(config); }

}  // namespace aras_visual_servo_camera
