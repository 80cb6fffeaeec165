#include "photometric/normal_equations.hpp"

#include <cmath>
#include <limits>

namespace aras_visual_servo_camera {
namespace {

constexpr double kMaxCondition = 1e6;  // of L, its columns scaled: beyond, sums of single precision tell nothing

}  // namespace

GaussNewton solve(const NormalEquations& equations, int pixels, double smallest) {
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

}  // namespace aras_visual_servo_camera
