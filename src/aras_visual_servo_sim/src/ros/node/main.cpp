#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/node_handle.h>

#include <csignal>
#include <cstdlib>
#include <exception>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "convert/parameters.hpp"
#include "listen/neighbours.hpp"
#include "nodelets.hpp"
#include "sim_node.hpp"

namespace {

int failed(const std::exception& error) {
  ROS_FATAL("sim: cannot run:\n%s", error.what());
  ros::shutdown();
  return EXIT_FAILURE;
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
    aras_visual_servo_sim::NodeletQueue between_steps(queue);
    aras_visual_servo_sim::SimNode sim(node, queue, between_steps, parameters);
    const aras_visual_servo_sim::Nodelets nodelets(parameters.own.nodelets, node,
                                                   parameters.own.nodelet_threads ? nullptr : &between_steps);
    sim.run();
  } catch (const std::exception& error) {
    return failed(error);
  }
  return EXIT_SUCCESS;
}
