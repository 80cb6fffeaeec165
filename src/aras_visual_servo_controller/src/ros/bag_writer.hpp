#pragma once

#include <ros/ros.h>
#include <rosbag/bag.h>
#include <topic_tools/shape_shifter.h>

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "recorder_options.hpp"

namespace aras_visual_servo_controller {

/** Subscribes to topics of any type and writes what arrives, in order of arrival, on the thread that calls `run`. */
class BagWriter {
 public:
  /** Opens the bag and subscribes. Throws rosbag::BagException when the bag cannot be opened. */
  BagWriter(ros::NodeHandle& node, const Options& options);
  /** Closes what is open, without throwing: `run` has closed it unless it threw. */
  ~BagWriter();

  /** Writes until ROS shuts down and all that arrived before is written. Throws rosbag::BagException. */
  void run();

 private:
  using Message = ros::MessageEvent<const topic_tools::ShapeShifter>;
  struct Arrival {
    std::string topic;
    Message message;
    ros::Time time;
  };

  void arrived(const std::string& topic, const Message& message);
  void write(const Arrival& arrival);
  void open();
  void close();

  Options options_;
  rosbag::Bag bag_;
  std::string path_;
  int part_ = 0;
  std::map<std::string, std::map<std::string, Arrival>> latched_;  ///< last message, by topic and publisher

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Arrival> arrivals_;
  std::vector<ros::Subscriber> subscribers_;
  ros::AsyncSpinner spinner_{1};  ///< one thread: the order of arrival is the order in the bag
};

}  // namespace aras_visual_servo_controller
