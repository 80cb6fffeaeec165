#pragma once

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <aras_visual_servo_common/python/yaml_from_python.hpp>
#include <memory>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

namespace py = pybind11;
using namespace pybind11::literals;
using aras_visual_servo_common::yamlFromPython;
using ReleaseGil = py::call_guard<py::gil_scoped_release>;
using RobotClass = py::class_<Robot, std::shared_ptr<Robot>>;
using WorldClass = py::class_<World, std::shared_ptr<World>>;

/** A member of the robot's body as a function of the robot. */
template <typename Result, typename... Arguments>
auto ofBody(Result (MultibodyWorld::*member)(Arguments...) const) {
  return [member](const Robot& self, Arguments... arguments) -> std::decay_t<Result> {
    return (self.body().*member)(arguments...);
  };
}
template <typename Result, typename... Arguments>
auto ofBody(Result (MultibodyWorld::*member)(Arguments...)) {
  return [member](Robot& self, Arguments... arguments) -> Result { return (self.body().*member)(arguments...); };
}

/** The classes World and Simulation. */
void bindWorld(py::module_& module);

// --- parts of these classes
void bindRobot(RobotClass& type);
void bindControllers(RobotClass& type);
/** Images, depth and segmentation; and the class Frame. */
void bindFrames(py::module_& module, WorldClass& type);
void bindLights(py::module_& module, WorldClass& type);

}  // namespace aras_visual_servo_sim
