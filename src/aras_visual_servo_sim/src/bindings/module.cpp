#include <pybind11/pybind11.h>

#include <aras_visual_servo_common/python/bind_errors.hpp>

#include "bind_simulation.hpp"

PYBIND11_MODULE(_sim, module) {
  module.doc() = "Binding of the simulator core; use the package aras_visual_servo_sim.";
  aras_visual_servo_common::bindErrors(module);
  aras_visual_servo_sim::bindSimulation(module);
}
