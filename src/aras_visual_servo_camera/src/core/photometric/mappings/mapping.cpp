#include "photometric/mappings/mapping.hpp"

#include <algorithm>

#include "photometric/column_sums.hpp"

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
  const int columns = static_cast<int>(pixels.columns.size());
  std::vector<std::vector<double>> mapped;
  for (const cv::Mat& column : pixels.columns) mapped.push_back(project(column, stage));
  ColumnSums sums(columns);
  sums.add(mapped);
  for (int k = 6; k < columns - 1; ++k) sums.eliminate(k);
  NormalEquations out;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) out.H(i, j) = sums.at(i, j);
    out.b[i] = sums.at(i, columns - 1);
  }
  out.cost = 0.5 * std::max(0.0, sums.at(columns - 1, columns - 1));
  return out;
}

}  // namespace aras_visual_servo_camera
