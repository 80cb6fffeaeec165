#pragma once

#include <aras_visual_servo_common/errors.hpp>

namespace aras_visual_servo_sim {

// What this package throws.
using aras_visual_servo_common::ArasError;
using aras_visual_servo_common::ModelError;
using aras_visual_servo_common::NotFiniteError;
using aras_visual_servo_common::ParameterError;
using aras_visual_servo_common::RenderError;
using aras_visual_servo_common::ShapeError;
using aras_visual_servo_common::StateError;
using aras_visual_servo_common::UnknownNameError;

}  // namespace aras_visual_servo_sim
