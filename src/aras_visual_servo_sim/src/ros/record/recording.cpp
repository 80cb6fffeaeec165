#include "recording.hpp"

#include <aras_visual_servo_msgs/RecordingCounts.h>
#include <ros/console.h>
#include <ros/names.h>

#include "convert/answer.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint64_t kBytesPerMib = 1 << 20;
const std::string kCountsTopic = "sim/recording";

}  // namespace

Recording::Recording(ros::NodeHandle& node, const WireTime& time)
    : node_(node), time_(time), foreign_(node, [this](const ForeignTopics::Arrival& arrival) { keep(arrival); }) {
  services_ = {node_.advertiseService("sim/start_recording", &Recording::onStart, this),
               node_.advertiseService("sim/stop_recording", &Recording::onStop, this)};
}

Recording::~Recording() {
  if (running()) guarded([this] { stop(); });
}

Tap& Recording::tap(const std::string& topic) {
  taps_.push_back({node_.resolveName(topic), false, 0});
  return taps_.back();
}

bool Recording::onStart(aras_visual_servo_msgs::StartRecording::Request& request,
                        aras_visual_servo_msgs::StartRecording::Response& response) {
  return answer(response, [&] { start(request); });
}

bool Recording::onStop(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  if (running()) guarded([this] { stop(); });
  response.success = fault_.empty();
  response.message = fault_;
  return true;
}

void Recording::start(const aras_visual_servo_msgs::StartRecording::Request& request) {
  if (running()) throw ParameterError("start_recording: a recording runs already; stop it first");
  if (request.topics.empty()) throw ParameterError("start_recording: found no topic, allowed at least one");
  for (const std::string& topic : request.topics) {
    std::string reason;
    if (!ros::names::validate(topic, reason))
      throw ParameterError("start_recording: found the topic '" + topic + "', allowed a name of ROS: " + reason);
  }
  bag_ =
      std::make_unique<BagFile>(BagFile::Options{request.file, request.compression, request.split_mib * kBytesPerMib});
  bag_->onNewPart([this](const ros::Time& time) {
    for (const ForeignTopics::Arrival& arrival : foreign_.latched()) write(arrival, time);
  });
  fault_.clear();
  std::vector<std::string> foreign;
  for (const std::string& topic : request.topics) {
    const std::string name = node_.resolveName(topic);
    bool own = false;
    for (Tap& tap : taps_) {
      if (tap.topic != name) continue;
      tap.open = own = true;
      tap.published = 0;
    }
    if (!own) foreign.push_back(name);
  }
  foreign_.subscribe(foreign);
}

void Recording::keep(const ForeignTopics::Arrival& arrival) {
  kept_.push_back([this, arrival, time = time_.now()] {
    write(arrival, time);
    foreign_.written(arrival);
  });
}

void Recording::write(const ForeignTopics::Arrival& arrival, const ros::Time& time) {
  bag_->write(arrival.topic, time, *arrival.message, arrival.header);
}

void Recording::flush() {
  guarded([this] {
    for (const std::function<void()>& write : kept_) write();
  });
  kept_.clear();
}

void Recording::stop() {
  flush();
  if (!running()) return;  // it ended by itself just now
  writeCounts();
  const std::unique_ptr<BagFile> bag = std::move(bag_);
  abandon();
  bag->close();
}

/** What is recorded no longer. The bag stays as it is. */
void Recording::abandon() {
  for (Tap& tap : taps_) tap.open = false;
  foreign_.unsubscribe();
  bag_.reset();
}

void Recording::writeCounts() {
  aras_visual_servo_msgs::RecordingCounts counts;
  const auto add = [&](const std::string& topic, std::uint64_t published, bool counted) {
    counts.topics.push_back(topic);
    counts.published.push_back(published);
    counts.counted.push_back(counted);
  };
  for (const Tap& tap : taps_) {
    if (tap.open) add(tap.topic, tap.published, true);
  }
  for (const ForeignTopics::Count& count : foreign_.counts()) add(count.topic, count.published, count.by_sequence);
  bag_->write(node_.resolveName(kCountsTopic), time_.now(), counts);
}

void Recording::failed(const std::string& reason) {
  fault_ = reason;
  ROS_ERROR("the recording ends: %s", reason.c_str());
  abandon();
}

}  // namespace aras_visual_servo_sim
