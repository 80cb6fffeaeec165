#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/image/image.hpp"
#include "osmesa_library.hpp"

namespace aras_visual_servo_sim {

/** Corner of a triangle, projected. */
struct GlVertex {
  float x, y;  ///< [px], image edges at 0 and width or height, y down
  float z;     ///< near plane / depth: 1 at the near plane, 0 at infinity; linear over a plane's image
  std::array<std::uint8_t, 4> rgba;
};

/** An OSMesa context with a picture of fixed size: draws projected triangles at pixel centres, nearest on top. */
class OsmesaCanvas {
 public:
  /** @throws RenderError */
  OsmesaCanvas(int width, int height);
  ~OsmesaCanvas();
  OsmesaCanvas(const OsmesaCanvas&) = delete;
  OsmesaCanvas& operator=(const OsmesaCanvas&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }

  /** Clears to background (a = 0) and draws every three vertices.
   *  @return height x width pixels, top row first, valid until the next call; bytes r, g, b, a in memory
   *  @throws RenderError */
  const std::uint32_t* draw(const std::vector<GlVertex>& vertices, const Rgb& background);

 private:
  const OsmesaLibrary& gl_;
  int width_, height_;
  OSMesaContext context_ = nullptr;
  std::vector<std::uint32_t> pixels_;
};

}  // namespace aras_visual_servo_sim
