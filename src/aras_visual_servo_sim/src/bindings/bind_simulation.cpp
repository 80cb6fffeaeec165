#include "bind_simulation.hpp"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <aras_visual_servo_common/python/yaml_from_python.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "bind_contacts.hpp"
#include "bind_controllers.hpp"
#include "bind_frames.hpp"
#include "bind_geometry.hpp"
#include "bind_lights.hpp"

namespace py = pybind11;

namespace aras_visual_servo_sim {
namespace {

using aras_visual_servo_common::yamlFromPython;

using Values = std::map<std::string, double>;
using PackageMap = std::map<std::string, std::string>;
using ReleaseGil = py::call_guard<py::gil_scoped_release>;

std::unique_ptr<Simulation> makeSimulation(const std::string& urdf, const py::object& config,
                                           const py::object& controllers, const std::optional<PackageMap>& packages) {
  const YAML::Node config_node = yamlFromPython(config, "config");
  const YAML::Node controllers_node = yamlFromPython(controllers, "controllers");
  const PackagePaths paths(packages
                               ? std::vector<std::pair<std::string, std::string>>(packages->begin(), packages->end())
                               : std::vector<std::pair<std::string, std::string>>());
  const bool is_document = urdf.find('<') != std::string::npos;
  const py::gil_scoped_release release;
  RobotModel model = is_document ? loadRobotModel(urdf, "URDF string") : loadRobotModelFile(paths.resolve(urdf));
  return std::make_unique<Simulation>(std::move(model), SimulationConfig::fromYaml(config_node), controllers_node,
                                      paths);
}

void setCommand(Simulation& simulation, std::optional<Values> position, std::optional<Values> velocity,
                std::optional<Values> effort, std::optional<std::int64_t> stamp_ns) {
  JointCommand command;
  if (position) command.position = std::move(*position);
  if (velocity) command.velocity = std::move(*velocity);
  if (effort) command.effort = std::move(*effort);
  simulation.setCommand(command, stamp_ns);
}

py::dict cameraInfo(const Simulation& simulation, const std::string& camera) {
  const CameraModel& model = simulation.cameras()[simulation.cameras().index(camera)].model();
  const auto rows = [](const auto& matrix) {
    std::vector<double> numbers;
    for (int i = 0; i < matrix.rows(); ++i) {
      for (int j = 0; j < matrix.cols(); ++j) numbers.push_back(matrix(i, j));
    }
    return numbers;
  };
  py::dict info;
  info["width"] = model.width();
  info["height"] = model.height();
  info["frame_id"] = model.config().frame;
  info["distortion_model"] = model.distortionModel();
  info["D"] = model.D();
  info["K"] = rows(model.K());
  info["R"] = rows(model.R());
  info["P"] = rows(model.P());
  return info;
}

py::dict controllerState(const Simulation& simulation, const std::string& controller) {
  const ControllerState state = simulation.world().controllerState(controller);
  py::dict result;
  result["set_point"] = state.set_point;
  result["process_value"] = state.process_value;
  result["process_value_dot"] = state.process_value_dot;
  result["error"] = state.error;
  result["command"] = state.command;
  result["p"] = state.gains.p;
  result["i"] = state.gains.i;
  result["d"] = state.gains.d;
  result["i_clamp"] = state.gains.i_max;
  result["antiwindup"] = state.gains.antiwindup;
  return result;
}

void setBase(Simulation& simulation, const Eigen::Matrix4d& X_WB, const Twist& V_WB_W) {
  const Eigen::Quaterniond q(X_WB.topLeftCorner<3, 3>());
  simulation.setBase({X_WB.topRightCorner<3, 1>(), q.normalized()}, V_WB_W);
}

void setModelPose(Simulation& simulation, const std::string& name, const Eigen::Vector3d& p,
                  const Eigen::Vector4d& q_xyzw) {
  if (!(q_xyzw.norm() > 0.5)) throw ParameterError("model '" + name + "': q_xyzw is not a unit quaternion");
  simulation.setModelPose(name, Pose{p, Eigen::Quaterniond(q_xyzw[3], q_xyzw[0], q_xyzw[1], q_xyzw[2])});
}

void followLinks(Simulation& simulation, const Simulation& other, const std::map<std::string, std::string>& links) {
  for (const auto& [model, link] : links) simulation.setModelPose(model, other.world().linkPose(link));
}

void setModelMotion(Simulation& simulation, const std::string& name, const py::object& motion) {
  std::optional<ModelMotion> read;
  if (!motion.is_none()) read = ModelMotion::fromYaml(yamlFromPython(motion, "motion"), "motion");
  simulation.setModelMotion(name, read);
}

void bindTimeAndCameras(py::class_<Simulation>& type) {
  type.def_property_readonly("time_s", &Simulation::timeS, "Simulated time [s].")
      .def_property_readonly("time_ns", &Simulation::timeNs, "Simulated time, exact [ns].")
      .def_property_readonly("ticks", &Simulation::ticks, "Physics periods since the last reset.")
      .def_property_readonly("period_ns", &Simulation::periodNs, "Physics period [ns].")
      .def("step", &Simulation::step, py::arg("n") = 1, ReleaseGil(),
           "Advances n physics periods (default 1). Frames due on the way and not taken are missed.")
      .def_static("step_together", &stepTogether, py::arg("simulations"), py::arg("n") = 1, ReleaseGil(),
                  "Advances simulations of one period by n periods, each as step does, but so that their robots and "
                  "free solids\ntouch each other, as far as each is configured with contacts.\n\n"
                  "Raises:\n    ParameterError: periods that differ.")
      .def("step_to_image", &Simulation::stepToImage, py::arg("camera") = "camera", ReleaseGil(),
           "Advances to the next frame of a camera (frame k at the first tick >= k / rate, frame 0 at tick 0), of one\n"
           "with latency to its delivery, latency_s later.\n\n"
           "Returns:\n    its stamp, when it was exposed, int [ns].\nRaises:\n    UnknownNameError: no such camera.")
      .def(
          "next_image_ns",
          [](const Simulation& self, const std::string& camera) {
            const std::int64_t tick = self.cameras()[self.cameras().index(camera)].nextFrameTick();
            return tick == Simulation::kNever ? tick : tick * self.periodNs();
          },
          py::arg("camera") = "camera",
          "Time at which step_to_image would stop, int [ns]; 2^63 - 1 for a triggered camera that nobody asked.")
      .def_property_readonly(
          "camera_names", [](const Simulation& self) { return self.cameras().names(); },
          "Names of the cameras, as configured.")
      .def(
          "camera_pose",
          [](const Simulation& self, const std::string& camera) {
            return self.cameraPose(self.cameras().index(camera)).matrix();
          },
          py::arg("camera") = "camera", "X_WC, (4, 4): pose of the optical frame C (x right, y down, z forward) in W.")
      .def(
          "camera_twist",
          [](const Simulation& self, const std::string& camera) -> Twist {
            return self.cameraTwist(self.cameras().index(camera));
          },
          py::arg("camera") = "camera", "V_WC_C, (6,): twist of C in W expressed in C, [v; w] [m/s; rad/s].")
      .def("camera_info", &cameraInfo, py::arg("camera") = "camera",
           "Intrinsics as sensor_msgs/CameraInfo: dict of width, height, K (9), D, distortion_model, R (9), P (12),\n"
           "frame_id. Matrices row by row; pixel (u, v) covers [u - 1/2, u + 1/2] x [v - 1/2, v + 1/2].");
}

void bindRobot(py::class_<Simulation>& type) {
  type.def_property_readonly(
          "joint_names", [](const Simulation& self) { return self.world().jointNames(); },
          "Moving joints sorted by name: the order of every joint vector; of a driven base px, py, pz, rx, ry, rz.")
      .def_property_readonly(
          "joint_positions", [](const Simulation& self) -> Eigen::VectorXd { return self.world().jointPositions(); },
          "(n,) float64 copy [m or rad].")
      .def_property_readonly(
          "joint_velocities", [](const Simulation& self) -> Eigen::VectorXd { return self.world().jointVelocities(); },
          "(n,) float64 copy [m/s or rad/s].")
      .def_property_readonly(
          "joint_efforts", [](const Simulation& self) -> Eigen::VectorXd { return self.world().jointEfforts(); },
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
      .def(
          "set_twist",
          [](Simulation& self, const Twist& twist, const std::string& link, std::optional<std::int64_t> stamp_ns) {
            self.setTwist(twist, link, stamp_ns);
          },
          py::arg("twist"), py::arg("link") = "", py::arg("stamp_ns") = py::none(),
          "Moves a driven base (sim.base: driven).\n\nArgs:\n"
          "    twist: (6,), V_WL_L, [v; w] in the axes of the link [m/s; rad/s], as a velocity of set_command.\n"
          "    link: any that the base carries, e.g. the optical frame; \"\": the base itself.\n"
          "    stamp_ns and errors: as set_command.")
      .def_property_readonly(
          "refused_commands", [](const Simulation& self) { return self.commands().refused(); },
          "Commands refused since the last reset.")
      .def(
          "controller_names", [](const Simulation& self) { return self.world().controllerNames(); },
          "Names of the joint controllers.")
      .def("controller_state", &controllerState, py::arg("controller"),
           "dict of set_point, process_value, process_value_dot, error, command and the gains.")
      .def(
          "link_pose",
          [](const Simulation& self, const std::string& link) { return self.world().linkPose(link).matrix(); },
          py::arg("link"), "X_WL, (4, 4): pose of a link's frame in W.")
      .def_property_readonly(
          "base_pose", [](const Simulation& self) { return self.world().basePose().matrix(); },
          "X_WB, (4, 4): pose of the root link, or of the child of a floating joint, in W.")
      .def(
          "link_twist",
          [](const Simulation& self, const std::string& link) -> Twist { return self.world().linkTwist(link); },
          py::arg("link"), "V_WL_L, (6,): twist of a link in W in its own axes, [v; w] [m/s; rad/s].")
      .def(
          "link_acceleration",
          [](const Simulation& self, const std::string& link) -> Twist { return self.world().linkAcceleration(link); },
          py::arg("link"),
          "(6,): acceleration of a link in W in its own axes in the last period, [m/s^2; rad/s^2], without gravity.")
      .def(
          "joint_wrench",
          [](const Simulation& self, const std::string& joint) -> Twist { return self.world().jointWrench(joint); },
          py::arg("joint"),
          "(6,): what the child link of a joint, fixed ones too, exerted on its parent in the last period, in the\n"
          "child's axes about its origin, [f; tau] [N; N m].")
      .def("push", &Simulation::push, py::arg("links") = std::map<std::string, Twist>(), py::arg("joints") = Values(),
           "Forces from outside from now on, in the place of all there were; a reset ends them.\n\nArgs:\n"
           "    links: dict name -> (6,), at its centre of mass, [f; tau] in world axes [N; N m].\n"
           "    joints: dict name -> effort besides that of its actuator [N or N m].\n"
           "Raises:\n    UnknownNameError, NotFiniteError; nothing changes then.")
      .def("set_base", &setBase, py::arg("pose"), py::arg("twist") = Twist(Twist::Zero()),
           "Places a base that is not fixed: X_WB (4, 4); twist (6,), [v; w] in world axes, not of a driven one.\n\n"
           "Raises:\n    ParameterError: it is fixed; NotFiniteError. Nothing changes then.")
      .def("set_joint_positions", &Simulation::setJointPositions, py::arg("positions"),
           "Places joints, dict name -> [m or rad], at rest with their set-points there.\n\n"
           "Raises:\n    UnknownNameError, NotFiniteError, ParameterError (outside the limits); nothing changes then.");
}

void bindScene(py::class_<Simulation>& type) {
  type.def("set_model_pose", &setModelPose, py::arg("name"), py::arg("p"), py::arg("q_xyzw"),
           "Places a model of the scene, which then stays there: p (3,) [m], q_xyzw (4,) unit quaternion, of X_WM.")
      .def("follow_links", &followLinks, py::arg("other"), py::arg("links"),
           "Places models of the scene where links of another simulation are; they then stay there. links: dict of "
           "model "
           "-> link.")
      .def(
          "model_pose",
          [](const Simulation& self, const std::string& name) { return self.models().pose(name).matrix(); },
          py::arg("name") = "target", "X_WM, (4, 4): pose of a model of the scene in W.")
      .def(
          "model_twist", [](const Simulation& self, const std::string& name) -> Twist { return self.modelTwist(name); },
          py::arg("name") = "target",
          "V_WM_W, (6,): twist of a model in W, expressed in W, [v; w] [m/s; rad/s]; zero unless it has a motion or a "
          "mass.")
      .def_property_readonly(
          "model_names", [](const Simulation& self) { return self.models().names(); },
          "Names of the models and solids of the scene.")
      .def(
          "spawn_model",
          [](Simulation& self, const py::object& entry) { self.spawnModel(yamlFromPython(entry, "model")); },
          py::arg("entry"),
          "Adds a model until the next reset.\n\nArgs:\n"
          "    entry: dict as sim.scene.models[] or sim.scene.solids[] of a scenario, see the README.\n"
          "Raises:\n    ParameterError (also: the name is taken), ModelError; nothing changes then.")
      .def("delete_model", &Simulation::deleteModel, py::arg("name"),
           "Removes a model; one of the configuration is back after a reset.\n\nRaises:\n    UnknownNameError.")
      .def("set_model_motion", &setModelMotion, py::arg("name"), py::arg("motion"),
           "Moves a model from now and from where it is.\n\nArgs:\n"
           "    motion: dict as sim.scene.models[].motion of a scenario, see the README; None: it stays where it "
           "is.\n"
           "Raises:\n    UnknownNameError, ParameterError listing all faults.")
      .def(
          "set_cameras",
          [](Simulation& self, const py::object& config) {
            self.setCameras(SimulationConfig::fromYaml(yamlFromPython(config, "config")).cameras);
          },
          py::arg("config"),
          "Gives the cameras other settings while time goes on, also after a reset: noise, exposure, latency, sensor,\n"
          "renderer, all but what camera_info tells, and the rate. Frames that the new latency lets come no more are\n"
          "lost.\n\nArgs:\n    config: dict, the section sim of a scenario, of which only the cameras count.\n"
          "Raises:\n    ParameterError naming what would have to be as at the start; nothing changes then.")
      .def(
          "set_lighting",
          [](Simulation& self, const py::object& config) {
            self.setLighting(SimulationConfig::fromYaml(yamlFromPython(config, "config")).scene);
          },
          py::arg("config"),
          "Changes background and lights while time goes on, also for the time after a reset.\n\nArgs:\n"
          "    config: dict, the section sim of a scenario, of which only background and lights of the scene count;\n"
          "        lights that were set otherwise stay.\n"
          "Raises:\n    ParameterError; nothing changes then.");
}

void bindState(py::class_<Simulation>& type) {
  type.def("reset", &Simulation::reset, ReleaseGil(),
           "Back to tick 0, everything as constructed; controllers that were loaded stay, those that run begin anew.")
      .def("reset_world", &Simulation::resetWorld, ReleaseGil(),
           "Joints and models back to where they started, at rest; time goes on.")
      .def(
          "save_state", [](const Simulation& self) { return py::bytes(self.saveState()); },
          "bytes: everything that decides the future and the run hash.")
      .def(
          "restore_state", [](Simulation& self, const py::bytes& state) { self.restoreState(state); }, py::arg("state"),
          "Restores a state of save_state.\n\nRaises:\n    StateError: bytes of another simulation.")
      .def_property_readonly(
          "run_hash", &Simulation::runHash,
          "16 hexadecimal digits, of joint positions and velocities at every frame and of every image\n"
          "rendered for a frame since the last reset: equal for equal runs.")
      .def_property_readonly(
          "opengl", &Simulation::openGl,
          "What drew images by OpenGL so far, and its version; '' if nothing did. A run hash holds for one of these.")
      .def_property_readonly("warnings", &Simulation::warnings,
                             "What was ignored in the URDF, and what cameras of the coverage renderer leave out of the "
                             "scene, a line each;\n"
                             "grows with what is spawned.");
}

}  // namespace

void bindSimulation(py::module_& module) {
  py::class_<Simulation> type(
      module, "Simulation",
      "Robot, scene and cameras under one clock of integer nanoseconds.\n\n"
      "Frames: W world, C camera optical. SI units. Not thread-safe; the GIL is released while\n"
      "it steps and renders.");
  type.def(py::init(&makeSimulation), py::arg("urdf"), py::arg("config") = py::dict(),
           py::arg("controllers") = py::dict(), py::arg("package_paths") = py::none(),
           "Args:\n    urdf: a URDF document, or the path or package:// name of one.\n"
           "    config: dict, the `sim:` section of a scenario (see the README).\n"
           "    controllers: dict in ros_control's layout, name -> {type, joint, pid}.\n"
           "    package_paths: dict package name -> folder; others are looked up in ROS_PACKAGE_PATH and\n"
           "        CMAKE_PREFIX_PATH.\n"
           "Raises:\n    ModelError, ParameterError: every fault found, a line each.");
  bindTimeAndCameras(type);
  bindFrames(module, type);
  bindGeometry(type);
  bindContacts(type);
  bindRobot(type);
  bindControllers(type);
  bindScene(type);
  bindLights(module, type);
  bindState(type);
}

}  // namespace aras_visual_servo_sim
