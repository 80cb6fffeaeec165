#include "state_publisher.hpp"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "convert/conversions.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint32_t kSmallQueue = 1000;  // messages: a listener that hesitates for seconds loses nothing
// Images that wait for a listener: at 320 x 240 in colour those of two seconds, and never more than this in bytes.
constexpr std::uint32_t kQueueBytes = 16 * 1024 * 1024;
constexpr std::uint32_t kFewestImages = 2, kMostImages = 200;
constexpr std::size_t kLongestPath = 2000;  // poses kept for display
constexpr double kPathPeriodS = 0.5;        // wall
constexpr double kErrorPeriodS = 5.0;       // wall, between two reports of the same failure
const std::string kTargetModel = "target";

/** The model named `target`, else the first; empty without any. */
std::string targetOf(const std::vector<std::string>& models) {
  if (std::find(models.begin(), models.end(), kTargetModel) != models.end()) return kTargetModel;
  return models.empty() ? "" : models.front();
}

/** Images of a camera that may wait for a listener. */
std::uint32_t imageQueue(const CameraModel& model) {
  const auto bytes = static_cast<std::uint32_t>(model.width() * model.height() * channelsOf(model.encoding()));
  return std::clamp(kQueueBytes / bytes, kFewestImages, kMostImages);
}

template <typename Message>
Message stamped(const ros::Time& stamp, const std::string& frame) {
  Message message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  return message;
}

void assign(std::vector<double>& to, const Eigen::VectorXd& from) { to.assign(from.data(), from.data() + from.size()); }

}  // namespace

StatePublisher::StatePublisher(const ros::NodeHandle& node, Simulation& simulation, const NodeParameters& parameters,
                               const std::vector<CameraTopics>& topics, const WireTime& time, Recording& recording)
    : node_(node),
      transport_(node_),
      simulation_(simulation),
      time_(time),
      recording_(recording),
      render_always_(parameters.time.render_always),
      clock_schedule_(std::min(parameters.time.clock_rate_hz, 1e9 / simulation.periodNs()), simulation.periodNs()),
      joint_schedule_(std::min(parameters.time.joint_state_rate_hz, 1e9 / simulation.periodNs()),
                      simulation.periodNs()),
      joint_delay_ticks_(parameters.time.lockstep
                             ? 0
                             : (std::llround(1e9 * parameters.time.joint_state_delay_s) + simulation.periodNs() - 1) /
                                   simulation.periodNs()),
      geometry_(node_, simulation, topics, recording),
      robot_frames_(node_, simulation, parameters.own.base_tf, parameters.own.link_tf),
      extra_joints_(parameters.joint_states.extra_joints) {
  clock_ = {node_, recording, "/clock", kSmallQueue};
  joints_ = {node_, recording, "joint_states", kSmallQueue};
  image_joints_ = {node_, recording, "image_joint_states", kSmallQueue};
  target_pose_ = {node_, recording, "ground_truth/target_pose", kSmallQueue};
  target_twist_ = {node_, recording, "ground_truth/target_twist", kSmallQueue};
  path_ = node_.advertise<nav_msgs::Path>("camera_path", 1);
  path_message_.header.frame_id = kWorldFrame;
  joint_message_.name = simulation.body().jointNames();
  for (const ExtraJoint& joint : extra_joints_) joint_message_.name.push_back(joint.name);
  for (std::size_t k = 0; k < topics.size(); ++k) advertiseCamera(static_cast<int>(k), topics[k]);
  for (const ControllerConfig& controller : simulation.body().config().controllers) {
    controllers_.push_back(
        {controller.name, controller.publish_state,
         node_.advertise<aras_visual_servo_msgs::JointControllerState>(controller.name + "/state", kSmallQueue)});
  }
}

void StatePublisher::advertiseCamera(int camera, const CameraTopics& topics) {
  const std::string& name = simulation_.cameras().names()[camera];
  const CameraModel& model = simulation_.cameras()[camera].model();
  const std::string truth = camera == 0 ? "ground_truth/" : "ground_truth/" + name + "/";
  CameraOutput output;
  output.image = transport_.advertise(topics.image, imageQueue(model));
  output.image_tap = &recording_.tap(topics.image);
  output.compressed = {node_, transport_, topics.image, model};
  output.info = {node_, recording_, topics.info, kSmallQueue};
  output.pose = {node_, recording_, truth + "camera_pose", kSmallQueue};
  output.twist = {node_, recording_, truth + "camera_twist", kSmallQueue};
  output.info_message = toMessage(model);
  output.image_format.header.frame_id = model.config().frame;
  output.image_format.width = static_cast<std::uint32_t>(model.width());
  output.image_format.height = static_cast<std::uint32_t>(model.height());
  output.image_format.encoding = encodingName(model.encoding());
  output.image_format.step = static_cast<std::uint32_t>(model.width() * bytesOf(model.encoding()));
  cameras_.push_back(output);
}

