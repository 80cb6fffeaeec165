#pragma once

#include <pybind11/pybind11.h>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** Lights of a simulation, and their descriptions. */
void bindLights(pybind11::module_& module, pybind11::class_<Simulation>& type);

}  // namespace aras_visual_servo_sim
