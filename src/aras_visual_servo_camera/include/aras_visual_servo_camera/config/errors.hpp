#pragma once

#include <aras_visual_servo_common/errors.hpp>

namespace aras_visual_servo_camera {

// What this package throws.
using aras_visual_servo_common::ArasError;
using aras_visual_servo_common::DegenerateFeature;
using aras_visual_servo_common::NotFiniteError;
using aras_visual_servo_common::ParameterError;
using aras_visual_servo_common::ShapeError;

}  // namespace aras_visual_servo_camera
