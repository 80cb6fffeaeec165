#pragma once

#include <string>

#include "aras_visual_servo_camera/config/vision_config.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/image/object_mask.hpp"
#include "aras_visual_servo_camera/image/pixel_map.hpp"

namespace aras_visual_servo_camera {

/** Depths of points from the depth image: a plane is fitted to the pixels about a point, where 1/Z is linear in the
 *  normalised coordinates, and read at the point. So a corner has the depth of its object and not of what is behind. */
class DepthReader {
 public:
  /** @param map  must outlive the reader */
  DepthReader(const PixelMap& map, const DepthConfig& config) : map_(map), config_(config) {}

  /** Why there are no depths in this depth image, in words; "" if there may be. @param depth  null: none came */
  std::string fault(const DepthView* depth) const;

  /** Z of the point (x, y) [m], NaN where there is a hole. @param among  the pixels of its object; null: those whose
   *  depth is like that of the pixel under the point */
  double at(const DepthView& depth, double x, double y, const ObjectMask* among) const;

 private:
  /** The same from the pixels as far as `reach` along rows and columns. */
  double within(int reach, const DepthView& depth, double x, double y, const ObjectMask* among) const;

  const PixelMap& map_;
  DepthConfig config_;
};

}  // namespace aras_visual_servo_camera
