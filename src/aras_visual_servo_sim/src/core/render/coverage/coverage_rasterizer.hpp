#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/image/image.hpp"
#include "render/view/pixel_box.hpp"

namespace aras_visual_servo_sim {

/** Fills closed outlines with a colour, each pixel in proportion to the area of it that is covered.
 *
 *  Coverage is the exact integral of the winding number over the pixel square, by accumulating for every edge the
 *  signed area to its right and summing along rows: no samples are taken. Outlines may lie partly or wholly outside the
 *  image. Either orientation will do, but outlines of one fill must be oriented alike and not overlap. */
class CoverageRasterizer {
 public:
  enum class Rule { kCoverage, kCenter };  ///< kCenter: all or nothing, by the pixel's centre

  /** Starts a fill in an image of this size. */
  void begin(int width, int height, Rule rule);
  /** One edge, in pixel coordinates (pixel (u, v) covers [u - 1/2, u + 1/2]^2). Edges must form closed loops.
   *  Coordinates beyond 1e7 are drawn as 1e7, and what is no number as -1e7: no corner can harm. */
  void addEdge(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  /** Pixels that the edges so far can touch, clipped to the image. */
  PixelBox bounds() const;
  /** Blends the colour over image (channels as the image has) and ends the fill. */
  template <typename Value>
  void blend(const std::array<Value, 3>& color, ImageOf<Value>& image);
  /** The same with a colour for each pixel. @param colors  of the size and encoding of image; read inside bounds() */
  template <typename Value>
  void blend(const ImageOf<Value>& colors, ImageOf<Value>& image);
  /** Hands out runs of pixels u0 <= u < u1 of row v, covered by half or more, and ends the fill. */
  void forEachRun(const std::function<void(int u0, int u1, int v)>& visit);

 private:
  struct Edge {
    double x0, y0, x1, y1;  // shifted by 1/2: pixel u covers [u, u + 1]
  };
  template <typename BlendRow>
  void fill(const BlendRow& blend_row);
  void accumulate(const Edge& edge, const PixelBox& box, std::size_t stride);
  void accumulateRow(float* row, double columns, double x0, double x1, double dy);
  void accumulateCenters(const Edge& edge, const PixelBox& box, std::size_t stride);

  int width_ = 0, height_ = 0;
  Rule rule_ = Rule::kCoverage;
  double x_min_ = 0.0, x_max_ = 0.0, y_min_ = 0.0, y_max_ = 0.0;
  std::vector<Edge> edges_;
  std::vector<float> accumulator_;  // all zero between fills
};

/** Blackens what lies beyond the lens's circle, its border by exact coverage. @pre camera.showsLensCircle() */
template <typename Value>
void blackenBeyondLens(const CameraModel& camera, CoverageRasterizer& rasterizer, ImageOf<Value>& image);

/** How coverage is counted in images of a camera. */
inline CoverageRasterizer::Rule ruleOf(const CameraModel& camera) {
  return camera.sampling() == CameraModel::Sampling::kCenter ? CoverageRasterizer::Rule::kCenter
                                                             : CoverageRasterizer::Rule::kCoverage;
}

}  // namespace aras_visual_servo_sim
