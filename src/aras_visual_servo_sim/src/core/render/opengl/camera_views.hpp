#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/opengl/gl/canvas.hpp"
#include "render/opengl/view/lens_map.hpp"

namespace aras_visual_servo_sim {

/** The pictures that the image of one camera is made of, and the way from them to the image. */
class CameraViews {
 public:
  CameraViews(const GlFunctions& gl, const CameraModel& camera);

  const std::vector<PinholeView>& views() const { return views_; }
  const Canvas& canvas(std::size_t k) const { return *canvases_[k]; }
  /** Reads what was drawn. @param image  as many pixels as the camera has: bytes r, g, b, a */
  void read(std::vector<std::uint32_t>& image);

 private:
  std::unique_ptr<LensMap> lens_;  // none: one picture, of as many pixels or of twice as many each way
  int factor_ = 1;
  std::vector<PinholeView> views_;
  std::vector<std::unique_ptr<Canvas>> canvases_;
  std::vector<std::vector<std::uint32_t>> pictures_;
};

}  // namespace aras_visual_servo_sim
