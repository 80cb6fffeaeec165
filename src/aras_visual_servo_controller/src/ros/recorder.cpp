/** Records topics to a rosbag and loses nothing.
 *
 *      recorder -O FILE.bag [--lz4 | --bz2] [--split --size MIB] TOPIC ...
 *
 *  `rosbag record` keeps 100 messages a topic for its callbacks and drops the rest: a simulator that runs faster than
 *  real time on a busy machine overruns that within a fifth of a second. Here what arrives is kept until it is written,
 *  memory being the limit. The bag is FILE.bag.active until it is closed, by SIGINT, SIGTERM or the end of the master.
 *  Exit code 1, with the reason, if the bag cannot be written; 2 if the arguments are wrong.
 */
#include <ros/ros.h>

#include <iostream>

#include "bag_writer.hpp"
#include "recorder_options.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "recorder");
  try {
    const auto options = aras_visual_servo_controller::parseOptions(argc, argv);
    ros::NodeHandle node;
    aras_visual_servo_controller::BagWriter writer(node, options);
    writer.run();
  } catch (const aras_visual_servo_controller::OptionError& error) {
    std::cerr << "recorder: " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "recorder: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
