#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** The `time:` section: how the node paces itself. The in-process simulation has no use for it. */
struct TimeConfig {
  double real_time_factor = 1.0;              ///< simulated over wall time, >= 0; 0 = as fast as possible
  bool lockstep = false;                      ///< hold after each image until it was answered
  std::vector<std::string> lockstep_cameras;  ///< whose images are answered; empty: every camera's
  std::vector<std::string> lockstep_nodes;    ///< who answers, each of them every image; empty: anybody, once
  double lockstep_timeout_s = 5.0;            ///< wall time after which a hold is reported, > 0
  bool continue_on_timeout = false;           ///< `on_lockstep_timeout`: "hold" (false) or "continue" (true)
  bool start_paused = false;
  bool monotonic_clock = false;        ///< `reset_clock`: "monotonic"; "rewind" (false): a reset turns time back to 0
  double clock_rate_hz = 100.0;        ///< simulated, > 0
  double joint_state_rate_hz = 100.0;  ///< simulated, > 0
  bool render_always = false;          ///< `render`: "always" or "subscribed"; default "always" in lockstep

  /** @throws ParameterError listing every fault */
  static TimeConfig fromYaml(const YAML::Node& node);
};

}  // namespace aras_visual_servo_sim
