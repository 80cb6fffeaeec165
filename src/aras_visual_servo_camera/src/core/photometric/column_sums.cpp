#include "photometric/column_sums.hpp"

namespace aras_visual_servo_camera {

float dotOf(const float* a, const float* b, int n) {
  float lane[ColumnSums::kLanes] = {};
  for (int u = 0; u < n; u += ColumnSums::kLanes)
    for (int k = 0; k < ColumnSums::kLanes; ++k) lane[k] += a[u + k] * b[u + k];
  for (int half = ColumnSums::kLanes / 2; half > 0; half /= 2)
    for (int k = 0; k < half; ++k) lane[k] += lane[k + half];
  return lane[0];
}

void ColumnSums::add(const float* data, int n) {
  for (int i = 0; i < columns_; ++i)
    for (int j = i; j < columns_; ++j) sums_[i * kMaxColumns + j] += dotOf(data + i * n, data + j * n, n);
}

void ColumnSums::add(const std::vector<std::vector<double>>& data) {
  for (int i = 0; i < columns_; ++i) {
    for (int j = i; j < columns_; ++j) {
      double sum = 0.0;
      for (std::size_t k = 0; k < data[i].size(); ++k) sum += data[i][k] * data[j][k];
      sums_[i * kMaxColumns + j] += sum;
    }
  }
}

void ColumnSums::eliminate(int k) {
  constexpr double kRounding = 1e-6;  // of the sums along a row
  const double pivot = at(k, k);
  if (!(pivot > 0.0)) return;
  std::array<double, kMaxColumns> row{};
  for (int i = 0; i < columns_; ++i) row[i] = at(k, i);
  for (int i = 0; i < columns_; ++i) {
    for (int j = i; j < columns_; ++j) {
      double& sum = sums_[i * kMaxColumns + j];
      const double before = sum;
      sum -= row[i] * row[j] / pivot;
      if (i == j && sum < kRounding * before) sum = 0.0;  // explained wholly
    }
  }
}

}  // namespace aras_visual_servo_camera
