#pragma once

#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "pinhole_view.hpp"

namespace aras_visual_servo_sim {

/** How the image of a camera with a lens is put together from pictures without one.
 *
 *  A polynomial lens takes one picture ahead, the equidistant one the faces of a cube that it sees. Each picture is as
 *  large as the image needs. A pixel is interpolated where the ray through its centre, or the rays through the centres
 *  of its quarters, meet a picture. */
class LensMap {
 public:
  /** @param camera  with a lens  @param fine  pictures twice as fine, and four rays a pixel */
  LensMap(const CameraModel& camera, bool fine);

  const std::vector<PinholeView>& views() const { return views_; }

  /** @param pictures  of views(), in their order, pixels as Canvas::read gives them
   *  @param image     width x height of the camera; where no picture has anything it becomes black */
  template <typename Pixel>
  void resample(const std::vector<std::vector<Pixel>>& pictures, std::vector<Pixel>& image) const;

 private:
  /** Where one ray meets a picture. */
  struct Tap {
    std::int32_t first;        ///< index of the upper left of four pixels
    std::uint8_t view;         ///< kNone: the ray meets nothing
    std::uint8_t right, down;  ///< weights of the others, in 256ths
  };
  static constexpr std::uint8_t kNone = 255;

  std::vector<PinholeView> views_;
  std::vector<Tap> taps_;  // of each pixel one or four
  int rays_ = 1;
};

}  // namespace aras_visual_servo_sim
