#pragma once

#include <pybind11/pybind11.h>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** Controllers that are loaded, started and stopped. */
void bindControllers(pybind11::class_<Simulation>& type);

}  // namespace aras_visual_servo_sim
