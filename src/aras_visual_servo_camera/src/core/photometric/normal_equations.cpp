#include "photometric/normal_equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aras_visual_servo_camera {

GaussNewton solve(const NormalEquations& equations, int pixels, double smallest) {
  constexpr double kMaxCondition = 1e6;  // of L, its columns scaled: beyond, sums of single precision tell nothing
  GaussNewton out;
  out.condition = std::numeric_limits<double>::infinity();
  cv::Vec6d scale;
  for (int i = 0; i < 6; ++i) {
    if (!(equations.H(i, i) > smallest * smallest * pixels)) return out;
    scale[i] = 1.0 / std::sqrt(equations.H(i, i));
  }
  cv::Matx66d scaled, vectors;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) scaled(i, j) = scale[i] * equations.H(i, j) * scale[j];
  cv::Vec6d values;
  cv::eigen(scaled, values, vectors);  // descending; eigenvectors are rows
  if (!(values[5] > 0.0)) return out;
  out.condition = std::sqrt(values[0] / values[5]);
  out.solvable = out.condition < kMaxCondition;
  for (int k = 0; k < 6; ++k) {
    double along = 0.0;
    for (int i = 0; i < 6; ++i) along += vectors(k, i) * scale[i] * equations.b[i];
    for (int i = 0; i < 6; ++i) out.step[i] -= vectors(k, i) * scale[i] * along / values[k];
  }
  return out;
}

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

NormalEquations ColumnSums::equations() {
  const int last = columns_ - 1;
  for (int k = 6; k < last; ++k) eliminate(k);
  NormalEquations out;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) out.H(i, j) = at(i, j);
    out.b[i] = at(i, last);
  }
  out.cost = 0.5 * std::max(0.0, at(last, last));
  return out;
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
