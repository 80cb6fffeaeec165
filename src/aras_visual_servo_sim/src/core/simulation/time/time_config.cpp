#include "aras_visual_servo_sim/simulation/time/time_config.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/yaml_reader.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kLargestRateHz = 1e6;

/** Distinct names, none empty. */
std::vector<std::string> readNames(YamlReader& reader, const std::string& key) {
  const auto names = reader.optional<std::vector<std::string>>(key, {});
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool again = std::find(names.begin(), names.begin() + i, names[i]) != names.begin() + i;
    if (names[i].empty() || again) reader.fault(key, "'" + names[i] + "'" + (again ? " twice" : ""), "distinct names");
  }
  return names;
}

}  // namespace

TimeConfig TimeConfig::fromYaml(const YAML::Node& node) {
  TimeConfig config;
  YamlReader reader(node, "time");
  const Range rate = {0.0, kLargestRateHz, true};
  config.real_time_factor = reader.optional<double>("real_time_factor", config.real_time_factor, Range::nonNegative());
  config.lockstep = reader.optional<bool>("lockstep", config.lockstep);
  config.lockstep_cameras = readNames(reader, "lockstep_cameras");
  config.lockstep_nodes = readNames(reader, "lockstep_nodes");
  config.lockstep_timeout_s =
      reader.optional<double>("lockstep_timeout_s", config.lockstep_timeout_s, Range::positive());
  config.continue_on_timeout = reader.optionalChoice("on_lockstep_timeout", "hold", {"hold", "continue"}) == "continue";
  config.start_paused = reader.optional<bool>("start_paused", config.start_paused);
  config.monotonic_clock = reader.optionalChoice("reset_clock", "rewind", {"rewind", "monotonic"}) == "monotonic";
  config.clock_rate_hz = reader.optional<double>("clock_rate_hz", config.clock_rate_hz, rate);
  config.joint_state_rate_hz = reader.optional<double>("joint_state_rate_hz", config.joint_state_rate_hz, rate);
  config.render_always =
      reader.optionalChoice("render", config.lockstep ? "always" : "subscribed", {"always", "subscribed"}) == "always";
  reader.finish();
  return config;
}

}  // namespace aras_visual_servo_sim
