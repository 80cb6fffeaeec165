#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <aras_visual_servo_common/python/bind_errors.hpp>
#include <array>
#include <string>
#include <tuple>

#include "arrival.hpp"
#include "chain_kinematics.hpp"
#include "joint_wish.hpp"
#include "quadratic_program.hpp"
#include "twist_inverse.hpp"

namespace py = pybind11;
using namespace aras_visual_servo;  // NOLINT: this file is a part of the module

// The headers document the classes and functions. Python's names for them are the same, in snake case.
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

void bindInverse(py::module_& module) {
  const auto constructor =
      py::init<const TwistInverse::TwistRef&, const TwistInverse::VectorRef&, const TwistInverse::JacobianRef&>();
  py::class_<TwistInverse>(module, "Inverse")
      .def(constructor, py::arg("rows"), py::arg("ease"), py::arg("jacobian"))
      .def_property_readonly("sigmas", &TwistInverse::sigmas)
      .def("damp", &TwistInverse::damp, py::arg("damping2"), py::arg("threshold"), py::arg("free_below"),
           py::arg("rounding"))
      .def_property_readonly("manipulability", &TwistInverse::manipulability)
      .def("joint_velocity", &TwistInverse::jointVelocity, py::arg("twist"))
      .def("achieved", &TwistInverse::achieved, py::arg("twist"))
      .def("lost", &TwistInverse::lost, py::arg("twist"))
      .def(
          "turn_about",
          [](const TwistInverse& self, const std::array<double, 2>& turn, const std::array<double, 3>& p_C) {
            return self.turnAbout({turn[0], turn[1]}, {p_C[0], p_C[1], p_C[2]});
          },
          py::arg("turn"), py::arg("p_C"))
      .def("turning", &TwistInverse::turning, py::arg("jacobian"), py::arg("half_way"), py::arg("q_dot"),
           py::arg("most_part"))
      .def("free", &TwistInverse::free, py::arg("wish"))
      .def(
          "with_wish",
          [](const TwistInverse& self, const TwistInverse::TwistRef& twist, const Wish& wish, const JointsRef& q,
             const std::optional<Eigen::VectorXd>& posture, const std::optional<Eigen::VectorXd>& more) {
            return TwistInverse::Vector(self.jointVelocity(twist) + self.free(wish(q, posture, more)));
          },
          py::arg("twist"), py::arg("wish"), py::arg("q"), py::arg("posture") = py::none(),
          py::arg("more") = py::none())
      .def("null_part", &TwistInverse::nullPart, py::arg("q_dot"))
      .def("free_of_norm", &TwistInverse::freeOfNorm, py::arg("wish"), py::arg("twist"))
      .def("size", &TwistInverse::size, py::arg("twist"));
  py::class_<TwistTranspose, TwistInverse>(module, "Transpose")
      .def(constructor, py::arg("rows"), py::arg("ease"), py::arg("jacobian"));
}

void bindArrival(py::module_& module) {
  module.def("between", &between, py::arg("X_A"), py::arg("X_B"));
  py::class_<Arrival>(module, "Arrival")
      .def(py::init([](const std::vector<double>& thresholds, std::int64_t hold_ns, std::int64_t kept_ns,
                       double position_m, double rotation_rad, double tilt_rad, double sure, int taught_images,
                       const Arrival::Matrix6& edges, const std::vector<Arrival::Matrix6>& planes) {
             return Arrival(thresholds, hold_ns, kept_ns, {position_m, rotation_rad, tilt_rad}, sure, taught_images,
                            {edges, planes});
           }),
           py::arg("thresholds"), py::arg("hold_ns"), py::arg("kept_ns"), py::arg("position_m"),
           py::arg("rotation_rad"), py::arg("tilt_rad"), py::arg("sure"), py::arg("taught_images"), py::arg("edges"),
           py::arg("planes"))
      .def("clear", &Arrival::clear)
      .def("features", &Arrival::features, py::arg("stamp_ns"), py::arg("e"), py::arg("tilt_rad"), py::arg("moved"))
      .def(
          "place",
          [](Arrival& self, std::int64_t stamp_ns, const Eigen::Ref<const Arrival::Vector6>& moved,
             const Eigen::Ref<const Arrival::Vector6>& pose, double edge_variance) {
            const Arrival::Place place = self.place(stamp_ns, moved, pose, edge_variance);
            return std::make_tuple(place.off, place.moved, place.position, place.turn, place.known, place.open,
                                   place.position_m, place.rotation_rad);
          },
          py::arg("stamp_ns"), py::arg("moved"), py::arg("pose"), py::arg("edge_variance"));
}

void bindLimits(py::module_& module) {
  py::class_<Wish>(module, "Wish")
      .def(py::init<const Eigen::VectorXd&, const Eigen::VectorXd&, double, double, double>(), py::arg("lower"),
           py::arg("upper"), py::arg("posture_gain_per_s"), py::arg("joint_limit_gain_per_s"), py::arg("max_speed"))
      .def("__call__", &Wish::operator(), py::arg("q"), py::arg("posture") = py::none(), py::arg("more") = py::none());
  module.def("velocity_factor", &velocityFactor, py::arg("q_dot"), py::arg("limit"));
  module.def(
      "limit_factors",
      [](const JointsRef& q, const JointsRef& q_dot, const JointsRef& velocity, const JointsRef& lower,
         const JointsRef& upper, double horizon_s) {
        const auto room = positionFactor(q, q_dot, lower, upper, horizon_s);
        return std::make_tuple(velocityFactor(q_dot, velocity), room.first, room.second);
      },
      py::arg("q"), py::arg("q_dot"), py::arg("velocity"), py::arg("lower"), py::arg("upper"), py::arg("horizon_s"));
  module.def("position_factor", &positionFactor, py::arg("q"), py::arg("q_dot"), py::arg("lower"), py::arg("upper"),
             py::arg("horizon_s"));
}

}  // namespace

PYBIND11_MODULE(_kinematics, module) {
  refuseNumpy2();
  module.doc() = "Kinematics of a URDF chain through KDL, from twists to joint velocities, and quadratic programs.";
  aras_visual_servo_common::bindErrors(module);
  bindInverse(module);  // first, since `held` takes an Inverse
  bindArrival(module);
  bindLimits(module);
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
  module.def(
      "solve_program",
      [](const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
        QuadraticAnswer answer = solveProgram(H, g, A, b);
        return py::make_tuple(answer.x, answer.multipliers, answer.iterations, answer.feasible);
      },
      py::arg("H"), py::arg("g"), py::arg("A"), py::arg("b"));
}
