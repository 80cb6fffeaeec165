#pragma once

#include <string>

#include "aras_visual_servo_sim/physics/joint_state_config.hpp"
#include "aras_visual_servo_sim/physics/managed/controller.hpp"

namespace aras_visual_servo_sim {

/** What publishes joint_states while it runs; it drives nothing. */
class JointStateController : public Controller {
 public:
  JointStateController(std::string name, std::string type, JointStateConfig config)
      : Controller(std::move(name), std::move(type), {}), config_(std::move(config)) {}
  const JointStateConfig& config() const { return config_; }

 private:
  JointStateConfig config_;
};

}  // namespace aras_visual_servo_sim