std::int64_t StatePublisher::nextTick() const {
  std::int64_t next = std::min(clock_schedule_.tickOf(next_clock_), joint_schedule_.tickOf(next_joints_));
  if (!late_joints_.empty()) next = std::min(next, late_joints_.front().first);
  for (const Camera& camera : simulation_.cameras()) {
    next = std::min({next, camera.nextFrameTick(), camera.nextExposureTick()});
  }
  return next;
}

std::vector<int> StatePublisher::publishDue() {
  const std::int64_t tick = simulation_.ticks();
  if (sampled_tick_ == tick) return {};
  sampled_tick_ = tick;
  const bool clock_due = clock_schedule_.tickOf(next_clock_) <= tick;
  const bool joints_due = joint_schedule_.tickOf(next_joints_) <= tick;
  simulation_.expose();
  std::vector<int> exposed, due;
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    const int camera = static_cast<int>(k);
    if (simulation_.cameras()[camera].frameExposed(tick)) exposed.push_back(camera);
    if (simulation_.cameras()[camera].frameDue(tick)) due.push_back(camera);
  }

  next_clock_ = clock_schedule_.firstIndexFrom(tick + 1);
  next_joints_ = joint_schedule_.firstIndexFrom(tick + 1);
  const ros::Time stamp = time_.now();
  const bool late_due = !late_joints_.empty() && late_joints_.front().first <= tick;
  if (clock_due || late_due || !exposed.empty() || !due.empty()) publishClock();
  for (; !late_joints_.empty() && late_joints_.front().first <= tick; late_joints_.pop_front()) {
    joints_.publish(late_joints_.front().second);
  }
  if (joints_due || !exposed.empty()) publishPresentJoints(!exposed.empty());
  if (joints_due) publishControllers(stamp);
  if (!exposed.empty()) publishTarget(stamp);
  std::vector<FrameWanted> frames;
  for (const int camera : due) frames.push_back(wantedOf(camera));
  simulation_.takeFrames(frames);
  frames_ += frames.size();
  auto frame = frames.begin();
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    const int camera = static_cast<int>(k);
    if (std::count(exposed.begin(), exposed.end(), camera)) {
      publishCamera(camera, stamp, simulation_.cameraPose(camera), simulation_.cameraTwist(camera));
    }
    if (frame != frames.end() && frame->camera == camera) publishImage(*frame++);
  }
  return due;
}

std::int64_t StatePublisher::imageNs(int camera) const {
  const ExposedFrame* late = simulation_.cameras()[camera].takenFrame();
  return late ? late->tick() * simulation_.periodNs() : simulation_.timeNs();
}

void StatePublisher::publishClock() {
  rosgraph_msgs::Clock clock;
  clock.clock = time_.now();
  clock_.publish(clock);
}

void StatePublisher::reset() {
  next_clock_ = next_joints_ = 0;
  sampled_tick_ = -1;
  frames_ = dropped_frames_ = 0;
  late_joints_.clear();
  path_message_.poses.clear();
}

void StatePublisher::publishPresentJoints(bool of_image) {
  const MultibodyWorld& world = simulation_.body();
  publishJoints(time_.now(), world.jointPositions(), world.jointVelocities(), world.jointEfforts(), of_image);
  robot_frames_.publish(time_.now(), of_image);
}

void StatePublisher::publishJoints(const ros::Time& stamp, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                   const Eigen::VectorXd& efforts, bool of_image) {
  joint_message_.header.stamp = stamp;
  assign(joint_message_.position, q);
  assign(joint_message_.velocity, v);
  assign(joint_message_.effort, efforts);
  for (const ExtraJoint& joint : extra_joints_) {
    joint_message_.position.push_back(joint.position);
    joint_message_.velocity.push_back(joint.velocity);
    joint_message_.effort.push_back(joint.effort);
  }
  if (joint_delay_ticks_ == 0) {
    joints_.publish(joint_message_);
  } else {
    late_joints_.emplace_back(simulation_.ticks() + joint_delay_ticks_, joint_message_);
  }
  if (of_image) image_joints_.publish(joint_message_);
}

void StatePublisher::publishControllers(const ros::Time& stamp) {
  for (const ControllerOutput& output : controllers_) {
    if (!output.always && output.state.getNumSubscribers() == 0) continue;
    const ControllerState state = simulation_.body().controllerState(output.name);
    aras_visual_servo_msgs::JointControllerState message;
    message.header.stamp = stamp;
    message.set_point = state.set_point;
    message.process_value = state.process_value;
    message.process_value_dot = state.process_value_dot;
    message.error = state.error;
    message.time_step = state.time_step_s;
    message.command = state.command;
    message.p = state.gains.p;
    message.i = state.gains.i;
    message.d = state.gains.d;
    message.i_clamp = state.gains.i_max;
    message.antiwindup = state.gains.antiwindup;
    output.state.publish(message);
  }
}

void StatePublisher::publishTarget(const ros::Time& stamp) {
  const std::string target = targetOf(simulation_.models().names());
  if (target.empty()) return;
  auto pose = stamped<geometry_msgs::PoseStamped>(stamp, kWorldFrame);
  pose.pose = toMessage(simulation_.models().pose(target));
  target_pose_.publish(pose);
  auto twist = stamped<geometry_msgs::TwistStamped>(stamp, kWorldFrame);
  twist.twist = toMessage(simulation_.modelTwist(target));
  target_twist_.publish(twist);
}

