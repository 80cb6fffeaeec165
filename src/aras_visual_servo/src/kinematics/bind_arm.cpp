#include "bind_arm.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <array>
#include <tuple>

#include "arrival.hpp"
#include "joint_wish.hpp"
#include "twist_inverse.hpp"

namespace py = pybind11;
using namespace aras_visual_servo;  // NOLINT: this file is a part of the module

namespace {

void bindInverse(py::module_& module) {
  py::class_<TwistInverse>(module, "Inverse",
                           "Damped inverse of one Jacobian J_BC_C, (6, n), rows [v; w]; arm/redundancy.py makes it.")
      .def(py::init<const TwistInverse::TwistRef&, const TwistInverse::VectorRef&, const TwistInverse::JacobianRef&>(),
           py::arg("rows"), py::arg("ease"), py::arg("jacobian"),
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
      .def(
          "turn_about",
          [](const TwistInverse& self, const std::array<double, 2>& turn, const std::array<double, 3>& p_C) {
            return self.turnAbout({turn[0], turn[1]}, {p_C[0], p_C[1], p_C[2]});
          },
          py::arg("turn"), py::arg("p_C"),
          "(6,) the part that is achieved of a turn (w_x, w_y) [rad/s], with the translation that keeps the point\n"
          "p_C, (3,) in the camera frame [m], where it is.")
      .def("turning", &TwistInverse::turning, py::arg("jacobian"), py::arg("half_way"), py::arg("q_dot"),
           py::arg("most_part"),
           "(n,) correction of q_dot, (n,), which was found with one Jacobian, for the Jacobian half-way, (6, n)\n"
           "each; at most `most_part` of q_dot.")
      .def("free", &TwistInverse::free, py::arg("wish"),
           "(n,) the part of the joint velocities `wish` that does not move the camera.")
      .def(
          "with_wish",
          [](const TwistInverse& self, const TwistInverse::TwistRef& twist, const Wish& wish, const JointsRef& q,
             const std::optional<Eigen::VectorXd>& posture, const std::optional<Eigen::VectorXd>& more) {
            return TwistInverse::Vector(self.jointVelocity(twist) + self.free(wish(q, posture, more)));
          },
          py::arg("twist"), py::arg("wish"), py::arg("q"), py::arg("posture") = py::none(),
          py::arg("more") = py::none(),
          "(n,) `joint_velocity` of the twist, and what is `free` of a `Wish` at joint positions q, (n,), added to\n"
          "it; posture and more as of `Wish`.")
      .def("null_part", &TwistInverse::nullPart, py::arg("q_dot"),
           "(n,) the part of joint velocities along the directions that count as free (`FREE`): the null space.")
      .def("free_of_norm", &TwistInverse::freeOfNorm, py::arg("wish"), py::arg("twist"),
           "(n,) the part of `wish` that does not change how fast the distance to the goal shrinks (T41).")
      .def("size", &TwistInverse::size, py::arg("twist"), "Norm of a twist, linear part divided by length_m [rad/s].");
  py::class_<TwistTranspose, TwistInverse>(
      module, "Transpose",
      "q_dot = alpha J^T V, with the alpha that fits this V best. It is never unbounded, but the camera moves along V\n"
      "only where J is well-conditioned.")
      .def(py::init<const TwistInverse::TwistRef&, const TwistInverse::VectorRef&, const TwistInverse::JacobianRef&>(),
           py::arg("rows"), py::arg("ease"), py::arg("jacobian"));
}

void bindArrival(py::module_& module) {
  module.def(
      "between", &between, py::arg("X_A"), py::arg("X_B"),
      "(6,) displacement from one pose to another, (4, 4) each, in the frame of the first: [p; theta u] [m; rad].");
  py::class_<Arrival>(module, "Arrival",
                      "What the images of the last seconds say of the features and of the camera's distance from the\n"
                      "goal (docs/theory.md T60, T61); servo/stop_rule.py decides by it.")
      .def(py::init([](const std::vector<double>& thresholds, std::int64_t hold_ns, std::int64_t kept_ns,
                       double position_m, double rotation_rad, double tilt_rad, double sure, int taught_images) {
             return Arrival(thresholds, hold_ns, kept_ns, {position_m, rotation_rad, tilt_rad}, sure, taught_images);
           }),
           py::arg("thresholds"), py::arg("hold_ns"), py::arg("kept_ns"), py::arg("position_m"),
           py::arg("rotation_rad"), py::arg("tilt_rad"), py::arg("sure"), py::arg("taught_images"),
           "Args:\n    thresholds: (k,) of the features.  hold_ns: for which the servo has to be at the goal.\n"
           "    kept_ns: for which images tell the place.  position_m, rotation_rad, tilt_rad: limits.\n"
           "    sure: standard errors of a mean that count as distance.  taught_images: whose mean is the goal.")
      .def("clear", &Arrival::clear, "Forget the images.")
      .def("features", &Arrival::features, py::arg("stamp_ns"), py::arg("e"), py::arg("tilt_rad"),
           "(list of k, tilt): mean errors and largest tilt of the last hold_ns as parts of their limits.\n\n"
           "Args: e: (k,) of this image.  tilt_rad: NaN where it is not known.")
      .def(
          "place",
          [](Arrival& self, std::int64_t stamp_ns, const Eigen::Ref<const Arrival::Vector6>& moved,
             const Eigen::Ref<const Arrival::Vector6>& pose) {
            const Arrival::Place place = self.place(stamp_ns, moved, pose);
            return std::make_tuple(place.off, place.moved, place.position, place.turn, place.position_m,
                                   place.rotation_rad);
          },
          py::arg("stamp_ns"), py::arg("moved"), py::arg("pose"),
          "(off, moved, position, turn, position_m, rotation_rad). The first four are parts of the limits: the\n"
          "farthest that the mean place was from the goal in the last hold_ns, and that the camera was from where it\n"
          "is now; and the former again in translation and in rotation, the uncertainty of the mean counted as\n"
          "distance. The last two are those of now.\n\n"
          "Args: moved: (6,) motion of the camera by the joints since any fixed instant.  pose: (6,) from the goal,\n"
          "by the image.");
}

}  // namespace

void bindArm(py::module_& module) {
  bindInverse(module);
  bindArrival(module);
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
  module.def(
      "limit_factors",
      [](const JointsRef& q, const JointsRef& q_dot, const JointsRef& velocity, const JointsRef& lower,
         const JointsRef& upper, double horizon_s) {
        const auto room = positionFactor(q, q_dot, lower, upper, horizon_s);
        return std::make_tuple(velocityFactor(q_dot, velocity), room.first, room.second);
      },
      py::arg("q"), py::arg("q_dot"), py::arg("velocity"), py::arg("lower"), py::arg("upper"), py::arg("horizon_s"),
      "(velocity_factor(q_dot, velocity), *position_factor(q, q_dot, lower, upper, horizon_s)).");
  module.def("position_factor", &positionFactor, py::arg("q"), py::arg("q_dot"), py::arg("lower"), py::arg("upper"),
             py::arg("horizon_s"),
             "Factor in [0, 1] that keeps q + q_dot * horizon_s within [lower, upper], and the joint that needs it.\n\n"
             "A joint beyond its limit may only move back. Args: (n,) each, lower and upper may be infinite;\n"
             "horizon_s > 0 [s].\nReturns: (factor, index of the joint or None).");
}
