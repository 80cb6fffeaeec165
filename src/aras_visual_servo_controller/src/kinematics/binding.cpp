#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <aras_visual_servo_common/python/bind_errors.hpp>
#include <string>

#include "bind_arm.hpp"
#include "bind_program.hpp"
#include "chain_kinematics.hpp"

namespace py = pybind11;
using aras_visual_servo_controller::ChainKinematics;

namespace {

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
  aras_visual_servo_common::bindErrors(module);
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
