#include <map>
#include <optional>
#include <string>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "bindings.hpp"

namespace aras_visual_servo_sim {
namespace {

using Values = std::map<std::string, double>;

void setCommand(Robot& robot, std::optional<Values> position, std::optional<Values> velocity,
                std::optional<Values> effort, std::optional<std::int64_t> stamp_ns) {
  JointCommand command;
  if (position) command.position = std::move(*position);
  if (velocity) command.velocity = std::move(*velocity);
  if (effort) command.effort = std::move(*effort);
  robot.setCommand(command, stamp_ns);
}

py::dict controllerState(const Robot& robot, const std::string& controller) {
  const ControllerState state = robot.body().controllerState(controller);
  return py::dict("set_point"_a = state.set_point, "process_value"_a = state.process_value,
                  "process_value_dot"_a = state.process_value_dot, "error"_a = state.error, "command"_a = state.command,
                  "p"_a = state.gains.p, "i"_a = state.gains.i, "d"_a = state.gains.d, "i_clamp"_a = state.gains.i_max,
                  "antiwindup"_a = state.gains.antiwindup);
}

void setBase(Robot& robot, const Eigen::Matrix4d& X_WB, const Twist& V_WB_W) {
  const Eigen::Quaterniond q(X_WB.topLeftCorner<3, 3>());
  robot.setBase({X_WB.topRightCorner<3, 1>(), q.normalized()}, V_WB_W);
}

}  // namespace

void bindRobot(RobotClass& type) {
  type.def_property_readonly(
          "joint_names", ofBody(&MultibodyWorld::jointNames),
          "Moving joints sorted by name: the order of every joint vector; of a driven base px, py, pz, rx, ry, rz.")
      .def_property_readonly("joint_positions", ofBody(&MultibodyWorld::jointPositions),
                             "(n,) float64 copy [m or rad].")
      .def_property_readonly("joint_velocities", ofBody(&MultibodyWorld::jointVelocities),
                             "(n,) float64 copy [m/s or rad/s].")
      .def_property_readonly("joint_efforts", ofBody(&MultibodyWorld::jointEfforts),
                             "(n,) float64 copy, what the actuators applied in the last period [N or N m].")
      .def("set_command", &setCommand, py::arg("position") = py::none(), py::arg("velocity") = py::none(),
           py::arg("effort") = py::none(), py::arg("stamp_ns") = py::none(),
           "Commands joints by name. A command is applied or refused as a whole.\n\nArgs:\n"
           "    position: dict of set-points [m or rad], at once.\n"
           "    velocity: dict [m/s or rad/s], integrated into the set-point until the joint's next command, or until\n"
           "        command_timeout_s of simulated time has passed.\n"
           "    effort: dict [N or N m], for effort controllers.\n"
           "    stamp_ns: simulated time of the state this answers [ns]; None: now.\n"
           "Raises:\n    NotFiniteError, UnknownNameError, ParameterError: the command was refused and counted, and "
           "all\n"
           "    commanded velocities are zero: the arm holds.")
      .def("set_twist", &Robot::setTwist, py::arg("twist"), py::arg("link") = "", py::arg("stamp_ns") = py::none(),
           "Moves a driven base (sim.base: driven).\n\nArgs:\n"
           "    twist: (6,), V_WL_L, [v; w] in the axes of the link [m/s; rad/s], as a velocity of set_command.\n"
           "    link: any that the base carries, e.g. the optical frame; \"\": the base itself.\n"
           "    stamp_ns and errors: as set_command.")
      .def_property_readonly(
          "refused_commands", [](const Robot& self) { return self.commands().refused(); },
          "Commands refused since the last reset.")
      .def("controller_names", ofBody(&MultibodyWorld::controllerNames), "Names of the joint controllers.")
      .def("controller_state", &controllerState, py::arg("controller"),
           "dict of set_point, process_value, process_value_dot, error, command and the gains.")
      .def(
          "link_pose", [](const Robot& self, const std::string& link) { return self.body().linkPose(link).matrix(); },
          py::arg("link"), "X_WL, (4, 4): pose of a link's frame in W.")
      .def_property_readonly(
          "base_pose", [](const Robot& self) { return self.body().basePose().matrix(); },
          "X_WB, (4, 4): pose of the root link, or of the child of a floating joint, in W.")
      .def(
          "link_twist", [](const Robot& self, const std::string& link) -> Twist { return self.body().linkTwist(link); },
          py::arg("link"), "V_WL_L, (6,): twist of a link in W in its own axes, [v; w] [m/s; rad/s].")
      .def("link_acceleration", ofBody(&MultibodyWorld::linkAcceleration), py::arg("link"),
           "(6,): acceleration of a link in W in its own axes in the last period, [m/s^2; rad/s^2], without gravity.")
      .def("joint_wrench", ofBody(&MultibodyWorld::jointWrench), py::arg("joint"),
           "(6,): what the child link of a joint, fixed ones too, exerted on its parent in the last period, in the\n"
           "child's axes about its origin, [f; tau] [N; N m].")
      .def("push", ofBody(&MultibodyWorld::push), py::arg("links") = std::map<std::string, Twist>(),
           py::arg("joints") = Values(),
           "Forces from outside from now on, in the place of all there were; a reset ends them.\n\nArgs:\n"
           "    links: dict name -> (6,), at its centre of mass, [f; tau] in world axes [N; N m].\n"
           "    joints: dict name -> effort besides that of its actuator [N or N m].\n"
           "Raises:\n    UnknownNameError, NotFiniteError; nothing changes then.")
      .def("set_base", &setBase, py::arg("pose"), py::arg("twist") = Twist(Twist::Zero()),
           "Places a base that is not fixed: X_WB (4, 4); twist (6,), [v; w] in world axes, not of a driven one.\n\n"
           "Raises:\n    ParameterError: it is fixed; NotFiniteError. Nothing changes then.")
      .def("set_joint_positions", &Robot::setJointPositions, py::arg("positions"),
           "Places joints, dict name -> [m or rad], at rest with their set-points there.\n\n"
           "Raises:\n    UnknownNameError, NotFiniteError, ParameterError (outside the limits); nothing changes then.");
  type.def_property_readonly(
      "contacts",
      [](const Robot& self) {
        py::list contacts;
        for (const ContactForce& contact : self.body().contacts()) {
          contacts.append(py::dict("a"_a = contact.a, "b"_a = contact.b, "point_m"_a = contact.point_W,
                                   "normal"_a = contact.normal_W, "depth_m"_a = contact.depth_m,
                                   "force_n"_a = contact.force_W));
        }
        return contacts;
      },
      "Points of contact of the last step: a list of {a, b: names of links, solids or ground_plane, of other robots as "
      "ROBOT::LINK; point_m "
      "(3,), "
      "normal (3,) from b to a, force_n (3,) on a, all in W; depth_m}.");
  type.def_property_readonly(
      "unsettled_steps", ofBody(&MultibodyWorld::unsettledSteps),
      "Steps since the last reset whose contacts did not settle within the bound on the work of a step.");
  type.def_property_readonly("name", &Robot::name, "Its name in its world; '' of a Simulation.")
      .def_property_readonly(
          "warnings", [](const Robot& self) { return self.model().warnings; },
          "What was ignored in the URDF, a line each.")
      .def(
          "save_state", [](const Robot& self) { return py::bytes(self.body().saveState()); },
          "bytes: the state of joints, base, controllers and forces, to be compared with another one.");
  bindControllers(type);
}

}  // namespace aras_visual_servo_sim
