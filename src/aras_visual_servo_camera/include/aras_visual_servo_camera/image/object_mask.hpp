#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace aras_visual_servo_camera {

/** Pixels u_begin <= u < u_end of row v that lie wholly in the object (weight 1). */
struct Span {
  int v, u_begin, u_end;
};

/** A pixel of the object's edge, the part of it that the object covers, and where in the pixel that part lies. Noise
 * may take the weight below 0 and above 1. */
struct EdgePixel {
  int v, u;
  double weight;
  double du = 0.0, dv = 0.0;  ///< centroid of the covered part, from the centre of the pixel [px]
};

/** The object in one image: the weight of each pixel. Pixels that are not listed have weight zero. Sorted by row. */
struct ObjectMask {
  int width_px = 0, height_px = 0;
  bool visible = false;           ///< an object of at least min_area_px is in view
  bool touches_border = false;    ///< ... and lies on the first or last row or column, or reaches pixels without a ray
  bool soft_edges = false;        ///< weights are area coverage, else every weight is 1
  double grey_step = 1.0;         ///< smallest difference between two weights: one grey level, or a whole pixel
  bool ambiguous = false;         ///< there are objects, and it is not clear which one is the target: none is taken
  int components = 0;             ///< objects that pass the area filter
  int area_px = 0;                ///< pixels of the chosen one (coverage of one half or more)
  double u_px = 0.0, v_px = 0.0;  ///< mean position of those pixels
  std::vector<Span> spans;
  std::vector<EdgePixel> edge;

  /** Weights as grey levels, 255 for weight 1. @param out  height_px rows of width_px bytes, overwritten */
  void render(std::uint8_t* out) const {
    std::memset(out, 0, static_cast<std::size_t>(width_px) * height_px);
    for (const Span& s : spans)
      std::memset(out + static_cast<std::size_t>(s.v) * width_px + s.u_begin, 255, s.u_end - s.u_begin);
    for (const EdgePixel& e : edge)
      out[static_cast<std::size_t>(e.v) * width_px + e.u] =
          static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(e.weight, 0.0, 1.0)));
  }
};

}  // namespace aras_visual_servo_camera
