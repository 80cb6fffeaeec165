#pragma once

#include "coverage_image.hpp"

namespace aras_visual_servo_camera::testing {

struct DotView {
  GreyImage image;
  Polygon truth;  // centroids of the projected dots, in the order of the dots
};

/** Dark dots about these points of the target's plane [m]. */
inline DotView dotsSeenFrom(const View& view, const CameraIntrinsics& camera, const Polygon& dots,
                            double radius_m = 0.012) {
  DotView seen{GreyImage(camera.width(), camera.height(), kBackgroundGrey), {}};
  for (const Point2& dot : dots) {
    const Polygon outline = project(ellipse(radius_m, radius_m, 0.0, dot, 48), view);
    drawCoverage(outline, camera, kObjectGrey, &seen.image);
    const std::vector<double> m = polygonMoments(outline, 1);
    seen.truth.push_back({m[1] / m[0], m[2] / m[0]});
  }
  return seen;
}

}  // namespace aras_visual_servo_camera::testing
