#include "aras_visual_servo_sim/simulation/time/time_config.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {
namespace {

void requireDistinct(const std::vector<std::string>& names, const char* key, const SectionCheck& section) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(names.begin(), names.begin() + i, names[i]) != names.begin() + i) {
      section.fault(key, "'" + names[i] + "' twice", "distinct names");
    }
  }
}

}  // namespace

TimeConfig TimeConfig::fromYaml(const YAML::Node& node) {
  TimeConfig config;
  readSection<TimeKeys>(node, "time", [&config](const TimeKeys& settings, const SectionCheck& section) {
    static_cast<TimeKeys&>(config) = settings;
    requireDistinct(settings.lockstep_cameras, "lockstep_cameras", section);
    requireDistinct(settings.lockstep_nodes, "lockstep_nodes", section);
    config.continue_on_timeout = settings.on_lockstep_timeout == "continue";
    config.monotonic_clock = settings.reset_clock == "monotonic";
    config.joint_state_rate_given = section.has("joint_state_rate_hz");
    config.render_always = settings.render ? *settings.render == "always" : settings.lockstep;
  });
  return config;
}

}  // namespace aras_visual_servo_sim
