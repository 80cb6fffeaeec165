#pragma once

#include <pybind11/pybind11.h>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** Adds the class Frame to the module, and frame, frame_state and render to the class Simulation. */
void bindFrames(pybind11::module_& module, pybind11::class_<Simulation>& type);

}  // namespace aras_visual_servo_sim
