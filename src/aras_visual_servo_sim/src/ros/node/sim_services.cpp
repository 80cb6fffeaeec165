// The services of SimNode. Each runs between two steps.
#include <ros/console.h>
#include <ros/init.h>

#include <map>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "convert/answer.hpp"
#include "convert/conversions.hpp"
#include "sim_node.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint32_t kMostSteps = 10000000;  // one call must come to an end
const std::string kTargetModel = "target";

std::map<std::string, double> positionsFrom(const aras_visual_servo_msgs::SetJointPositions::Request& request) {
  if (request.name.size() != request.position.size()) {
    throw ShapeError("position: " + std::to_string(request.position.size()) + " entries for " +
                     std::to_string(request.name.size()) + " names");
  }
  std::map<std::string, double> positions;
  for (std::size_t k = 0; k < request.name.size(); ++k) positions[request.name[k]] = request.position[k];
  return positions;
}

}  // namespace

void SimNode::advertiseServices(bool gazebo_names) {
  services_ = {node_.advertiseService("sim/pause", &SimNode::onPause, this),
               node_.advertiseService("sim/pause_at", &SimNode::onPauseAt, this),
               node_.advertiseService("sim/unpause", &SimNode::onUnpause, this),
               node_.advertiseService("sim/reset", &SimNode::onReset, this),
               node_.advertiseService("sim/reconfigure", &SimNode::onReconfigure, this),
               node_.advertiseService("sim/step", &SimNode::onStep, this),
               node_.advertiseService("sim/set_joint_positions", &SimNode::onSetJointPositions, this),
               node_.advertiseService("sim/save_state", &SimNode::onSaveState, this),
               node_.advertiseService("sim/restore_state", &SimNode::onRestoreState, this),
               node_.advertiseService("sim/set_target_pose", &SimNode::onSetTargetPose, this)};
  if (!gazebo_names) return;
  services_.push_back(node_.advertiseService("/gazebo/pause_physics", &SimNode::onPause, this));
  services_.push_back(node_.advertiseService("/gazebo/unpause_physics", &SimNode::onUnpause, this));
  services_.push_back(node_.advertiseService("/gazebo/reset_simulation", &SimNode::onReset, this));
  services_.push_back(node_.advertiseService("/gazebo/reset_world", &SimNode::onResetWorld, this));
}

bool SimNode::onPause(Empty::Request&, Empty::Response&) {
  paused_ = true;
  publishStatus();
  return true;
}

bool SimNode::onPauseAt(PauseAt::Request& request, PauseAt::Response& response) {
  return answer(response, [&] {
    const std::int64_t tick = time_.simulated(request.stamp) / simulation_.periodNs();
    if (tick < simulation_.ticks()) {
      throw ParameterError("pause_at: found " + std::to_string(request.stamp.toSec()) +
                           " s, allowed the time of now, " + std::to_string(time_.now().toSec()) + " s, or later");
    }
    pause_tick_ = tick;
    response.message = "it pauses at " + std::to_string(request.stamp.toSec()) + " s";
  });
}

bool SimNode::onUnpause(Empty::Request&, Empty::Response&) {
  paused_ = false;
  pacer_.restart(simulation_.timeNs());
  publishStatus();
  return true;
}

bool SimNode::onReset(Empty::Request&, Empty::Response&) {
  const std::int64_t before_ns = simulation_.timeNs();
  simulation_.reset();
  timeJumped(before_ns);
  gate_.reset();
  states_.reset();
  unanswered_ = 0;
  states_.publishClock();
  publishStatus();
  return true;
}

bool SimNode::onResetWorld(Empty::Request&, Empty::Response&) {
  simulation_.resetWorld();
  markers_.publish();
  return true;
}

bool SimNode::onReconfigure(Trigger::Request&, Trigger::Response& response) {
  return answer(response, [&] {
    const ros::NodeHandle private_node("~");
    const LiveParameters next = loadLiveParameters(node_, private_node, sim_section_);
    const SceneConfig scene = simulation_.config().scene;
    if (next.lighting) simulation_.setLighting(next.simulation.scene);
    try {
      if (next.cameras) simulation_.setCameras(next.simulation.cameras);
    } catch (const ArasError&) {
      if (next.lighting) simulation_.setLighting(scene);  // all of it, or nothing
      throw;
    }
    sim_section_ = simSection(node_, private_node);
    if (next.real_time_factor != config_.real_time_factor) {
      config_.real_time_factor = next.real_time_factor;
      pacer_.setFactor(next.real_time_factor, simulation_.timeNs());
    }
    response.message = "cameras, light and pace are as the parameters say now";
  });
}

bool SimNode::onStep(Step::Request& request, Step::Response& response) {
  answer(response, [&] {
    if (!paused_) throw ParameterError("step: the simulator runs; pause it first");
    if (request.steps > kMostSteps) {
      throw ParameterError("step: found " + std::to_string(request.steps) +
                           " steps, allowed <= " + std::to_string(kMostSteps));
    }
    const std::int64_t end = simulation_.ticks() + request.steps;
    while (ros::ok() && simulation_.ticks() < end) {
      sample();
      pauseIfDue();
      advance(end - simulation_.ticks());
    }
    sample();
    pauseIfDue();
    states_.publishClock();
  });
  response.stamp = time_.now();
  return true;
}

bool SimNode::onSetJointPositions(SetJointPositions::Request& request, SetJointPositions::Response& response) {
  return answer(response, [&] { simulation_.setJointPositions(positionsFrom(request)); });
}

bool SimNode::onSetTargetPose(SetTargetPose::Request& request, SetTargetPose::Response& response) {
  return answer(response, [&] {
    simulation_.setModelPose(request.model.empty() ? kTargetModel : request.model,
                             fromMessage(request.pose, Unset::kRefused));
    markers_.publish();
  });
}

bool SimNode::onSaveState(SaveState::Request& request, SaveState::Response& response) {
  return answer(response, [&] {
    const std::string state = simulation_.saveState();
    if (!request.file.empty()) writeStateFile(request.file, state);
    response.name = snapshots_.save(request.name, state);
  });
}

bool SimNode::onRestoreState(RestoreState::Request& request, RestoreState::Response& response) {
  answer(response, [&] {
    if (request.name.empty() == request.file.empty()) {
      throw ParameterError("restore_state: found " + std::string(request.name.empty() ? "neither" : "both") +
                           " of name and file, allowed one of them");
    }
    const std::int64_t before_ns = simulation_.timeNs();
    simulation_.restoreState(request.file.empty() ? snapshots_.get(request.name) : readStateFile(request.file));
    timeJumped(before_ns);
    hold(states_.resume());
    publishStatus();
  });
  response.stamp = time_.now();
  return true;
}

}  // namespace aras_visual_servo_sim
