#include "picture_corners.hpp"

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/config/wide.hpp"

namespace aras_visual_servo_sim {
namespace {

/** A row of corners, m = first + i * step. */
template <int count>
inline __attribute__((always_inline)) void divideRow(const double* first, const double* step, double* s, double* t) {
  for (int i = 0; i < count; ++i) {
    const double scale = 1.0 / (first[2] + double(i) * step[2]);
    s[i] = (first[0] + double(i) * step[0]) * scale;
    t[i] = (first[1] + double(i) * step[1]) * scale;
  }
}
ARAS_WIDE void divide9(const double* first, const double* step, double* s, double* t) {
  divideRow<9>(first, step, s, t);
}
ARAS_WIDE void divide17(const double* first, const double* step, double* s, double* t) {
  divideRow<17>(first, step, s, t);
}

}  // namespace

Eigen::Matrix3d raysOfPixels(const CameraModel& camera) {
  Eigen::Matrix3d rays;
  rays << 1.0 / camera.fx(), 0.0, -camera.cx() / camera.fx(), 0.0, 1.0 / camera.fy(), -camera.cy() / camera.fy(), 0.0,
      0.0, 1.0;
  return rays;
}

template <int size>
bool PictureCorners<size>::project(const CameraModel& camera, const Eigen::Matrix3d& T,
                                   const Eigen::Matrix3d& pixels_to_picture, const PixelBox& tile, double least) {
  columns_ = tile.u1 - tile.u0;
  rows_ = tile.v1 - tile.v0;
  const bool straight = camera.lens() == CameraModel::Lens::kNone;
  const Eigen::Vector3d step = pixels_to_picture.col(0);
  for (int j = 0; j <= rows_; ++j) {
    double *s = &s_[j * kStride], *t = &t_[j * kStride];
    if (straight) {
      const Eigen::Vector3d first = pixels_to_picture * Eigen::Vector3d(tile.u0 - 0.5, tile.v0 + j - 0.5, 1.0);
      // Linear: what holds for the ends holds between them.
      if (!(first.z() > least && first.z() + double(columns_) * step.z() > least)) return false;
      (size == 8 ? divide9 : divide17)(first.data(), step.data(), s, t);
    } else {
      const Eigen::Vector3d* ray =
          camera.cornerRays().data() + std::size_t(tile.v0 + j) * (camera.width() + 1) + tile.u0;
      for (int i = 0; i <= columns_; ++i, ++ray) {
        const Eigen::Vector3d m = T * *ray;
        if (!(m.z() > least)) return false;
        s[i] = m.x() * (1.0 / m.z());
        t[i] = m.y() * (1.0 / m.z());
      }
    }
    std::fill(s + columns_, s + kStride, s[columns_]);
    std::fill(t + columns_, t + kStride, t[columns_]);
  }
  for (int j = rows_ + 1; j < kStride; ++j) {
    std::copy_n(&s_[rows_ * kStride], kStride, &s_[j * kStride]);
    std::copy_n(&t_[rows_ * kStride], kStride, &t_[j * kStride]);
  }
  measure(straight);
  return true;
}

/** Sets low_, high_ and longest_. @param straight  squares become convex, and smaller from one side to the other: the
 *  first and last ones tell all */
template <int size>
void PictureCorners<size>::measure(bool straight) {
  const int step_u = straight ? columns_ : 1, step_v = straight ? rows_ : 1;
  low_ = high_ = at(0, 0).array();
  longest_.setOnes();
  for (int j = 0; j <= rows_; j += step_v) {
    for (int i = 0; i <= columns_; i += step_u) {
      const Eigen::Array2d corner = at(i, j).array();
      low_ = low_.min(corner);
      high_ = high_.max(corner);
      longest_ = longest_.max((corner - at(i > 0 ? i - 1 : i + 1, j).array()).abs())
                     .max((corner - at(i, j > 0 ? j - 1 : j + 1).array()).abs());
    }
  }
}

template class PictureCorners<8>;
template class PictureCorners<16>;

}  // namespace aras_visual_servo_sim
