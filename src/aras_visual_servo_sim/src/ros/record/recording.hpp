#pragma once

#include <aras_visual_servo_msgs/StartRecording.h>
#include <ros/node_handle.h>
#include <std_srvs/Trigger.h>

#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bag_file.hpp"
#include "convert/wire_time.hpp"
#include "foreign_topics.hpp"

namespace aras_visual_servo_sim {

/** A topic of this node while it is recorded. */
struct Tap {
  std::string topic;  ///< resolved
  bool open = false;
  std::uint64_t published = 0;  ///< since the recording began
};

/** Writes topics into a bag on the thread that steps the simulation, so that time waits for what is written.
 *
 *  The node's own messages are handed over where they are made (`Tap`, `Outlet`): nothing is between them and the bag
 *  that could lose them. Those of other nodes are subscribed without a limit to the queue. All of them are kept, in
 *  their order, until `flush` writes them: once they are sent, while the other nodes work on them. The last message of
 *  a bag, `sim/recording`, says how many messages were published, so that a reader can count what is there against it.
 *
 *  Services sim/start_recording and sim/stop_recording. A bag that cannot be written any more ends the recording;
 *  `fault` says why. */
class Recording {
 public:
  Recording(ros::NodeHandle& node, const WireTime& time);
  /** Closes what is open. */
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  bool running() const { return bag_ != nullptr; }
  /** Why the recording ended by itself; empty if it did not. */
  const std::string& fault() const { return fault_; }

  /** The tap of a topic of this node; lives as long as the recording. */
  Tap& tap(const std::string& topic);

  /** Keeps a message for the bag, if its topic is recorded. */
  template <typename Message>
  void write(Tap& tap, const boost::shared_ptr<const Message>& message) {
    if (!tap.open) return;
    ++tap.published;
    kept_.push_back([this, &topic = tap.topic, time = time_.now(), message] { bag_->write(topic, time, *message); });
  }
  template <typename Message>
  void write(Tap& tap, const Message& message) {
    if (tap.open) write(tap, boost::shared_ptr<const Message>(boost::make_shared<Message>(message)));
  }
  /** Writes what was kept. To be called before time goes on. */
  void flush();

 private:
  bool onStart(aras_visual_servo_msgs::StartRecording::Request& request,
               aras_visual_servo_msgs::StartRecording::Response& response);
  bool onStop(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  void start(const aras_visual_servo_msgs::StartRecording::Request& request);
  void keep(const ForeignTopics::Arrival& arrival);
  void write(const ForeignTopics::Arrival& arrival, const ros::Time& time);
  void stop();
  void abandon();
  void writeCounts();
  template <typename Action>
  void guarded(const Action& action);
  void failed(const std::string& reason);

  ros::NodeHandle node_;
  const WireTime& time_;
  std::deque<Tap> taps_;  ///< never moved
  std::unique_ptr<BagFile> bag_;
  std::vector<std::function<void()>> kept_;  ///< each writes a message
  ForeignTopics foreign_;
  std::string fault_;
  std::vector<ros::ServiceServer> services_;
};

template <typename Action>
void Recording::guarded(const Action& action) {
  try {
    action();
  } catch (const ArasError& error) {
    failed(error.what());
  }
}

/** A topic of this node: over the wire to those who listen, and into the bag while it is recorded. */
template <typename Message>
class Outlet {
 public:
  Outlet() = default;
  Outlet(ros::NodeHandle& node, Recording& recording, const std::string& topic, std::uint32_t queue)
      : publisher_(node.advertise<Message>(topic, queue)), recording_(&recording), tap_(&recording.tap(topic)) {}

  void publish(const Message& message) {
    publisher_.publish(message);
    recording_->write(*tap_, message);
  }
  bool wanted() const { return tap_->open || publisher_.getNumSubscribers() > 0; }

 private:
  ros::Publisher publisher_;
  Recording* recording_ = nullptr;
  Tap* tap_ = nullptr;
};

}  // namespace aras_visual_servo_sim
