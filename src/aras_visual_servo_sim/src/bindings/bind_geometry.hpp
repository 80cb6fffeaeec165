#pragma once

#include <pybind11/pybind11.h>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** Adds render_depth, render_range, render_segmentation, segmentation_ids, trigger and dropped_frames to the class. */
void bindGeometry(pybind11::class_<Simulation>& type);

}  // namespace aras_visual_servo_sim
