// GCC 12 takes what the caster of fixed Eigen matrices moves into place for uninitialized.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "bindings.hpp"

namespace aras_visual_servo_sim {
namespace {

using PackageMap = std::map<std::string, std::string>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

PackagePaths pathsOf(const std::optional<PackageMap>& packages) {
  if (!packages) return {};
  return PackagePaths(std::vector<std::pair<std::string, std::string>>(packages->begin(), packages->end()));
}

RobotModel readModel(const std::string& urdf, const PackagePaths& paths) {
  const bool is_document = urdf.find('<') != std::string::npos;
  return is_document ? loadRobotModel(urdf, "URDF string") : loadRobotModelFile(paths.resolve(urdf));
}

std::shared_ptr<Simulation> makeSimulation(const std::string& urdf, const py::object& config,
                                           const py::object& controllers, const std::optional<PackageMap>& packages) {
  const YAML::Node config_node = yamlFromPython(config, "config");
  const YAML::Node controllers_node = yamlFromPython(controllers, "controllers");
  const PackagePaths paths = pathsOf(packages);
  const py::gil_scoped_release release;
  RobotModel model = readModel(urdf, paths);
  return std::make_shared<Simulation>(std::move(model), SimulationConfig::fromYaml(config_node), controllers_node,
                                      paths);
}

std::shared_ptr<World> makeWorld(const py::object& config, const std::optional<PackageMap>& packages) {
  return std::make_shared<World>(SimulationConfig::fromYaml(yamlFromPython(config, "config")), pathsOf(packages));
}

std::shared_ptr<Robot> spawn(World& world, const std::string& name, const std::string& urdf, const py::object& config,
                             const py::object& controllers) {
  const YAML::Node config_node = yamlFromPython(config, "config");
  const YAML::Node controllers_node = yamlFromPython(controllers, "controllers");
  const py::gil_scoped_release release;
  return world.spawn(name, readModel(urdf, PackagePaths()), SimulationConfig::fromYaml(config_node), controllers_node);
}

py::dict robots(const py::object& self) {
  py::dict all;
  for (const auto& robot : self.cast<World&>().robots()) {
    const py::object handle = py::cast(robot);
    py::detail::keep_alive_impl(handle, self);
    all[py::str(robot->name())] = handle;
  }
  return all;
}

py::tuple castRays(World& world, const Eigen::Vector3d& p, const Rows& directions, double nearest_m, double farthest_m,
                   bool visuals) {
  std::vector<Eigen::Vector3d> rays;
  for (Eigen::Index k = 0; k < directions.rows(); ++k) rays.emplace_back(directions.row(k));
  const std::vector<World::RayHit> hits = world.castRays(p, rays, nearest_m, farthest_m, visuals);
  py::array_t<double> distances(static_cast<py::ssize_t>(hits.size()));
  py::array_t<int> links(static_cast<py::ssize_t>(hits.size()));
  for (std::size_t k = 0; k < hits.size(); ++k) {
    distances.mutable_data()[k] = hits[k].distance_m;
    links.mutable_data()[k] = hits[k].link;
  }
  return py::make_tuple(distances, links);
}

void setGround(World& world, std::optional<double> z_m, double friction) {
  world.setGround(z_m ? std::optional<GroundPlane>({*z_m, friction}) : std::nullopt);
}

py::dict cameraInfo(const World& world, const std::string& camera) {
  const CameraModel& model = world.cameras()[world.cameras().index(camera)].model();
  const auto rows = [](const auto& matrix) {
    const auto numbers = matrix.template reshaped<Eigen::RowMajor>();
    return std::vector<double>(numbers.begin(), numbers.end());
  };
  return py::dict("width"_a = model.width(), "height"_a = model.height(), "frame_id"_a = model.config().frame,
                  "distortion_model"_a = model.distortionModel(), "D"_a = model.D(), "K"_a = rows(model.K()),
                  "R"_a = rows(model.R()), "P"_a = rows(model.P()));
}

void setModelPose(World& world, const std::string& name, const Eigen::Vector3d& p, const Eigen::Vector4d& q_xyzw) {
  if (!(q_xyzw.norm() > 0.5)) throw ParameterError("model '" + name + "': q_xyzw is not a unit quaternion");
  world.setModelPose(name, Pose{p, Eigen::Quaterniond(q_xyzw[3], q_xyzw[0], q_xyzw[1], q_xyzw[2])});
}

void setModelMotion(World& world, const std::string& name, const py::object& motion) {
  std::optional<ModelMotion> read;
  if (!motion.is_none()) read = ModelMotion::fromYaml(yamlFromPython(motion, "motion"), "motion");
  world.setModelMotion(name, read);
}

void bindRobots(WorldClass& type) {
  type.def("spawn", &spawn, py::arg("name"), py::arg("urdf"), py::arg("config") = py::dict(),
           py::arg("controllers") = py::dict(), py::keep_alive<0, 1>(),
           "Adds a robot, which stays after a reset.\n\nArgs:\n"
           "    name: its links and cameras are called NAME::LINK and NAME::CAMERA in the world.\n"
           "    urdf, controllers: as of a Simulation.\n"
           "    config: dict, the `sim:` section of a scenario without a scene. Period and ground plane are the "
           "world's.\n"
           "        Robots with contacts.neighbours touch each other.\n"
           "Returns:\n    Robot\nRaises:\n    ModelError, ParameterError: every fault found; nothing changes then.")
      .def("delete", &World::remove, py::arg("name"),
           "Removes a robot, and the lights and models that its links carry.\n\nRaises:\n    UnknownNameError.")
      .def(
          "renew",
          [](World& self, const std::string& name, const std::string& urdf, const Eigen::Vector3d& gravity_m_s2) {
            self.renew(name, readModel(urdf, PackagePaths()), gravity_m_s2);
          },
          py::arg("name"), py::arg("urdf"), py::arg("gravity_m_s2"),
          "Gives a robot the masses and limits of another document of the same links, and gravity. Its state stays.\n\n"
          "Raises:\n    ModelError, ParameterError, StateError: it cannot be in this state; nothing changes then.")
      .def_property_readonly("robots", &robots, "dict of name -> Robot, in the order in which they were spawned.")
      .def_property_readonly("link_names", &World::linkNames, "Links of all robots, ROBOT::LINK.")
      .def("weld", &World::weld, py::arg("a"), py::arg("b"),
           "Holds a link to another where it is now, as if they were one body, until unweld(), a reset or the end of\n"
           "one of the robots.\n\nArgs:\n"
           "    a, b: ROBOT::LINK of two robots that are driven or have contacts.neighbours.\n"
           "Raises:\n    UnknownNameError, ParameterError: of one robot, or welded already; nothing changes then.")
      .def("unweld", &World::unweld, py::arg("a"), py::arg("b"),
           "Lets two welded links go, named in either order.\n\nRaises:\n    UnknownNameError: they are not welded.")
      .def_property_readonly("welds", &World::welds, "List of (a, b): the links that are welded.")
      .def("set_ground", &setGround, py::arg("z_m"), py::arg("friction") = 1.0,
           "Sets the plane that robots with contacts.neighbours touch and rays meet; z_m None: there is none.")
      .def("cast_rays", &castRays, py::arg("p"), py::arg("directions"), py::arg("nearest_m"), py::arg("farthest_m"),
           py::arg("visuals") = false,
           "The first surface on each ray within a range, as a laser scanner sees it. Boxes, cylinders, spheres and\n"
           "the ground are met exactly, meshes at their triangles.\n\nArgs:\n"
           "    p: (3,), where the rays begin [m].  directions: (n, 3), unit vectors.\n"
           "    visuals: True: the <visual>s of links, met from outside; False: the <collision>s, from inside too.\n"
           "Returns:\n    distances (n,) [m], infinite where nothing is met; index in link_names of what is met (n,),\n"
           "    -1 for nothing, the ground and solids.\n"
           "Raises:\n    NotFiniteError, ParameterError: no range.");
}

void bindTimeAndCameras(WorldClass& type) {
  type.def_property_readonly("time_s", &World::timeS, "Simulated time [s].")
      .def_property_readonly("time_ns", &World::timeNs, "Simulated time, exact [ns].")
      .def_property_readonly("ticks", &World::ticks, "Physics periods since the last reset.")
      .def_property_readonly("period_ns", &World::periodNs, "Physics period [ns].")
      .def("step", &World::step, py::arg("n") = 1, ReleaseGil(),
           "Advances n physics periods (default 1). Frames due on the way and not taken are missed.")
      .def("step_to_image", &World::stepToImage, py::arg("camera") = "camera", ReleaseGil(),
           "Advances to the next frame of a camera (frame k at the first tick >= k / rate, frame 0 at tick 0), of one\n"
           "with latency to its delivery, latency_s later.\n\n"
           "Returns:\n    its stamp, when it was exposed, int [ns].\nRaises:\n    UnknownNameError: no such camera.")
      .def(
          "next_image_ns",
          [](const World& self, const std::string& camera) {
            const std::int64_t tick = self.cameras()[self.cameras().index(camera)].nextFrameTick();
            return tick == World::kNever ? tick : tick * self.periodNs();
          },
          py::arg("camera") = "camera",
          "Time at which step_to_image would stop, int [ns]; 2^63 - 1 for a triggered camera that nobody asked.")
      .def_property_readonly(
          "camera_names", [](const World& self) { return self.cameras().names(); },
          "Names of the cameras, as configured.")
      .def(
          "camera_pose",
          [](const World& self, const std::string& camera) {
            return self.cameraPose(self.cameras().index(camera)).matrix();
          },
          py::arg("camera") = "camera", "X_WC, (4, 4): pose of the optical frame C (x right, y down, z forward) in W.")
      .def(
          "camera_twist",
          [](const World& self, const std::string& camera) -> Twist {
            return self.cameraTwist(self.cameras().index(camera));
          },
          py::arg("camera") = "camera", "V_WC_C, (6,): twist of C in W expressed in C, [v; w] [m/s; rad/s].")
      .def("camera_info", &cameraInfo, py::arg("camera") = "camera",
           "Intrinsics as sensor_msgs/CameraInfo: dict of width, height, K (9), D, distortion_model, R (9), P (12),\n"
           "frame_id. Matrices row by row; pixel (u, v) covers [u - 1/2, u + 1/2] x [v - 1/2, v + 1/2].");
}

void bindScene(WorldClass& type) {
  type.def("set_model_pose", &setModelPose, py::arg("name"), py::arg("p"), py::arg("q_xyzw"),
           "Places a model of the scene, which then stays there: p (3,) [m], q_xyzw (4,) unit quaternion, of X_WM.")
      .def(
          "model_pose", [](const World& self, const std::string& name) { return self.models().pose(name).matrix(); },
          py::arg("name") = "target", "X_WM, (4, 4): pose of a model of the scene in W.")
      .def(
          "model_twist", [](const World& self, const std::string& name) -> Twist { return self.modelTwist(name); },
          py::arg("name") = "target",
          "V_WM_W, (6,): twist of a model in W, expressed in W, [v; w] [m/s; rad/s]; zero unless it has a motion or a "
          "mass.")
      .def_property_readonly(
          "model_names", [](const World& self) { return self.models().names(); },
          "Names of the models and solids of the scene.")
      .def(
          "spawn_model", [](World& self, const py::object& entry) { self.spawnModel(yamlFromPython(entry, "model")); },
          py::arg("entry"),
          "Adds a model until the next reset.\n\nArgs:\n"
          "    entry: dict as sim.scene.models[] or sim.scene.solids[] of a scenario, see the README.\n"
          "Raises:\n    ParameterError (also: the name is taken), ModelError; nothing changes then.")
      .def("delete_model", &World::deleteModel, py::arg("name"),
           "Removes a model; one of the configuration is back after a reset.\n\nRaises:\n    UnknownNameError.")
      .def("set_model_motion", &setModelMotion, py::arg("name"), py::arg("motion"),
           "Moves a model from now and from where it is.\n\nArgs:\n"
           "    motion: dict as sim.scene.models[].motion of a scenario, see the README; None: it stays where it "
           "is.\n"
           "Raises:\n    UnknownNameError, ParameterError listing all faults.")
      .def(
          "set_lighting",
          [](World& self, const py::object& config) {
            self.setLighting(SimulationConfig::fromYaml(yamlFromPython(config, "config")).scene);
          },
          py::arg("config"),
          "Changes background and lights while time goes on, also for the time after a reset.\n\nArgs:\n"
          "    config: dict, the section sim of a scenario, of which only background and lights of the scene count;\n"
          "        lights that were set otherwise stay.\n"
          "Raises:\n    ParameterError; nothing changes then.");
}

void bindState(WorldClass& type) {
  type.def("reset", &World::reset, ReleaseGil(),
           "Back to tick 0, everything as constructed; controllers that were loaded stay, those that run begin anew.")
      .def("reset_world", &World::resetWorld, ReleaseGil(),
           "Joints and models back to where they started, at rest; time goes on.")
      .def(
          "save_state", [](const World& self) { return py::bytes(self.saveState()); },
          "bytes: everything that decides the future and the run hash.")
      .def(
          "restore_state", [](World& self, const py::bytes& state) { self.restoreState(state); }, py::arg("state"),
          "Restores a state of save_state.\n\nRaises:\n    StateError: bytes of another simulation.")
      .def_property_readonly(
          "run_hash", &World::runHash,
          "16 hexadecimal digits, of joint positions and velocities at every frame and of every image\n"
          "rendered for a frame since the last reset: equal for equal runs.")
      .def_property_readonly(
          "opengl", &World::openGl,
          "What drew images by OpenGL so far, and its version; '' if nothing did. A run hash holds for one of these.")
      .def_property_readonly("warnings", &World::warnings,
                             "What was ignored in the URDF, and what cameras of the coverage renderer leave out of the "
                             "scene, a line each;\n"
                             "grows with what is spawned.");
}

}  // namespace

void bindWorld(py::module_& module) {
  WorldClass world(module, "World",
                   "Robots, one scene and the cameras of the robots under one clock of integer nanoseconds.\n\n"
                   "Frames: W world, C camera optical. SI units. Not thread-safe; the GIL is released while\n"
                   "it steps and renders.");
  world.def(
      py::init(&makeWorld), py::arg("config") = py::dict(), py::arg("package_paths") = py::none(),
      "Args:\n    config: dict, the `sim:` section of a scenario, of which period, scene and ground plane count.\n"
      "    package_paths: as of a Simulation.\n"
      "Raises:\n    ModelError, ParameterError: every fault found, a line each.");
  RobotClass robot(module, "Robot", "A robot of a World. It is valid, but stands still, after it was deleted.");
  bindRobot(robot);
  bindRobots(world);
  bindTimeAndCameras(world);
  bindFrames(module, world);
  bindScene(world);
  bindLights(module, world);
  bindState(world);
  py::class_<Simulation, World, Robot, std::shared_ptr<Simulation>> type(
      module, "Simulation", "A World that is its one Robot; links and cameras are called as they are.");
  type.def(py::init(&makeSimulation), py::arg("urdf"), py::arg("config") = py::dict(),
           py::arg("controllers") = py::dict(), py::arg("package_paths") = py::none(),
           "Args:\n    urdf: a URDF document, or the path or package:// name of one.\n"
           "    config: dict, the `sim:` section of a scenario (see the README).\n"
           "    controllers: dict in ros_control's layout, name -> {type, joint, pid}.\n"
           "    package_paths: dict package name -> folder; others are looked up in ROS_PACKAGE_PATH and\n"
           "        CMAKE_PREFIX_PATH.\n"
           "Raises:\n    ModelError, ParameterError: every fault found, a line each.")
      .def(
          "set_cameras",
          [](Simulation& self, const py::object& config) {
            self.setCameras(SimulationConfig::fromYaml(yamlFromPython(config, "config")).cameras);
          },
          py::arg("config"),
          "Gives the cameras other settings while time goes on, also after a reset: noise, exposure, latency, sensor,\n"
          "renderer, all but what camera_info tells, and the rate. Frames that the new latency lets come no more are\n"
          "lost.\n\nArgs:\n    config: dict, the section sim of a scenario, of which only the cameras count.\n"
          "Raises:\n    ParameterError naming what would have to be as at the start; nothing changes then.");
}

}  // namespace aras_visual_servo_sim
