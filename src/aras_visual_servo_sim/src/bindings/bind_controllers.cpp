#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/physics/managed/gripper_controller.hpp"
#include "aras_visual_servo_sim/physics/managed/joint_state_controller.hpp"
#include "aras_visual_servo_sim/physics/managed/trajectory_controller.hpp"
#include "bindings.hpp"

namespace aras_visual_servo_sim {
namespace {

using Names = std::vector<std::string>;
using Numbers = std::vector<double>;
/** time_s, positions, velocities, accelerations */
using Point = std::tuple<double, Numbers, Numbers, Numbers>;
/** position, velocity, acceleration by joint */
using Limits = std::map<std::string, std::tuple<double, double, double>>;

/** @throws ParameterError: it is of another kind */
template <typename Kind>
Kind& as(Controller& controller) {
  if (auto* found = dynamic_cast<Kind*>(&controller)) return *found;
  throw ParameterError("controller '" + controller.name() + "': found type " + controller.type() +
                       ", allowed is one that takes such commands");
}

/** A loaded controller, running or not. */
template <typename Kind>
Kind& loaded(const Robot& robot, const std::string& name) {
  for (const auto& entry : robot.body().controllers().entries()) {
    if (entry.controller->name() == name) return as<Kind>(*entry.controller);
  }
  throw UnknownNameError("controller '" + name + "' is not loaded");
}

py::list loadedControllers(const Robot& robot) {
  py::list list;
  for (const auto& entry : robot.body().controllers().entries()) {
    Names joints;
    for (const ControllerConfig& drive : entry.controller->drives()) joints.push_back(drive.joint);
    list.append(py::dict("name"_a = entry.controller->name(), "type"_a = entry.controller->type(),
                         "state"_a = entry.state(), "hardware_interface"_a = entry.controller->hardwareInterface(),
                         "joints"_a = joints));
  }
  return list;
}

void setGains(Robot& robot, const std::string& name, double p, double i, double d, double i_clamp, bool antiwindup) {
  robot.body().setGains(name, PidGains{p, i, d, -i_clamp, i_clamp, antiwindup});
}

std::map<std::string, Tolerance> tolerances(const Limits& limits) {
  std::map<std::string, Tolerance> result;
  for (const auto& [joint, limit] : limits) {
    result[joint] = {std::get<0>(limit), std::get<1>(limit), std::get<2>(limit)};
  }
  return result;
}

Trajectory trajectory(const Names& joints, const std::vector<Point>& points, std::optional<double> start_s) {
  Trajectory result{joints, start_s, {}};
  for (const auto& [time_s, positions, velocities, accelerations] : points) {
    result.points.push_back({positions, velocities, accelerations, time_s});
  }
  return result;
}

std::string follow(Robot& robot, const std::string& name, const Names& joints, const std::vector<Point>& points,
                   std::optional<double> start_s) {
  auto& controller = as<TrajectoryController>(robot.body().runningController(name));
  return controller.follow(trajectory(joints, points, start_s), robot.nowS(), robot.body().jointsOf(controller));
}

std::string pursue(Robot& robot, const std::string& name, const Names& joints, const std::vector<Point>& points,
                   std::optional<double> start_s, const Limits& path, const Limits& goal, double goal_time_s) {
  auto& controller = as<TrajectoryController>(robot.body().runningController(name));
  return controller.pursue(trajectory(joints, points, start_s), {tolerances(path), tolerances(goal), goal_time_s},
                           robot.nowS(), robot.body().jointsOf(controller));
}

void cancelGoal(Robot& robot, const std::string& name) {
  Controller& controller = robot.body().runningController(name);
  const std::vector<JointNow> joints = robot.body().jointsOf(controller);
  if (auto* gripper = dynamic_cast<GripperController*>(&controller)) return gripper->cancel(joints.front());
  as<TrajectoryController>(controller).cancel(robot.nowS(), joints);
}

const char* word(GoalState state) {
  constexpr const char* kWords[] = {
      "none", "active", "succeeded", "path_tolerance_violated", "goal_tolerance_violated", "preempted"};
  return kWords[static_cast<int>(state)];
}

const char* word(GripperController::State state) {
  constexpr const char* kWords[] = {"none", "active", "reached", "stalled", "preempted"};
  return kWords[static_cast<int>(state)];
}

Eigen::MatrixX3d rows(const std::vector<TrajectoryState>& states) {
  Eigen::MatrixX3d matrix(states.size(), 3);
  for (std::size_t i = 0; i < states.size(); ++i) {
    matrix.row(static_cast<Eigen::Index>(i)) << states[i].position, states[i].velocity, states[i].acceleration;
  }
  return matrix;
}

py::dict trajectoryReport(const Robot& robot, const std::string& name) {
  const auto& controller = loaded<TrajectoryController>(robot, name);
  std::vector<TrajectoryState> desired, actual, error;
  for (const auto& joint : controller.report()) {
    desired.push_back(joint.desired);
    actual.push_back(joint.actual);
    error.push_back(joint.error);
  }
  return py::dict("joints"_a = controller.joints(), "desired"_a = rows(desired), "actual"_a = rows(actual),
                  "error"_a = rows(error), "goal"_a = word(controller.goalState()),
                  "goal_error"_a = controller.goalError(), "goals"_a = controller.goals(),
                  "state_rate_hz"_a = controller.settings().state_rate_hz,
                  "monitor_rate_hz"_a = controller.settings().monitor_rate_hz,
                  "partial_joints"_a = controller.settings().partial_joints);
}

py::dict gripperReport(const Robot& robot, const std::string& name) {
  const auto& controller = loaded<GripperController>(robot, name);
  return py::dict("goal"_a = word(controller.state()), "goals"_a = controller.goals(),
                  "position"_a = controller.joint().position, "effort"_a = controller.joint().effort,
                  "monitor_rate_hz"_a = controller.settings().monitor_rate_hz);
}

py::dict jointStateSettings(const Robot& robot, const std::string& name) {
  const JointStateConfig& config = loaded<JointStateController>(robot, name).config();
  py::list extra;
  for (const ExtraJoint& joint : config.extra_joints) {
    extra.append(py::make_tuple(joint.name, joint.position, joint.velocity, joint.effort));
  }
  return py::dict("publish_rate_hz"_a = config.publish_rate_hz, "extra_joints"_a = extra);
}

}  // namespace

void bindControllers(RobotClass& type) {
  type.def(
          "load_controller",
          [](Robot& self, const std::string& name, const py::object& parameters) {
            return self.body().loadController(name, yamlFromPython(parameters, name));
          },
          py::arg("name"), py::arg("parameters"),
          "Makes a controller, which does not run yet.\n\nArgs:\n"
          "    parameters: dict in ros_control's layout, with `type`.\n"
          "Returns:\n    what was ignored, a list of lines.\n"
          "Raises:\n    ParameterError: the name is taken, or what is wrong with the parameters.")
      .def("unload_controller", ofBody(&MultibodyWorld::unloadController), py::arg("name"),
           "Forgets a controller.\n\nRaises:\n    UnknownNameError; ParameterError: it is running.")
      .def("switch_controllers", ofBody(&MultibodyWorld::switchControllers), py::arg("start") = Names(),
           py::arg("stop") = Names(), py::arg("strict") = true,
           "Stops and starts controllers before the next period.\n\nArgs:\n"
           "    strict: all of them or none; False: those that are there and not in that state already.\n"
           "Raises:\n    UnknownNameError, ParameterError (two controllers on one joint); nothing changes then.")
      .def("loaded_controllers", &loadedControllers,
           "list of dict: name, type, state (initialized, running, stopped), hardware_interface, joints.")
      .def_static("controller_types", &controllerTypes, "Types that load_controller knows.")
      .def("set_controller_command", &Robot::setControllerCommand, py::arg("controller"), py::arg("value"),
           "A number on the command topic of a running controller of one joint.\n\nRaises:\n    UnknownNameError, "
           "NotFiniteError.")
      .def("set_gains", &setGains, py::arg("controller"), py::arg("p"), py::arg("i"), py::arg("d"), py::arg("i_clamp"),
           py::arg("antiwindup"),
           "Gains of a running controller of one joint.\n\nRaises:\n    UnknownNameError, ParameterError.")
      .def("set_group_command", ofBody(&MultibodyWorld::setGroupCommand), py::arg("controller"), py::arg("values"),
           "Sets all joints of a running group, in its order.\n\nRaises:\n    UnknownNameError, NotFiniteError; "
           "ParameterError: wrong size, not running.")
      .def("follow_trajectory", &follow, py::arg("controller"), py::arg("joints"), py::arg("points"),
           py::arg("start_s") = py::none(),
           "Lets joints follow a trajectory; the goal before it, if any, is preempted.\n\nArgs:\n"
           "    points: list of (time_s, positions, velocities, accelerations); the last two may be empty. No points: "
           "stop.\n"
           "    start_s: when it begins, since the robot's first tick [s]; None: now.\n"
           "Returns:\n    what its author may want to know, \"\" if nothing.\n"
           "Raises:\n    ParameterError: joints, times or numbers that are wrong; nothing changes then.")
      .def("pursue_trajectory", &pursue, py::arg("controller"), py::arg("joints"), py::arg("points"),
           py::arg("start_s") = py::none(), py::arg("path") = Limits(), py::arg("goal") = Limits(),
           py::arg("goal_time_s") = 0.0,
           "The same as a goal that succeeds or fails, see trajectory_report.\n\nArgs:\n"
           "    path, goal: dict joint -> (position, velocity, acceleration), how far off it may be; 0: as the\n"
           "        controller's parameters say, negative: as far as it likes.")
      .def("cancel_goal", &cancelGoal, py::arg("controller"), "Ends the goal of a trajectory or gripper, and stops.")
      .def("trajectory_report", &trajectoryReport, py::arg("controller"),
           "dict of the last period: joints; desired, actual, error, (n, 3) position, velocity, acceleration;\n"
           "goal (none, active, succeeded, path_tolerance_violated, goal_tolerance_violated, preempted), goal_error,\n"
           "goals (how many so far); state_rate_hz, monitor_rate_hz, partial_joints.")
      .def(
          "trajectory_at",
          [](const Robot& self, const std::string& name, double time_s) {
            return rows(loaded<TrajectoryController>(self, name).at(time_s));
          },
          py::arg("controller"), py::arg("time_s"),
          "(n, 3): position, velocity, acceleration that its joints are to have at a time since the robot's first "
          "tick.")
      .def(
          "pursue_grip",
          [](Robot& self, const std::string& name, double position, double max_effort) {
            as<GripperController>(self.body().runningController(name)).pursue(position, max_effort, self.nowS());
          },
          py::arg("controller"), py::arg("position"), py::arg("max_effort"),
          "Moves a gripper to a position [m or rad] with at most this effort [N or N m].")
      .def("gripper_report", &gripperReport, py::arg("controller"),
           "dict: goal (none, active, reached, stalled, preempted), goals, position, effort, monitor_rate_hz.")
      .def("joint_state_settings", &jointStateSettings, py::arg("controller"),
           "dict: publish_rate_hz, extra_joints [(name, position, velocity, effort)].");
}

}  // namespace aras_visual_servo_sim
