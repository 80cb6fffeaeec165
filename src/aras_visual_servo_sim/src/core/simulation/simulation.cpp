#include "aras_visual_servo_sim/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "aras_visual_servo_sim/camera/camera_tags.hpp"
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/render/coverage_renderer.hpp"
#include "aras_visual_servo_sim/robot/joint_limits_reader.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1000000000;
constexpr std::uint64_t kDropSeed = 0x64726f70;  // keeps the drawing of drops apart from that of noise
constexpr double kWholeNanosecond = 1e-3;        // rounding of period_s * 1e9, far below one nanosecond

std::int64_t wholeNanoseconds(double period_s) {
  const double period_ns = period_s * static_cast<double>(kNanosecondsPerSecond);
  const std::int64_t rounded = std::llround(period_ns);
  if (rounded < 1 || std::abs(period_ns - static_cast<double>(rounded)) > kWholeNanosecond) {
    throw ParameterError("sim/period_s: found " + std::to_string(period_s) + ", allowed a whole number of nanoseconds");
  }
  return rounded;
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text.empty() ? "none" : text;
}

}  // namespace

Simulation::Simulation(RobotModel model, SimulationConfig config, const YAML::Node& controllers,
                       const PackagePaths& packages)
    : model_(std::move(model)),
      config_(std::move(config)),
      period_ns_(wholeNanoseconds(config_.world.period_s)),
      packages_(packages),
      renderer_(std::make_unique<CoverageRenderer>()) {
  std::vector<std::string> faults;
  const auto collect = [&faults](const auto& action) {
    try {
      action();
    } catch (const ArasError& error) {
      faults.emplace_back(error.what());
    }
  };
  collect([&] { applyJointLimits(controllers, model_); });
  collect([&] { config_.world.controllers = parseControllers(controllers, model_); });
  collect([&] { models_.scene = loadScene(config_.scene, packages); });
  for (std::size_t k = 0; k < models_.scene.bodies.size(); ++k) models_.body_links.push_back(-1);
  collect([&] { addRobotBodies(model_, packages, models_.scene); });
  for (std::size_t k = models_.body_links.size(); k < models_.scene.bodies.size(); ++k) {
    models_.body_links.push_back(model_.linkIndex(models_.scene.bodies[k].name));
  }
  for (const std::string& name : modelNames()) models_.starts[name] = placeOf(name);

  if (faults.empty())
    collect([&] {
      for (const auto& solid : config_.scene["solids"]) checkTouched(solid, models_);
      touching_ = touchable(models_);
    });

  initial_q_ = Eigen::VectorXd::Zero(model_.dofs());
  for (const auto& [joint, position] : config_.initial_positions) {
    collect([&, &joint = joint, &position = position] { initial_q_[model_.jointIndex(joint)] = position; });
  }
  if (config_.cameras.empty())
    collect([&] { config_.cameras = camerasFromTags(model_, model_.warnings, config_.gazebo_cameras); });
  for (const CameraConfig& camera : config_.cameras) addCamera(camera, faults);
  if (faults.empty()) collect([&] { makeWorld(); });
  if (!faults.empty()) throw ParameterError(joined(faults, "\n"));
  startModels();
}

Simulation::~Simulation() = default;

void Simulation::addCamera(const CameraConfig& config, std::vector<std::string>& faults) {
  const std::string where = "sim/cameras '" + config.name + "': ";
  if (std::find(camera_names_.begin(), camera_names_.end(), config.name) != camera_names_.end()) {
    faults.push_back(where + "found twice, allowed once");
  }
  try {
    const int link = model_.linkIndex(config.mount.empty() ? config.frame : config.mount);
    Camera camera{CameraModel(config), FrameSchedule(config.rate_hz, period_ns_),
                  Exposure(config.exposure_s, config.exposure_samples, period_ns_),
                  FramesInFlight(config.latency_s, period_ns_), link};
    any_late_ = any_late_ || camera.flight.late();
    longest_latency_ns_ = std::max(longest_latency_ns_, camera.flight.latencyTicks() * period_ns_);
    camera.drop_seed = config_.seed + kDropSeed + cameras_.size();
    camera_names_.push_back(config.name);
    cameras_.push_back(std::move(camera));
  } catch (const ArasError& error) {
    faults.push_back(where + error.what());
  }
}

void Simulation::makeWorld() {
  WorldConfig world_config = config_.world;
  world_config.contacts = touching_;
  auto world = std::make_unique<MultibodyWorld>(model_, world_config);
  // Joints whose limits exclude 0 start at the nearer limit unless the configuration names them.
  for (int i = 0; i < model_.dofs(); ++i) {
    if (config_.initial_positions.count(model_.joint_names[i]) == 0) {
      initial_q_[i] = clampPosition(model_.movingJoint(i).limits, initial_q_[i]);
    }
  }
  world->reset(initial_q_);
  world->setJointPositions(config_.initial_positions);  // refuses mimic joints elsewhere than they follow
  initial_q_ = world->jointPositions();
  initial_base_ = world->basePose();
  world_ = std::move(world);
}

