#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** The section `time`: how fast the node lets time pass and what it waits for. A simulation in process does not need
 * it. schema/time.yaml says what each key means. */
struct TimeConfig {
  double real_time_factor = 0.0;
  bool lockstep = false;
  std::vector<std::string> lockstep_cameras, lockstep_nodes;
  double lockstep_timeout_s = 0.0;
  bool continue_on_timeout = false;  ///< `on_lockstep_timeout`: "hold" (false) or "continue" (true)
  bool start_paused = false;
  bool monotonic_clock = false;  ///< `reset_clock`: "rewind" (false) or "monotonic"
  double clock_rate_hz = 0.0, joint_state_rate_hz = 0.0;
  bool joint_state_rate_given = false;
  bool render_always = false;  ///< `render`: "always" or "subscribed"

  /** @throws ParameterError listing every fault */
  static TimeConfig fromYaml(const YAML::Node& node);
};

}  // namespace aras_visual_servo_sim
