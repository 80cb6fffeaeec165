#pragma once

#include <ros/node_handle.h>
#include <topic_tools/shape_shifter.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** Topics that other nodes publish, of any type: hands on what arrives and counts what was sent.
 *
 *  A publisher numbers its messages that have a header: a number left out is a message that its queue dropped. On a
 *  latched topic it need not be: rospy numbers anew the message that it sends to a newcomer alone. */
class ForeignTopics {
 public:
  struct Arrival {
    std::string topic;
    boost::shared_ptr<const topic_tools::ShapeShifter> message;
    boost::shared_ptr<ros::M_string> header;  ///< of the connection
    std::string latched_by;                   ///< the publisher of a latched topic, else empty
  };
  struct Count {
    std::string topic;
    std::uint64_t published;
    bool by_sequence;  ///< false: the messages have no number or are latched, counted are those that arrived
  };

  /** @param arrived  called for each message, on the queue of the node handle */
  ForeignTopics(ros::NodeHandle& node, std::function<void(const Arrival&)> arrived);

  /** Forgets the counts. */
  void subscribe(const std::vector<std::string>& topics);
  void unsubscribe();
  /** To be called when a message is written. */
  void written(const Arrival& arrival);
  /** The last message written of every latched topic. */
  std::vector<Arrival> latched() const;
  /** Of every topic subscribed, sorted. */
  std::vector<Count> counts() const;

 private:
  using Event = ros::MessageEvent<const topic_tools::ShapeShifter>;
  struct Sequence {
    bool numbered = false;
    std::uint64_t published = 0;
    std::map<std::string, std::uint32_t> last;  ///< by publisher
  };
  void onMessage(const std::string& topic, const Event& event);

  ros::NodeHandle node_;
  std::function<void(const Arrival&)> arrived_;
  std::vector<ros::Subscriber> subscribers_;
  std::map<std::string, Sequence> sequences_;                       ///< by topic
  std::map<std::pair<std::string, std::string>, Arrival> latched_;  ///< by topic and publisher
};

}  // namespace aras_visual_servo_sim
