#include "bind_arm.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "joint_wish.hpp"
#include "twist_inverse.hpp"

namespace py = pybind11;
using namespace aras_visual_servo_controller;  // NOLINT: this file is a part of the module

namespace {

using Twist = TwistInverse::Twist;

void bindInverse(py::module_& module) {
  py::class_<TwistInverse>(module, "Inverse",
                           "Damped inverse of one Jacobian J_BC_C, (6, n), rows [v; w]; arm/redundancy.py makes it.")
      .def(py::init<const Twist&, const TwistInverse::Vector&, const TwistInverse::JacobianRef&>(), py::arg("rows"),
           py::arg("ease"), py::arg("jacobian"),
           "Args:\n    rows: (6,) factors of the twist.  ease: (n,) of the joints, 1 / the cost of moving each.\n"
           "    jacobian: (6, n).\nRaises:\n    ShapeError, NotFiniteError.")
      .def_property_readonly("sigmas", &TwistInverse::sigmas,
                             "Singular values of the scaled Jacobian, a list, the largest first.")
      .def("damp", &TwistInverse::damp, py::arg("damping2"), py::arg("threshold"), py::arg("free_below"),
           py::arg("rounding"),
           "Has to be called once, first.\n\nArgs:\n"
           "    damping2: lambda^2 of each direction, whose gain is sigma / (sigma^2 + lambda^2).\n"
           "    threshold: a tilt direction below it does not count for the manipulability.\n"
           "    free_below: directions with a singular value below it become free, smoothly.\n"
           "    rounding: a singular value up to it is never inverted.")
      .def_property_readonly(
          "manipulability", &TwistInverse::manipulability,
          "Smallest singular value of the scaled Jacobian, without a tilt direction below the threshold.")
      .def("joint_velocity", &TwistInverse::jointVelocity, py::arg("twist"),
           "(n,) joint velocities of a twist V_C, (6,), [v; w].")
      .def("achieved", &TwistInverse::achieved, py::arg("twist"),
           "(6,) the part of the twist that `joint_velocity` achieves.")
      .def("lost", &TwistInverse::lost, py::arg("twist"),
           "Norm of the part of the twist that is not achieved, its linear part divided by length_m [rad/s].")
      .def("turn_about", &TwistInverse::turnAbout, py::arg("turn"), py::arg("p_C"),
           "(6,) the part that is achieved of a turn (w_x, w_y) [rad/s], with the translation that keeps the point\n"
           "p_C, (3,) in the camera frame [m], where it is.")
      .def("turning", &TwistInverse::turning, py::arg("jacobian"), py::arg("half_way"), py::arg("q_dot"),
           py::arg("most_part"),
           "(n,) correction of q_dot, (n,), which was found with one Jacobian, for the Jacobian half-way, (6, n)\n"
           "each; at most `most_part` of q_dot.")
      .def("free", &TwistInverse::free, py::arg("wish"),
           "(n,) the part of the joint velocities `wish` that does not move the camera.")
      .def("null_part", &TwistInverse::nullPart, py::arg("q_dot"),
           "(n,) the part of joint velocities along the directions that count as free (`FREE`): the null space.")
      .def("free_of_norm", &TwistInverse::freeOfNorm, py::arg("wish"), py::arg("twist"),
           "(n,) the part of `wish` that does not change how fast the distance to the goal shrinks (T41).")
      .def("size", &TwistInverse::size, py::arg("twist"), "Norm of a twist, linear part divided by length_m [rad/s].");
  py::class_<TwistTranspose, TwistInverse>(
      module, "Transpose",
      "q_dot = alpha J^T V, with the alpha that fits this V best. It is never unbounded, but the camera moves along V\n"
      "only where J is well-conditioned.")
      .def(py::init<const Twist&, const TwistInverse::Vector&, const TwistInverse::JacobianRef&>(), py::arg("rows"),
           py::arg("ease"), py::arg("jacobian"));
}

}  // namespace

void bindArm(py::module_& module) {
  bindInverse(module);
  py::class_<Wish>(module, "Wish",
                   "Joint velocities wanted where the twist leaves a choice: back to a posture, and away from limits.")
      .def(py::init<const Eigen::VectorXd&, const Eigen::VectorXd&, double, double, double>(), py::arg("lower"),
           py::arg("upper"), py::arg("posture_gain_per_s"), py::arg("joint_limit_gain_per_s"), py::arg("max_speed"),
           "Args:\n    lower, upper: (n,) limits, may be infinite.\n"
           "    posture_gain_per_s: rate of return to the posture, >= 0.\n"
           "    joint_limit_gain_per_s: rate at a limit, falling with the cube of the distance from the middle, >= 0.\n"
           "    max_speed: of any joint, > 0 [m/s, rad/s].")
      .def("__call__", &Wish::operator(), py::arg("q"), py::arg("posture") = py::none(), py::arg("more") = py::none(),
           "(n,) wanted velocities at joint positions q; posture: (n,) or None; more: (n,) added to them, or None.");
  module.def("velocity_factor", &velocityFactor, py::arg("q_dot"), py::arg("limit"),
             "Factor in (0, 1] that brings every joint within its velocity limit and keeps the direction of motion.\n\n"
             "Args: q_dot, limit: (n,), limit > 0 or inf [m/s or rad/s].");
  module.def("position_factor", &positionFactor, py::arg("q"), py::arg("q_dot"), py::arg("lower"), py::arg("upper"),
             py::arg("horizon_s"),
             "Factor in [0, 1] that keeps q + q_dot * horizon_s within [lower, upper], and the joint that needs it.\n\n"
             "A joint beyond its limit may only move back. Args: (n,) each, lower and upper may be infinite;\n"
             "horizon_s > 0 [s].\nReturns: (factor, index of the joint or None).");
}
