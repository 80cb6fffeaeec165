#pragma once

#include <cstdint>
#include <vector>

#include "gl_functions.hpp"
#include "render/coverage/coverage_rasterizer.hpp"

namespace aras_visual_servo_sim {

/** A picture of fixed size to draw into, with a depth of 32 bits and several samples a pixel if wanted. */
class Canvas {
 public:
  static constexpr int kSamples = 4;  ///< llvmpipe has no more

  /** @param fine  16 bits a channel, else 8  @param deep  without a depth whatever is drawn is seen
   *  @throws RenderError naming the size if OpenGL has no such picture */
  Canvas(const GlFunctions& gl, int width, int height, bool multisampled, bool fine, bool deep = true);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }

  /** What is drawn from here on goes into it. */
  void bind() const;
  /** Means over the samples: r, g, b, a for each pixel, OpenGL's first row first; 16 bits a channel into 64. */
  template <typename Pixel>
  void read(std::vector<Pixel>& pixels) const {
    read({0, 0, width_, height_}, pixels);
  }
  /** Only the pixels in a box, into their places; the others stay as they are. */
  template <typename Pixel>
  void read(const PixelBox& box, std::vector<Pixel>& pixels) const;

 private:
  const GlFunctions& gl_;
  int width_, height_;
  GLuint drawn_ = 0, color_ = 0, depth_ = 0;  // frame buffer and what it is made of
  GLuint resolved_ = 0, resolved_color_ = 0;  // the means; none of them without multisampling
};

}  // namespace aras_visual_servo_sim
