#include "aras_visual_servo_sim/physics/managed/controller_set.hpp"

#include <algorithm>
#include <aras_visual_servo_common/files.hpp>
#include <utility>

#include "aras_visual_servo_sim/config/archive.hpp"

namespace aras_visual_servo_sim {
namespace {

using aras_visual_servo_common::kMostFileYaml;
using aras_visual_servo_common::parseYaml;

std::string quoted(const std::string& name) { return "'" + name + "'"; }

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

ControllerSet::Entry* ControllerSet::find(const std::string& name) {
  const auto at = std::find_if(entries_.begin(), entries_.end(),
                               [&name](const Entry& entry) { return entry.controller->name() == name; });
  return at == entries_.end() ? nullptr : &*at;
}

ControllerSet::Entry& ControllerSet::entry(const std::string& name, const char* to_do) {
  if (Entry* found = find(name)) return *found;
  throw UnknownNameError("Could not " + std::string(to_do) + " controller with name " + quoted(name) +
                         " because no controller with this name exists");
}

std::vector<std::string> ControllerSet::load(const std::string& name, const YAML::Node& parameters,
                                             const RobotModel& model) {
  if (find(name)) {
    throw ParameterError("A controller named " + quoted(name) + " was already loaded inside the controller manager");
  }
  std::vector<std::string> warnings;
  Entry entry;
  entry.controller = makeController(name, parameters, model, warnings);
  entry.parameters = YAML::Clone(parameters);
  entries_.push_back(std::move(entry));
  return warnings;
}

void ControllerSet::unload(const std::string& name) {
  if (entry(name, "unload").running) {
    throw ParameterError("Could not unload controller with name " + quoted(name) + " because it is still running");
  }
  entries_.erase(std::find_if(entries_.begin(), entries_.end(),
                              [&name](const Entry& entry) { return entry.controller->name() == name; }));
}

ControllerSet::Switch ControllerSet::plan(const std::vector<std::string>& start, const std::vector<std::string>& stop,
                                          bool strict, const std::map<std::string, std::string>& taken) {
  for (const std::string& name : stop) {
    if (strict) entry(name, "stop");
  }
  for (const std::string& name : start) {
    if (strict) entry(name, "start");
  }
  Switch result;
  std::map<std::string, std::string> users = taken;
  for (Entry& entry : entries_) {
    const std::string& name = entry.controller->name();
    bool stops = contains(stop, name), starts = contains(start, name);
    if (stops && !entry.running) {
      if (strict) throw ParameterError("Could not stop controller " + quoted(name) + " since it is not running");
      stops = false;
    }
    if (starts && entry.running && !stops) {
      if (strict) throw ParameterError("Controller " + quoted(name) + " is already running");
      starts = false;
    }
    if (stops && starts) {
      throw ParameterError("Could not start or stop controller " + quoted(name) +
                           " because of conflicting switching command");
    }
    if (stops) result.stop.push_back(&entry);
    if (starts) result.start.push_back(&entry);
    if (!starts && (stops || !entry.running)) continue;
    for (const ControllerConfig& drive : entry.controller->drives()) {
      const auto [user, free] = users.emplace(drive.joint, name);
      if (free) continue;
      throw ParameterError("Could not switch controllers, due to resource conflict: joint " + quoted(drive.joint) +
                           " is claimed by " + quoted(user->second) + " and " + quoted(name));
    }
  }
  return result;
}

void ControllerSet::visit(Archive& archive, const RobotModel& model) {
  std::uint64_t count = entries_.size();
  archive(count);
  if (archive.reads()) entries_.clear();
  try {
    for (std::uint64_t k = 0; k < count; ++k) {
      std::string name = archive.reads() ? "" : entries_[k].controller->name();
      std::string parameters = archive.reads() ? "" : YAML::Dump(entries_[k].parameters);
      archive(name, parameters);
      if (archive.reads()) load(name, parseYaml(parameters, kMostFileYaml), model);
      archive(entries_[k].running, entries_[k].ran);
      entries_[k].controller->visit(archive);
    }
  } catch (const StateError&) {
    throw;
  } catch (const std::exception& error) {
    throw StateError(std::string("saved state of controllers: ") + error.what());
  }
}

}  // namespace aras_visual_servo_sim
