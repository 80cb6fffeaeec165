#include "photometric/column_sums.hpp"

namespace aras_visual_servo_camera {
namespace {

float dot(const float* a, const float* b, int n) {
  float lane[ColumnSums::kLanes] = {};
  for (int u = 0; u < n; u += ColumnSums::kLanes)
    for (int k = 0; k < ColumnSums::kLanes; ++k) lane[k] += a[u + k] * b[u + k];
  for (int half = ColumnSums::kLanes / 2; half > 0; half /= 2)
    for (int k = 0; k < half; ++k) lane[k] += lane[k + half];
  return lane[0];
}

}  // namespace

void ColumnSums::add(const float* data, int n) {
  for (int i = 0; i < columns_; ++i)
    for (int j = i; j < columns_; ++j) sums_[i * kMaxColumns + j] += dot(data + i * n, data + j * n, n);
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
