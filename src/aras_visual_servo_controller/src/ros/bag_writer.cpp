#include "bag_writer.hpp"

#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace aras_visual_servo_controller {
namespace {

constexpr std::chrono::milliseconds kShutdownPoll{20};  // SIGINT does not wake a condition variable

bool isLatched(const ros::M_string& header) {
  const auto found = header.find("latching");
  return found != header.end() && found->second == "1";
}

}  // namespace

BagWriter::BagWriter(ros::NodeHandle& node, const Options& options) : options_(options) {
  open();
  for (const std::string& topic : options_.topics) {
    ros::SubscribeOptions subscription;
    subscription.topic = topic;
    subscription.queue_size = 0;  // no limit
    subscription.md5sum = ros::message_traits::md5sum<topic_tools::ShapeShifter>();
    subscription.datatype = ros::message_traits::datatype<topic_tools::ShapeShifter>();
    subscription.helper = boost::make_shared<ros::SubscriptionCallbackHelperT<const Message&>>(
        [this, topic](const Message& message) { arrived(topic, message); });
    subscription.transport_hints = ros::TransportHints().tcpNoDelay();
    subscribers_.push_back(node.subscribe(subscription));
  }
  spinner_.start();
}

BagWriter::~BagWriter() {
  spinner_.stop();
  try {
    close();
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM("recorder: " << error.what());
  }
}

void BagWriter::arrived(const std::string& topic, const Message& message) {
  const ros::Time now = ros::Time::now();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    // A bag holds no time before 1 ns, and the simulated clock starts at 0.
    arrivals_.push_back({topic, message, std::max(now, ros::TIME_MIN)});
  }
  wake_.notify_one();
}

void BagWriter::run() {
  std::deque<Arrival> batch;
  for (bool ending = false; !ending;) {
    ending = !ros::ok();  // read before the queue is: what arrived until now is written in this last round
    {
      std::unique_lock<std::mutex> lock(mutex_);
      if (!ending) wake_.wait_for(lock, kShutdownPoll, [this] { return !arrivals_.empty(); });
      batch.swap(arrivals_);
    }
    for (const Arrival& arrival : batch) write(arrival);
    batch.clear();
  }
  close();
}

void BagWriter::write(const Arrival& arrival) {
  const auto header = arrival.message.getConnectionHeaderPtr();
  if (options_.split_bytes > 0) {
    if (bag_.getSize() > options_.split_bytes) {
      close();
      ++part_;
      open();
      for (const auto& [topic, publishers] : latched_)
        for (const auto& [publisher, last] : publishers)
          bag_.write(topic, arrival.time, *last.message.getConstMessage(), last.message.getConnectionHeaderPtr());
    }
    if (header && isLatched(*header)) latched_[arrival.topic][arrival.message.getPublisherName()] = arrival;
  }
  bag_.write(arrival.topic, arrival.time, *arrival.message.getConstMessage(), header);
}

void BagWriter::open() {
  path_ = options_.bag;
  if (options_.split_bytes > 0) path_.insert(path_.size() - 4, "_" + std::to_string(part_));
  bag_.open(path_ + ".active", rosbag::bagmode::Write);
  bag_.setCompression(options_.compression);
}

void BagWriter::close() {
  if (!bag_.isOpen()) return;
  bag_.close();
  if (std::rename((path_ + ".active").c_str(), path_.c_str()) != 0)
    throw std::runtime_error(path_ + ": cannot be renamed from " + path_ + ".active");
}

}  // namespace aras_visual_servo_controller
