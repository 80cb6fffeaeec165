#pragma once

#include <nodelet/loader.h>
#include <nodelet/nodelet.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>

#include <atomic>
#include <boost/shared_ptr.hpp>
#include <map>
#include <memory>
#include <pluginlib/class_loader.hpp>
#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** What nodelets without threads have to do. It is done by `work`, and with the callbacks of another queue. */
class NodeletQueue : public ros::CallbackQueueInterface {
 public:
  explicit NodeletQueue(ros::CallbackQueue& other) : other_(other) {}

  /** Calls back everything that is due. */
  void work() { due_.callAvailable(ros::WallDuration(0.0)); }

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override;
  void removeByID(std::uint64_t owner) override { due_.removeByID(owner); }

 private:
  class Work;

  ros::CallbackQueue& other_;
  ros::CallbackQueue due_;
  std::atomic<bool> told_{false};  ///< the other queue knows that there is something to do
};

/** What runs in this process too. */
class Nodelets {
 public:
  using Types = std::map<std::string, std::string>;  ///< name -> type

  /** @param queue  takes the callbacks of the nodelets; null: they have threads of their own
   *  @throws ParameterError naming what cannot be loaded, and what the nodelet throws */
  Nodelets(const Types& types, const ros::NodeHandle& node, NodeletQueue* queue);

 private:
  std::unique_ptr<nodelet::Loader> threaded_;
  std::unique_ptr<pluginlib::ClassLoader<nodelet::Nodelet>> plugins_;  ///< outlives what it made
  std::vector<boost::shared_ptr<nodelet::Nodelet>> queued_;
};

}  // namespace aras_visual_servo_sim
