#pragma once

#include <yaml-cpp/yaml.h>

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/physics/joint_controller.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

class Archive;

/** A joint as its controller finds it at the beginning of a period. */
struct JointNow {
  double position = 0.0, velocity = 0.0;  ///< [m or rad, per s]
  double effort = 0.0;                    ///< of its actuator in the period before [N or N m]
};

/** What a controller wants of the drive of a joint during one period. */
struct JointTarget {
  double set_point = 0.0;     ///< at the period's end; position, velocity or effort, as the drive takes it
  double feed_forward = 0.0;  ///< effort added to that of a drive with a PID [N or N m]
  double effort_limit = std::numeric_limits<double>::infinity();  ///< of a drive with a PID [N or N m]
};

/** A controller as ros_control's controller manager has them: loaded by name, started and stopped while time goes on.
 *
 *  It drives its joints through one drive each, which acts while the controller runs; update() may move the set-points
 *  of these drives in every period. */
class Controller {
 public:
  Controller(std::string name, std::string type, std::vector<ControllerConfig> drives);
  virtual ~Controller() = default;

  const std::string& name() const { return name_; }
  const std::string& type() const { return type_; }  ///< e.g. "effort_controllers/JointPositionController"
  /** One for each joint that it claims, in the order of its joints. */
  const std::vector<ControllerConfig>& drives() const { return drives_; }
  /** What it claims its joints through, "hardware_interface::EffortJointInterface"; of a sensor, what it reads. */
  std::string hardwareInterface() const;

  /** Joint vectors are in the order of drives(). Times are simulated, since the robot's first tick [s]. */
  virtual void start(double, const std::vector<JointNow>&) {}
  virtual void stop() {}
  /** Whether update() is to be called in every period. */
  virtual bool acts() const { return false; }
  /** @param time_s  of the period's beginning  @param targets  to be filled, one for each drive */
  virtual void update(double, double, const std::vector<JointNow>&, std::vector<JointTarget>&) {}

  // --- of one joint, for controllers that act in place of their drive
  /** Takes a command [m or rad]. @return false: the drive takes it @throws NotFiniteError */
  virtual bool takeCommand(double) { return false; }
  /** Changes the gains, the integral stays. @return false: the drive has them @throws ParameterError */
  virtual bool takeGains(const PidGains&) { return false; }
  /** Nothing: the drive says it. */
  virtual std::optional<ControllerState> pidState() const { return std::nullopt; }

  /** Writes or reads everything on which its future depends besides the drives. */
  virtual void visit(Archive&) {}

 private:
  std::string name_, type_;
  std::vector<ControllerConfig> drives_;
};

/** What a type of controller makes of its parameters.
 *  @param warnings  gets a line for everything that is ignored
 *  @throws ParameterError listing all faults */
using MakeController = std::unique_ptr<Controller> (*)(const std::string& name, const std::string& type,
                                                       const YAML::Node& parameters, const RobotModel& model,
                                                       std::vector<std::string>& warnings);

/** Makes a type of controller known: a constant of this type in the file of that controller. */
struct RegisterController {
  RegisterController(const char* type, MakeController make);
};

/** Types that makeController knows, sorted. */
std::vector<std::string> controllerTypes();

/** @param parameters  a map with `type` and what that type asks for; keys that it does not know are ignored and named
 *                     in the warnings, as ros_control ignores them
 *  @throws ParameterError naming the controller: no parameters, no or an unknown type, or what is wrong with them */
std::unique_ptr<Controller> makeController(const std::string& name, const YAML::Node& parameters,
                                           const RobotModel& model, std::vector<std::string>& warnings);

// --- for the files of controllers

/** The keys of a map that a schema section describes; the others go to the warnings. */
YAML::Node describedKeys(const YAML::Node& map, const Schema& section, const std::string& where,
                         std::vector<std::string>& warnings);

/** Reads the parameters of a controller, without those that its section does not describe. */
template <typename Settings, typename Check>
Settings readController(const YAML::Node& parameters, const std::string& name, std::vector<std::string>& warnings,
                        Check&& check) {
  return readSection<Settings>(describedKeys(parameters, Settings::schema(), name, warnings), name, check);
}

/** Checks that a joint exists, moves, follows no other and has this interface in its <transmission>; else a fault. */
void checkJoint(const RobotModel& model, const std::string& joint, ControllerType drive, const std::string& controller,
                FaultList& faults);

/** "Effort", "Position" or "Velocity" of a type as "effort_controllers/...". */
std::string interfaceOfType(const std::string& type);

}  // namespace aras_visual_servo_sim
