#pragma once

#include <string>
#include <vector>

#include "aras_visual_servo_camera/image/object_mask.hpp"
#include "aras_visual_servo_camera/image/pixel_map.hpp"

namespace aras_visual_servo_camera {

/** Moments of order i + j <= order in the sequence 00 10 01 20 11 02 30 21 12 03 ... */
constexpr int momentCount(int order) { return (order + 1) * (order + 2) / 2; }
constexpr int momentIndex(int i, int j) { return (i + j) * (i + j + 1) / 2 + j; }
std::vector<std::string> momentNames(int order);

/** Raw moments m_ij = sum of x^i y^j dA of an object in one image, normalised coordinates, in one pass over its pixels.
 *
 *  Where the mask has soft edges, each pixel's part of the object is summed at its own centroid, and the second moments
 *  that such a part has about its centroid are added (T63). Hard-edged masks are samples of the object at the centres
 * of pixels. */
class MomentAccumulator {
 public:
  /** @param map  must outlive the accumulator. @param order  >= 0 */
  MomentAccumulator(const PixelMap& map, int order);

  /** @return m, momentCount(order) values. @throws ShapeError if the mask's size is not the map's */
  const std::vector<double>& process(const ObjectMask& mask);

  int order() const { return order_; }
  /** True when the last object covers pixels that no ray of the lens model reaches: it is cut off there. */
  bool leftTheLens() const { return left_the_lens_; }

 private:
  void sumSeparable(const ObjectMask& mask);
  void sumPixels(const ObjectMask& mask);
  void addPixel(const PixelMap::Pixel& pixel, double weight);
  void addPixelExtent(const ObjectMask& mask);

  const PixelMap& map_;
  int order_;
  bool left_the_lens_ = false;
  std::vector<double> prefix_;  // separable: prefix_[u (order + 1) + i] = sum of x^i over the pixels left of u
  std::vector<double> row_;     // separable: row_[i] = sum over one row of w x^i
  std::vector<double> m_;       // what process() returns
};

}  // namespace aras_visual_servo_camera
