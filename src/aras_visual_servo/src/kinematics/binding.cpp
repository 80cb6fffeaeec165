#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "bind_arm.hpp"
#include "bind_program.hpp"
#include "chain_kinematics.hpp"

namespace py = pybind11;
namespace common = aras_visual_servo_common;
using aras_visual_servo::ChainKinematics;

namespace {

/** Raises the class of that name of the package's errors.py. */
void raise(const char* name, const std::exception& error) {
  const py::object errors = py::module_::import("aras_visual_servo.ground.errors");
  PyErr_SetString(py::object(errors.attr(name)).ptr(), error.what());
}

/** pybind11 before 2.12 calls a function that numpy 2 no longer has: the process would end without a word. */
void refuseNumpy2() {
  if (PYBIND11_VERSION_HEX >= 0x020C0000) return;
  const py::module_ numpy = py::module_::import("numpy");
  const auto version = numpy.attr("__version__").cast<std::string>();
  if (std::stoi(version) < 2) return;
  throw py::import_error("numpy: found " + version + " in " + numpy.attr("__file__").cast<std::string>() +
                         ", allowed 1, which the kinematics were built for: run this with " ARAS_PYTHON
                         " and its own numpy (PYTHONNOUSERSITE=1 leaves out one that pip put in your home)");
}

}  // namespace

PYBIND11_MODULE(_kinematics, module) {
  refuseNumpy2();
  module.doc() = "Kinematics of a URDF chain through KDL, from twists to joint velocities, and quadratic programs.";
  // Of this module only: the simulator and the camera raise errors of their own.
  py::register_local_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const common::ModelError& error) {
      raise("ModelError", error);
    } catch (const common::ShapeError& error) {
      raise("ShapeError", error);
    } catch (const common::NotFiniteError& error) {
      raise("NotFiniteError", error);
    }
  });
  bindArm(module);  // first, since `held` takes an Inverse
  py::class_<ChainKinematics>(module, "ChainKinematics")
      .def(py::init<const std::string&, const std::string&, const std::string&, bool>(), py::arg("urdf_xml"),
           py::arg("base_link"), py::arg("tip_link"), py::arg("upwards") = false)
      .def_property_readonly("joint_names", &ChainKinematics::jointNames)
      .def_property_readonly("lower", [](const ChainKinematics& self) { return Eigen::VectorXd(self.lower()); })
      .def_property_readonly("upper", [](const ChainKinematics& self) { return Eigen::VectorXd(self.upper()); })
      .def_property_readonly("velocity", [](const ChainKinematics& self) { return Eigen::VectorXd(self.velocity()); })
      .def("pose", &ChainKinematics::pose, py::arg("q"))
      .def("jacobian", &ChainKinematics::jacobian, py::arg("q"))
      .def("held", &ChainKinematics::held, py::arg("inverse"), py::arg("jacobian"), py::arg("q"), py::arg("q_dot"),
           py::arg("dt_s"), py::arg("most_part"))
      .def("manipulability", &ChainKinematics::manipulability, py::arg("q"), py::arg("length_m"), py::arg("rows"));
  bindProgram(module);
}
