#include <nodelet/loader.h>
#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/names.h>
#include <ros/node_handle.h>

#include <csignal>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "convert/parameters.hpp"
#include "listen/neighbours.hpp"
#include "sim_node.hpp"

namespace {

int failed(const std::exception& error) {
  ROS_FATAL("sim: cannot run:\n%s", error.what());
  ros::shutdown();
  return EXIT_FAILURE;
}

/** What runs in this process too. @throws ParameterError naming what cannot be loaded, and what the nodelet throws */
std::unique_ptr<nodelet::Loader> load(const std::map<std::string, std::string>& nodelets, const ros::NodeHandle& node) {
  if (nodelets.empty()) return nullptr;  // a loader has threads
  auto loader = std::make_unique<nodelet::Loader>(false);
  for (const auto& [name, type] : nodelets) {
    if (!loader->load(node.resolveName(name), type, ros::names::getRemappings(), {})) {
      throw aras_visual_servo_sim::ParameterError("nodelets/" + name + ": found '" + type + "', allowed one that " +
                                                  "`rospack plugins --attrib=plugin nodelet` knows");
    }
  }
  return loader;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of who writes it, with a name
  ros::init(argc, argv, "sim");
  try {
    aras_visual_servo_sim::requireOwnName();
  } catch (const std::exception& error) {
    return failed(error);
  }
  ros::NodeHandle node;  // the end of the last one is the end of ROS, and of its log
  const ros::NodeHandle private_node("~");
  ros::CallbackQueue queue;
  node.setCallbackQueue(&queue);
  try {
    const aras_visual_servo_sim::NodeParameters parameters = aras_visual_servo_sim::loadParameters(node, private_node);
    aras_visual_servo_sim::SimNode sim(node, queue, parameters);
    const std::unique_ptr<nodelet::Loader> nodelets = load(parameters.nodelets, node);
    sim.run();
  } catch (const std::exception& error) {
    return failed(error);
  }
  return EXIT_SUCCESS;
}
