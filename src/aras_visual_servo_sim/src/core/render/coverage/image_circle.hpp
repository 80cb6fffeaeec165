#pragma once

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "coverage_rasterizer.hpp"

namespace aras_visual_servo_sim {

/** Blackens what of an image lies beyond the circle that the camera's lens draws, its border by exact coverage.
 *  @pre camera.showsLensCircle() */
template <typename Value>
void blackenBeyondLens(const CameraModel& camera, CoverageRasterizer& rasterizer, ImageOf<Value>& image);

/** How coverage is counted in images of a camera. */
inline CoverageRasterizer::Rule ruleOf(const CameraModel& camera) {
  return camera.sampling() == CameraModel::Sampling::kCenter ? CoverageRasterizer::Rule::kCenter
                                                             : CoverageRasterizer::Rule::kCoverage;
}

}  // namespace aras_visual_servo_sim
