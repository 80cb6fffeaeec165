#pragma once

#include <aras_visual_servo_sim/PidConfig.h>
#include <dynamic_reconfigure/server.h>
#include <ros/node_handle.h>

#include <boost/thread/recursive_mutex.hpp>
#include <memory>
#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** One dynamic_reconfigure server `<controller>/pid` for each controller with a PID. */
class PidServers {
 public:
  PidServers(const ros::NodeHandle& node, Simulation& simulation);

  /** Shows the gains that the simulation has now; to be called after a reset. */
  void refresh();

 private:
  struct Entry {
    std::string controller;
    boost::recursive_mutex mutex;
    std::unique_ptr<dynamic_reconfigure::Server<PidConfig>> server;
  };

  PidConfig present(const std::string& controller) const;

  Simulation& simulation_;
  std::vector<std::unique_ptr<Entry>> entries_;
};

}  // namespace aras_visual_servo_sim
