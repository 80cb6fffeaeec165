#pragma once

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::testing {

// Greys are rounded to 1 / 210 of the contrast; an edge of 30 samples then lies within 0.001 px, a corner within 0.005,
// and where two short edges meet within 0.02.
constexpr double kCorner_px = 0.02;

/** Four corners, or dots, that no rotation maps onto each other; from the top left, clockwise on the screen [m]. */
inline const Polygon kQuad{{-0.06, -0.05}, {0.06, -0.03}, {0.05, 0.05}, {-0.03, 0.04}};

inline VisionConfig withPoints(PointSource source, int count) {
  VisionConfig config = testing::usualVision();
  config.points = source;
  config.point_count = count;
  return config;
}

/** Largest distance [px] of the features' points from `truth`, in this order; 1e9 if they are not as many. */
inline double farthest_px(const MomentFeatures& f, const Polygon& truth) {
  constexpr double kFocal_px = 195.05;
  if (f.point_x.size() != truth.size() || f.point_y.size() != truth.size()) return 1e9;
  double most = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k)
    most = std::max(most, kFocal_px * std::hypot(f.point_x[k] - truth[k].x, f.point_y[k] - truth[k].y));
  return most;
}

}  // namespace aras_visual_servo_camera::testing
