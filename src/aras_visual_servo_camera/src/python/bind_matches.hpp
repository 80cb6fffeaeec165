#pragma once

#include <pybind11/pybind11.h>

namespace aras_visual_servo_camera {

/** MatchFeatures and MatchExtractor. */
void bindMatches(pybind11::module_& module);

}  // namespace aras_visual_servo_camera