// --- time -----------------------------------------------------------------------------------------------------------

void Simulation::passFrame(Camera& camera) {
  const std::int64_t frame = nextFrame(camera), stamp_ns = timeNs();
  run_hash_.add(&stamp_ns, sizeof(stamp_ns));
  const Eigen::VectorXd& q = world_->jointPositions();
  const Eigen::VectorXd& v = world_->jointVelocities();
  run_hash_.add(q.data(), sizeof(double) * q.size());
  run_hash_.add(v.data(), sizeof(double) * v.size());
  if (world_->floatingBase()) {
    const Pose base = world_->basePose();
    run_hash_.add(base.p.data(), sizeof(double) * 3);
    run_hash_.add(base.q.coeffs().data(), sizeof(double) * 4);
  }
  camera.dropped += frame - camera.next_frame;
  camera.next_frame = frame + 1;
  camera.asked = false;
}

void Simulation::step(std::int64_t n) {
  if (n < 0) throw ParameterError("step: found " + std::to_string(n) + " periods, allowed >= 0");
  const std::int64_t end = ticks() + n;
  while (ticks() < end) {
    if (any_late_) expose();
    std::int64_t next = end;
    for (std::size_t k = 0; k < cameras_.size(); ++k) {
      if (!cameras_[k].flight.late() && frameDue(static_cast<int>(k))) passFrame(cameras_[k]);
      cameras_[k].unhashed_frame = -1;
      next = std::min({next, nextExposureTick(static_cast<int>(k)), noteExposure(static_cast<int>(k))});
    }
    if (touching_.any()) {
      stepTouching(next - ticks());
    } else {
      world_->step(static_cast<int>(next - ticks()));
    }
    if (any_late_) passFramesInFlight();
  }
  moveModels();
  if (any_late_ && n > 0) expose();
}

std::int64_t Simulation::stepToImage(const std::string& camera) {
  const int index = cameraIndex(camera);
  if (nextFrameTick(index) == kNever) {
    throw ParameterError("camera '" + camera + "': takes frames only when triggered, and nobody asked for one");
  }
  step(nextFrameTick(index) - ticks());
  return takeFrame(index);
}

// --- commands -------------------------------------------------------------------------------------------------------

void Simulation::holdStill() {
  for (const ControllerConfig& controller : config_.world.controllers) {
    if (controller.type != ControllerType::kEffort) world_->setVelocity(controller.joint, 0.0);
  }
}

void Simulation::refuse(const std::string& reason) {
  ++refused_commands_;
  last_refusal_ = reason;
  holdStill();
}

template <typename Action>
void Simulation::acceptOrRefuse(const Action& action) {
  try {
    action();
  } catch (const ArasError& error) {
    refuse(error.what());
    throw;
  }
}

void Simulation::setCommand(const JointCommand& command, std::optional<std::int64_t> stamp_ns) {
  acceptOrRefuse([&] {
    const std::int64_t age_ns = timeNs() - stamp_ns.value_or(timeNs());
    const double age_s = 1e-9 * static_cast<double>(age_ns);
    const double late_s = 1e-9 * static_cast<double>(age_ns - longest_latency_ns_);
    if (age_s < 0.0) {
      throw ParameterError("command: stamp is " + std::to_string(-age_s) + " s in the future, now is " +
                           std::to_string(timeS()) + " s of simulated time");
    }
    if (!command.empty() && config_.command_timeout_s > 0.0 && late_s > config_.command_timeout_s) {
      throw ParameterError("command: stamp is " + std::to_string(age_s) +
                           " s old, allowed <= " + std::to_string(config_.command_timeout_s + age_s - late_s) +
                           " s (sim/command_timeout_s" + (any_late_ ? " and the longest latency_s of a camera)" : ")"));
    }
    world_->setCommand(command);
  });
}

void Simulation::setControllerCommand(const std::string& controller, double value) {
  acceptOrRefuse([&] { world_->setControllerCommand(controller, value); });
}

// --- starting again -------------------------------------------------------------------------------------------------

void Simulation::resetWorld() {
  std::map<std::string, double> positions;
  for (int i = 0; i < model_.dofs(); ++i) positions[model_.joint_names[i]] = initial_q_[i];
  world_->setJointPositions(positions);
  if (world_->floatingBase()) world_->setBasePose(initial_base_);
  startModels();
  forgetPast();
}

void Simulation::reset() {
  if (built_) {
    models_ = *built_;
    touching_ = touchable(models_);
  }
  makeWorld();
  resetWorld();
  for (Camera& camera : cameras_) {
    camera.next_frame = 0;
    camera.unhashed_frame = -1;
    camera.asked = false;
    camera.dropped = 0;
    camera.flight.clear();
  }
  run_hash_.reset();
  refused_commands_ = 0;
  last_refusal_.clear();
}

}  // namespace aras_visual_servo_sim
