#include "photometric/mappings/mapping.hpp"

#include <algorithm>
#include <cstddef>

namespace aras_visual_servo_camera {

std::unique_ptr<PhotometricMapping> makeMapping(const PhotometricConfig& config) {
  switch (config.mapping) {
    case Mapping::kNone:
      return nullptr;
    case Mapping::kDct:
      return makeDct(config.dct);
    case Mapping::kMixture:
      return makeMixture(config.mixture);
    case Mapping::kPca:
      return makePca(config.pca);
    case Mapping::kMutualInformation:
      return makeMutualInformation(config.mutual_information);
  }
  return nullptr;
}

NormalEquations LinearMapping::equations(const MappedPixels& pixels, int stage) const {
  std::vector<std::vector<double>> mapped;
  for (const cv::Mat& column : pixels.columns) mapped.push_back(project(column, stage));
  ColumnSums sums(static_cast<int>(mapped.size()));
  sums.add(mapped);
  return sums.equations();
}

SeparableSums::SeparableSums(std::vector<Window> along_u, std::vector<Window> along_v,
                             std::vector<std::pair<int, int>> kept)
    : along_u_(std::move(along_u)), along_v_(std::move(along_v)), kept_(std::move(kept)) {
  for (Window& window : along_u_) window.weights.resize(padded(static_cast<int>(window.weights.size())), 0.0f);
}

std::vector<double> SeparableSums::of(const cv::Mat& image) const {
  const std::size_t n = along_u_.size();
  std::vector<float> row(padded(image.cols) + ColumnSums::kLanes, 0.0f);
  std::vector<double> rows(n * image.rows), grid(n * along_v_.size(), 0.0);
  for (int v = 0; v < image.rows; ++v) {
    std::copy_n(image.ptr<float>(v), image.cols, row.begin());
    for (std::size_t a = 0; a < n; ++a)
      rows[v * n + a] = dotOf(row.data() + along_u_[a].first, along_u_[a].weights.data(),
                              static_cast<int>(along_u_[a].weights.size()));
  }
  for (std::size_t b = 0; b < along_v_.size(); ++b) {
    for (std::size_t k = 0; k < along_v_[b].weights.size(); ++k) {
      const double weight = along_v_[b].weights[k];
      const double* from = rows.data() + (along_v_[b].first + k) * n;
      for (std::size_t a = 0; a < n; ++a) grid[b * n + a] += weight * from[a];
    }
  }
  std::vector<double> out;
  out.reserve(kept_.size());
  for (const auto& [a, b] : kept_) out.push_back(grid[b * n + a]);
  return out;
}

}  // namespace aras_visual_servo_camera
