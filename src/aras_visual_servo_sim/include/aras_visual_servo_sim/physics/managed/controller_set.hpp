#pragma once

#include <yaml-cpp/yaml.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/physics/managed/controller.hpp"

namespace aras_visual_servo_sim {

/** The controllers that a robot has, in the order in which they were loaded, with the rules and the answers of
 *  ros_control's controller manager. It says what is to be started and stopped; whoever owns the joints does it. */
class ControllerSet {
 public:
  struct Entry {
    std::unique_ptr<Controller> controller;
    YAML::Node parameters;  ///< as they were loaded
    bool running = false, ran = false;

    /** "initialized", "running" or "stopped". */
    const char* state() const { return running ? "running" : ran ? "stopped" : "initialized"; }
  };
  struct Switch {
    std::vector<Entry*> stop, start;
  };

  /** @return what was ignored, a line each
   *  @throws ParameterError: the name is taken, and as makeController(); nothing changes then */
  std::vector<std::string> load(const std::string& name, const YAML::Node& parameters, const RobotModel& model);
  /** @throws UnknownNameError, ParameterError: it is running */
  void unload(const std::string& name);
  /** What has to be done to stop some controllers and start others.
   *  @param strict  every one of them; else those that exist and are not in that state already
   *  @param taken   joints that others have, with the names of these
   *  @throws UnknownNameError, ParameterError (a controller in both lists, or two running ones on one joint) */
  Switch plan(const std::vector<std::string>& start, const std::vector<std::string>& stop, bool strict,
              const std::map<std::string, std::string>& taken);

  const std::vector<Entry>& entries() const { return entries_; }
  std::vector<Entry>& entries() { return entries_; }
  /** @throws UnknownNameError */
  Entry& entry(const std::string& name, const char* to_do);

  /** Writes or reads everything, parameters too. @throws StateError */
  void visit(Archive& archive, const RobotModel& model);

 private:
  Entry* find(const std::string& name);

  std::vector<Entry> entries_;
};

}  // namespace aras_visual_servo_sim
