#pragma once

#include "aras_visual_servo_sim/config/sections.hpp"

namespace aras_visual_servo_sim {

/** The section `time`, which a simulation in process does not need. */
struct TimeConfig : TimeKeys {
  bool continue_on_timeout = false;  ///< `on_lockstep_timeout`: "hold" (false) or "continue" (true)
  bool monotonic_clock = false;      ///< `reset_clock`: "rewind" (false) or "monotonic"
  bool joint_state_rate_given = false;
  bool render_always = false;  ///< `render`: "always" or "subscribed"

  /** @throws ParameterError listing every fault */
  static TimeConfig fromYaml(const YAML::Node& node);
};

}  // namespace aras_visual_servo_sim