void StatePublisher::publishCamera(int camera, const ros::Time& stamp, const Pose& X_WC, const Twist& V_WC_C) {
  CameraOutput& output = cameras_[camera];
  auto pose = stamped<geometry_msgs::PoseStamped>(stamp, kWorldFrame);
  pose.pose = toMessage(X_WC);
  output.pose.publish(pose);
  auto twist = stamped<geometry_msgs::TwistStamped>(stamp, output.info_message.header.frame_id);
  twist.twist = toMessage(V_WC_C);
  output.twist.publish(twist);
  if (camera == 0) publishPath(stamp, pose.pose);
}

FrameWanted StatePublisher::wantedOf(int camera) const {
  const CameraOutput& output = cameras_[camera];
  const bool wanted = output.image_tap->open || output.image.getNumSubscribers() > 0 || output.compressed.wanted();
  return {camera, render_always_ || wanted, geometry_.wanted(camera)};
}

void StatePublisher::publishImage(const FrameWanted& frame) {
  const int camera = frame.camera;
  CameraOutput& output = cameras_[camera];
  const ros::Time stamp = time_.at(imageNs(camera));
  output.info_message.header.stamp = stamp;
  output.info.publish(output.info_message);
  if (frame.geometry) geometry_.publish(camera, stamp);
  if (!frame.image) return;
  try {
    if (frame.failed) std::rethrow_exception(frame.failed);
    const Image& image = simulation_.cameras()[camera].image;
    // A new one each time: nodelets of this process keep it as it is.
    const auto message = boost::make_shared<sensor_msgs::Image>(output.image_format);
    message->header.stamp = stamp;
    message->data = image.data;
    output.image.publish(sensor_msgs::ImageConstPtr(message));
    recording_.write(*output.image_tap, sensor_msgs::ImageConstPtr(message));
    if (output.compressed.wanted()) output.compressed.publish(image, stamp);
  } catch (const ArasError& error) {
    ++dropped_frames_;
    ROS_ERROR_THROTTLE(kErrorPeriodS, "no image: %s", error.what());
  }
}

void StatePublisher::publishPath(const ros::Time& stamp, const geometry_msgs::Pose& pose) {
  if (path_.getNumSubscribers() == 0) return;
  if (path_message_.poses.size() >= kLongestPath) path_message_.poses.erase(path_message_.poses.begin());
  auto entry = stamped<geometry_msgs::PoseStamped>(stamp, kWorldFrame);
  entry.pose = pose;
  path_message_.poses.push_back(entry);
  const ros::WallTime now = ros::WallTime::now();
  if ((now - path_sent_).toSec() < kPathPeriodS) return;
  path_sent_ = now;
  path_message_.header.stamp = stamp;
  path_.publish(path_message_);
}

std::vector<int> StatePublisher::resume() {
  const std::int64_t tick = simulation_.ticks();
  sampled_tick_ = -1;
  next_clock_ = clock_schedule_.firstIndexFrom(tick);
  next_joints_ = joint_schedule_.firstIndexFrom(tick);
  late_joints_.clear();
  path_message_.poses.clear();
  publishClock();
  publishLate();
  publishPresentJoints(true);
  std::vector<int> taken;
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    if (simulation_.cameras()[static_cast<int>(k)].frameTaken(tick)) taken.push_back(static_cast<int>(k));
  }
  const ros::Time stamp = time_.now();
  if (!taken.empty()) publishTarget(stamp);
  for (const int camera : taken) {
    if (!simulation_.cameras()[camera].takenFrame()) {
      publishCamera(camera, stamp, simulation_.cameraPose(camera), simulation_.cameraTwist(camera));
    }
    FrameWanted frame = wantedOf(camera);
    try {
      if (frame.geometry) simulation_.renderGeometry(camera);
      if (frame.image) simulation_.render(camera);
    } catch (const ArasError&) {
      frame.failed = std::current_exception();
    }
    publishImage(frame);
  }
  return taken;
}

/** What belongs to the images that are on their way, or went out just now, in the order of their stamps. */
void StatePublisher::publishLate() {
  std::multimap<std::int64_t, std::pair<int, const ExposedFrame*>> frames;
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    for (const ExposedFrame* frame : simulation_.cameras()[static_cast<int>(k)].lateFrames()) {
      frames.emplace(frame->tick(), std::make_pair(static_cast<int>(k), frame));
    }
  }
  for (const auto& [tick, entry] : frames) {
    const auto& [camera, frame] = entry;
    const ros::Time stamp = time_.at(tick * simulation_.periodNs());
    publishJoints(stamp, frame->q, frame->v, frame->efforts, true);
    publishCamera(camera, stamp, frame->present.X_WC, frame->V_WC_C);
  }
}

}  // namespace aras_visual_servo_sim
