#include "aras_visual_servo_sim/simulation/time/time_config.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Distinct names. */
std::vector<std::string> readNames(YamlReader& reader, const std::string& key) {
  const auto names = reader.get<std::vector<std::string>>(key);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(names.begin(), names.begin() + i, names[i]) != names.begin() + i) {
      reader.fault(key, "'" + names[i] + "' twice", "distinct names");
    }
  }
  return names;
}

}  // namespace

TimeConfig TimeConfig::fromYaml(const YAML::Node& node) {
  TimeConfig config;
  YamlReader reader(node, sectionOf("time"), "time");
  config.real_time_factor = reader.get<double>("real_time_factor");
  config.lockstep = reader.get<bool>("lockstep");
  config.lockstep_cameras = readNames(reader, "lockstep_cameras");
  config.lockstep_nodes = readNames(reader, "lockstep_nodes");
  config.lockstep_timeout_s = reader.get<double>("lockstep_timeout_s");
  config.continue_on_timeout = reader.choice<bool>("on_lockstep_timeout", {{"hold", false}, {"continue", true}});
  config.start_paused = reader.get<bool>("start_paused");
  config.monotonic_clock = reader.choice<bool>("reset_clock", {{"rewind", false}, {"monotonic", true}});
  config.clock_rate_hz = reader.get<double>("clock_rate_hz");
  config.joint_state_rate_hz = reader.get<double>("joint_state_rate_hz");
  config.joint_state_rate_given = reader.has("joint_state_rate_hz");
  config.render_always =
      reader.has("render") ? reader.choice<bool>("render", {{"always", true}, {"subscribed", false}}) : config.lockstep;
  reader.finish();
  return config;
}

}  // namespace aras_visual_servo_sim
