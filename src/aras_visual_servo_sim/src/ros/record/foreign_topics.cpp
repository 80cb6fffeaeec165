#include "foreign_topics.hpp"

#include <cstring>
#include <sstream>
#include <utility>

namespace aras_visual_servo_sim {
namespace {

/** Takes the bytes that a message writes to it. */
struct ByteSink {
  std::vector<std::uint8_t> bytes;
  std::uint8_t* advance(std::uint32_t count) {
    bytes.resize(count);
    return bytes.data();
  }
};

/** Whether the first field of a message is a header. */
bool hasHeader(const std::string& definition) {
  std::istringstream lines(definition);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string type, name;
    if (!(words >> type)) continue;
    words >> name;
    return name == "header" && (type == "Header" || type == "std_msgs/Header");
  }
  return false;
}

std::uint32_t sequenceOf(const topic_tools::ShapeShifter& message) {
  ByteSink sink;
  message.write(sink);
  std::uint32_t number = 0;  // a header begins with it
  if (sink.bytes.size() >= sizeof(number)) std::memcpy(&number, sink.bytes.data(), sizeof(number));
  return number;
}

bool isLatched(const ros::M_string& header) {
  const auto found = header.find("latching");
  return found != header.end() && found->second == "1";
}

}  // namespace

ForeignTopics::ForeignTopics(ros::NodeHandle& node, std::function<void(const Arrival&)> arrived)
    : node_(node), arrived_(std::move(arrived)) {}

void ForeignTopics::subscribe(const std::vector<std::string>& topics) {
  sequences_.clear();
  for (const std::string& topic : topics) {
    sequences_[topic];
    ros::SubscribeOptions subscription;
    subscription.topic = topic;
    subscription.queue_size = 0;  // no limit
    subscription.md5sum = ros::message_traits::md5sum<topic_tools::ShapeShifter>();
    subscription.datatype = ros::message_traits::datatype<topic_tools::ShapeShifter>();
    subscription.helper = boost::make_shared<ros::SubscriptionCallbackHelperT<const Event&>>(
        [this, topic](const Event& event) { onMessage(topic, event); });
    subscription.transport_hints = ros::TransportHints().tcpNoDelay();
    subscribers_.push_back(node_.subscribe(subscription));
  }
}

void ForeignTopics::unsubscribe() {
  subscribers_.clear();
  latched_.clear();
}

void ForeignTopics::onMessage(const std::string& topic, const Event& event) {
  Arrival arrival{topic, event.getConstMessage(), event.getConnectionHeaderPtr(), ""};
  const std::string& publisher = event.getPublisherName();
  Sequence& sequence = sequences_[topic];
  const bool latched = arrival.header && isLatched(*arrival.header);
  if (latched) arrival.latched_by = publisher;
  if (sequence.published == 0) sequence.numbered = hasHeader(arrival.message->getMessageDefinition());
  if (latched) sequence.numbered = false;
  std::uint64_t sent = 1;
  if (sequence.numbered) {
    const std::uint32_t number = sequenceOf(*arrival.message);
    const auto last = sequence.last.find(publisher);
    // A smaller number is that of a publisher that was started again.
    if (last != sequence.last.end() && number > last->second) sent = number - last->second;
    sequence.last[publisher] = number;
  }
  sequence.published += sent;
  arrived_(arrival);
}

void ForeignTopics::written(const Arrival& arrival) {
  if (!arrival.latched_by.empty()) latched_[{arrival.topic, arrival.latched_by}] = arrival;
}

std::vector<ForeignTopics::Arrival> ForeignTopics::latched() const {
  std::vector<Arrival> arrivals;
  for (const auto& [key, arrival] : latched_) arrivals.push_back(arrival);
  return arrivals;
}

std::vector<ForeignTopics::Count> ForeignTopics::counts() const {
  std::vector<Count> counts;
  for (const auto& [topic, sequence] : sequences_) counts.push_back({topic, sequence.published, sequence.numbered});
  return counts;
}

}  // namespace aras_visual_servo_sim
