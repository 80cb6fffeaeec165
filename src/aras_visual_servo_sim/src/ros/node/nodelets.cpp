#include "nodelets.hpp"

#include <ros/names.h>

#include <boost/make_shared.hpp>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

ParameterError unknown(const std::string& name, const std::string& type) {
  return ParameterError("nodelets/" + name + ": found '" + type + "', allowed one that " +
                        "`rospack plugins --attrib=plugin nodelet` knows");
}

}  // namespace

/** In the other queue: does what is due. */
class NodeletQueue::Work : public ros::CallbackInterface {
 public:
  explicit Work(NodeletQueue& queue) : queue_(queue) {}
  CallResult call() override {
    queue_.told_ = false;
    queue_.work();
    return Success;
  }

 private:
  NodeletQueue& queue_;
};

void NodeletQueue::addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) {
  due_.addCallback(callback, owner);
  if (!told_.exchange(true)) other_.addCallback(boost::make_shared<Work>(*this));
}

Nodelets::Nodelets(const Types& types, const ros::NodeHandle& node, NodeletQueue* queue) {
  if (types.empty()) return;  // a loader has threads
  if (!queue) {
    threaded_ = std::make_unique<nodelet::Loader>(false);
    for (const auto& [name, type] : types) {
      if (!threaded_->load(node.resolveName(name), type, ros::names::getRemappings(), {})) throw unknown(name, type);
    }
    return;
  }
  plugins_ = std::make_unique<pluginlib::ClassLoader<nodelet::Nodelet>>("nodelet", "nodelet::Nodelet");
  for (const auto& [name, type] : types) {
    if (!plugins_->isClassAvailable(type)) throw unknown(name, type);
    queued_.push_back(plugins_->createInstance(type));
    queued_.back()->init(node.resolveName(name), ros::names::getRemappings(), {}, queue, queue);
  }
}

}  // namespace aras_visual_servo_sim
