#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim::testing {

/** No two texels alike: the hardest picture there is. */
inline TexturePtr noise(int width, int height) {
  std::mt19937 random(5);
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < 3 * width * height; ++k) rgb.push_back(static_cast<std::uint8_t>(random() % 256));
  return std::make_shared<Texture>("noise", width, height, rgb);
}

/** Of a convex polygon, either way round. */
inline double areaOf(const std::vector<Eigen::Vector2d>& polygon) {
  double twice = 0.0;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const Eigen::Vector2d a = polygon[k] - polygon[0], b = polygon[k + 1] - polygon[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

/** What lies of a convex polygon in low <= coordinate <= high. */
inline std::vector<Eigen::Vector2d> between(std::vector<Eigen::Vector2d> polygon, int axis, double low, double high) {
  for (const auto& [sign, limit] : {std::pair{1.0, low}, {-1.0, high}}) {
    std::vector<Eigen::Vector2d> kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Eigen::Vector2d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
      const double da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
      if (da >= 0.0) kept.push_back(a);
      if (da * db < 0.0) kept.push_back((a * db - b * da) / (db - da));
    }
    polygon.swap(kept);
  }
  return polygon;
}

/** Index of the texel that stands for the i-th of a row without end. */
inline int texelAt(Wrap wrap, int i, int size) {
  if (wrap == Wrap::kClamp) return std::clamp(i, 0, size - 1);
  const int period = wrap == Wrap::kMirror ? 2 * size : size;
  const int k = (i % period + period) % period;
  return k < size ? k : 2 * size - 1 - k;
}

/** Mean colour of what a convex polygon covers of a picture and its repetitions: cut along the sides of each texel. */
inline Eigen::Vector3d meanOfTexels(const MeshPicture& picture, const std::vector<Eigen::Vector2d>& polygon) {
  Eigen::Vector2d low = polygon[0], high = polygon[0];
  for (const Eigen::Vector2d& point : polygon) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int j = static_cast<int>(std::floor(low.y())); j < high.y(); ++j) {
    const std::vector<Eigen::Vector2d> row = between(polygon, 1, j, j + 1);
    for (int i = static_cast<int>(std::floor(low.x())); i < high.x(); ++i) {
      const std::uint8_t* rgb = picture.texture->texel(texelAt(picture.wrap_s, i, picture.texture->width()),
                                                       texelAt(picture.wrap_t, j, picture.texture->height()));
      sum += areaOf(between(row, 0, i, i + 1)) * Eigen::Vector3d(rgb[0], rgb[1], rgb[2]);
    }
  }
  return sum / areaOf(polygon);
}

}  // namespace aras_visual_servo_sim::testing
