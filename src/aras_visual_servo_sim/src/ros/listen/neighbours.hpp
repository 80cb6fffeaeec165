#pragma once

#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** Full names of the nodes that publish a topic, in the order in which they said so to the master. */
std::vector<std::string> publishersOf(const std::string& topic);

/** To be called before the first ros::NodeHandle, because ROS then ends a running node that has the same name.
 *  @throws ArasError if a running node has the name */
void requireOwnName();

/** To be called once `topic` is advertised: two clocks on one topic send everybody's time back and forth.
 *  @throws ArasError if a running node publishes it and said so before this one */
void requireOwnClock(const std::string& topic);

}  // namespace aras_visual_servo_sim
