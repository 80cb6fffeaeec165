#include "pid_servers.hpp"

#include <ros/console.h>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

PidGains gainsFrom(const PidConfig& config) {
  return {config.p, config.i, config.d, -config.i_clamp, config.i_clamp, config.antiwindup};
}

}  // namespace

PidServers::PidServers(const ros::NodeHandle& node, Simulation& simulation) : simulation_(simulation) {
  for (const ControllerConfig& controller : simulation.body().config().controllers) {
    if (!hasPid(controller.type)) continue;
    auto entry = std::make_unique<Entry>();
    entry->controller = controller.name;
    entry->server = std::make_unique<dynamic_reconfigure::Server<PidConfig>>(
        entry->mutex, ros::NodeHandle(node, controller.name + "/pid"));
    entry->server->updateConfig(present(controller.name));
    const std::string name = controller.name;
    bool first = true;  // setCallback calls at once, with what was just set
    entry->server->setCallback([this, name, first](PidConfig& config, std::uint32_t) mutable {
      if (first) {
        first = false;
        return;
      }
      try {
        simulation_.body().setGains(name, gainsFrom(config));
      } catch (const ArasError& error) {
        ROS_WARN("gains refused: %s", error.what());
        config = present(name);
      }
    });
    entries_.push_back(std::move(entry));
  }
}

void PidServers::refresh() {
  for (const auto& entry : entries_) entry->server->updateConfig(present(entry->controller));
}

PidConfig PidServers::present(const std::string& controller) const {
  const PidGains gains = simulation_.body().controllerState(controller).gains;
  PidConfig config;
  config.p = gains.p;
  config.i = gains.i;
  config.d = gains.d;
  config.i_clamp = gains.i_max;
  config.antiwindup = gains.antiwindup;
  return config;
}

}  // namespace aras_visual_servo_sim
