#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "aras_visual_servo_camera/config/vision_config.hpp"

namespace aras_visual_servo_camera {

using Vector6 = std::array<double, 6>;

/** H = L^T L and b = L^T e of one image, after the changes that the illumination explains have been removed. */
struct NormalEquations {
  cv::Matx66d H;
  Vector6 b{};
  double cost = 0.0;  ///< e^T e / 2, grey levels squared
};

/** Solution of H step = -b. */
struct GaussNewton {
  bool solvable = false;   ///< six motions are told apart
  double condition = 0.0;  ///< of L, its columns scaled to length 1; infinite if it is singular
  Vector6 step{};          ///< -H^-1 b [m, rad]
};

/** @param smallest  a column of L shorter than this, per pixel, tells nothing [grey levels per m, rad] */
GaussNewton solve(const NormalEquations& equations, int pixels, double smallest);

/** Products of all pairs of up to nine columns, summed over many pixels in a fixed order.
 *
 *  Rows of pixels are added one after the other: within one, sums of single precision in kLanes interleaved parts, so
 * that they can be vectorised without the compiler changing the order; over the rows, sums of double precision. */
class ColumnSums {
 public:
  static constexpr int kLanes = 16, kMaxColumns = 9;

  explicit ColumnSums(int columns) : columns_(columns) {}

  /** @param data  columns one after the other, n values each; n a multiple of kLanes */
  void add(const float* data, int n);

  /** @param data  the columns, all of one length */
  void add(const std::vector<std::vector<double>>& data);

  double at(int i, int j) const { return sums_[i < j ? i * kMaxColumns + j : j * kMaxColumns + i]; }

  /** Those of six columns of L and of e, the last column, once what the columns between them explain is removed. */
  NormalEquations equations();

  /** Remove from every column the part that column k explains (Schur complement). A column k of zeros removes nothing.
   */
  void eliminate(int k);

 private:
  int columns_;
  std::array<double, kMaxColumns * kMaxColumns> sums_{};  // i <= j
};

/** Sum of products of single precision in a fixed order; n a multiple of ColumnSums::kLanes. */
float dotOf(const float* a, const float* b, int n);

/** n rounded up to a multiple of kLanes. */
constexpr int padded(int n) { return (n + ColumnSums::kLanes - 1) / ColumnSums::kLanes * ColumnSums::kLanes; }

/** Columns that explain a change of illumination: none, 1, or 1 and I*. */
constexpr int illuminationColumns(Illumination illumination) { return static_cast<int>(illumination); }

}  // namespace aras_visual_servo_camera
