#pragma once

#include <pybind11/pybind11.h>

namespace aras_visual_servo_camera {

/** TagExtractor and TagFeatures. */
void bindTag(pybind11::module_& module);

}  // namespace aras_visual_servo_camera
