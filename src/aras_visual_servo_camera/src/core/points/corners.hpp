#pragma once

#include <cstdint>
#include <vector>

#include "aras_visual_servo_camera/image/object_mask.hpp"
#include "aras_visual_servo_camera/image/pixel_map.hpp"
#include "points/point_tracker.hpp"

namespace aras_visual_servo_camera {

/** Corners of an object's polygonal outline, to a small part of a pixel.
 *
 *  The outline is cut at the corners of a coarse polygon (Douglas and Peucker). Between two corners, each row or column
 *  that crosses the edge gives one point of it: the sum of the coverage weights across the edge is where a straight
 *  edge passes, exactly (docs/theory.md T36). Lines through these points, the lens undone, meet in the corners. */
class CornerFinder {
 public:
  /** @param map  must outlive the finder. @param count  corners of the outline, >= 3 */
  CornerFinder(const PixelMap& map, int count) : map_(map), count_(count) {}

  /** @return `count` corners, clockwise on the screen; empty if the object is cut by the border or the outline is not
   *      a polygon of so many corners with straight edges */
  std::vector<ImagePoint> find(const ObjectMask& mask);

 private:
  struct Pixel {
    int u, v;
  };
  struct Line {
    double x, y, dx, dy;  // a point and a unit direction [-]
  };

  bool paint(const ObjectMask& mask);
  bool traceOutline();
  bool coarseCorners();
  bool fitEdge(std::size_t first, std::size_t last, Line* line);
  bool crossing(const Pixel& at, bool along_v, ImagePoint* point) const;
  bool throughPoints(Line* line);
  float weight(int u, int v) const { return weights_[static_cast<std::size_t>(v - v0_) * width_ + (u - u0_)]; }

  const PixelMap& map_;
  int count_;
  // Buffers: the object's box, widened; its outline in pixels and, lens undone, in pixels of an ideal camera.
  int u0_ = 0, v0_ = 0, width_ = 0, height_ = 0;
  std::vector<float> weights_;
  std::vector<Pixel> outline_;
  std::vector<float> ideal_;  // u, v of each pixel of the outline
  std::vector<std::size_t> corners_;
  std::vector<ImagePoint> samples_;
  std::vector<double> distances_;
};

}  // namespace aras_visual_servo_camera
