#pragma once

#include <cstdint>
#include <memory>
#include <tuple>
#include <vector>

#include "render/opengl/gl/canvas.hpp"
#include "render/opengl/view/pinhole_view.hpp"

namespace aras_visual_servo_sim {

class LensMap;

/** The pictures that the image of one camera is made of, and the way from them to the image. */
class CameraViews {
 public:
  /** @param fine  16 bits a channel, else 8 */
  CameraViews(const GlFunctions& gl, const CameraModel& camera, bool fine);
  ~CameraViews();

  const std::vector<PinholeView>& views() const { return views_; }
  const Canvas& canvas(std::size_t k) const { return *canvases_[k]; }
  /** As large as a picture, with one sample a pixel and without a depth. */
  const Canvas& singleSampled(std::size_t k);
  /** Reads what was drawn. @param image  as many pixels as the camera has, r, g, b, a: 8 bits each, or 16 if fine */
  template <typename Pixel>
  void read(std::vector<Pixel>& image);
  /** The pixels of a picture, to be read one by one before compose(). @param image  of which they are, if it has them
   */
  template <typename Pixel>
  std::vector<Pixel>& picture(std::size_t k, std::vector<Pixel>& image);
  /** Makes the image of its pictures. @param image  that picture() had */
  template <typename Pixel>
  void compose(std::vector<Pixel>& image);
  /** Whether a pixel of the image is one of a picture. */
  bool readsInParts() const { return !lens_ && factor_ == 1; }
  /** Reads at least the pixels in this box; the others may stay as they are, and do if readsInParts(). */
  template <typename Pixel>
  void read(const PixelBox& box, std::vector<Pixel>& image) {
    if (!readsInParts()) return read(image);
    canvases_[0]->read(box, image);
  }

 private:
  const GlFunctions& gl_;
  const bool fine_;
  std::unique_ptr<LensMap> lens_;  // none: one picture, of as many pixels or of twice as many each way
  int factor_ = 1;
  std::vector<PinholeView> views_;
  std::vector<std::unique_ptr<Canvas>> canvases_;
  std::vector<std::unique_ptr<Canvas>> single_sampled_;  // made when they are needed
  std::tuple<std::vector<std::vector<std::uint32_t>>, std::vector<std::vector<std::uint64_t>>> pictures_;  // scratch
};

}  // namespace aras_visual_servo_sim
