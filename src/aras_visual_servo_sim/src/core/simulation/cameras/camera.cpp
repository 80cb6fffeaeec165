#include "aras_visual_servo_sim/simulation/cameras/camera.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "aras_visual_servo_sim/image/sensor/gaussian_noise.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint64_t kSeedStride = 1000003;   // keeps the noise of several cameras apart
constexpr std::uint64_t kDropSeed = 0x64726f70;  // keeps the drawing of drops apart from that of noise

Exposure exposureOf(const CameraModel& model, std::int64_t period_ns) {
  const CameraConfig& config = model.config();
  if (config.sensor && config.sensor->row_time_s > 0.0) {
    return Exposure::ofRows(config.exposure_s + config.sensor->row_time_s * (model.height() - 1), period_ns);
  }
  return {config.exposure_s, config.exposure_samples, period_ns};
}

Sensor sensorOf(const CameraModel& model, int index, std::uint64_t seed) {
  const CameraConfig& config = model.config();
  std::vector<float> cosines;
  for (int v = 0; config.sensor->vignetting_exponent > 0.0 && v < model.height(); ++v) {
    for (int u = 0; u < model.width(); ++u) {
      const Eigen::Vector3d ray = model.pixelRay(u, v);
      cosines.push_back(static_cast<float>(std::max(0.0, ray.z() / ray.norm())));
    }
  }
  const double integration_s = config.exposure_s > 0.0 ? config.exposure_s : 1.0 / config.rate_hz;
  const auto pattern_seed =
      static_cast<std::uint64_t>(config.sensor->pattern_seed) + kSeedStride * std::uint64_t(index);
  return {*config.sensor, model.width(), model.height(), model.encoding(), cosines,
          integration_s,  seed,          pattern_seed,   model.fx()};
}

constexpr double kDither = 0.5;  // [grey levels]: the mean of rounded values is then right to a hundredth of a level

double noiseOf(const CameraConfig& config) {
  return config.dither ? std::max(config.noise_stddev, kDither) : config.noise_stddev;
}

}  // namespace

Camera::Camera(CameraModel model, int robot, int link, int index, std::uint64_t seed, std::int64_t period_ns)
    : model_(std::move(model)),
      robot_(robot),
      link_(link),
      period_ns_(period_ns),
      noise_seed_(seed + kSeedStride * static_cast<std::uint64_t>(index)),
      plan_(model_.config(), period_ns, seed + kDropSeed + static_cast<std::uint64_t>(index)),
      exposure_(exposureOf(model_, period_ns)),
      latency_ticks_((std::llround(1e9 * model_.config().latency_s) + period_ns - 1) / period_ns) {
  const std::optional<SensorConfig>& sensor = model_.config().sensor;
  if (!sensor) return;
  sensor_ = sensorOf(model_, index, noise_seed_);
  for (int v = 0; sensor->row_time_s > 0.0 && v < model_.height(); ++v) rows_.push_back(model_.row(v));
}

Pose Camera::pose(const MultibodyWorld& robot) const {
  const Pose X_WM = robot.linkPose(link_);
  const CameraConfig& config = model_.config();
  return config.mount.empty() ? X_WM : X_WM * config.X_MC;
}

Twist Camera::twist(const MultibodyWorld& robot) const {
  const Twist V_WM_M = robot.linkTwist(link_);
  const CameraConfig& config = model_.config();
  if (config.mount.empty()) return V_WM_M;
  const Eigen::Vector3d v = V_WM_M.head<3>(), w = V_WM_M.tail<3>();
  const Eigen::Quaterniond q_CM = config.X_MC.q.conjugate();
  Twist V_WC_C;
  V_WC_C << q_CM * (v + w.cross(config.X_MC.p)), q_CM * w;
  return V_WC_C;
}

std::int64_t Camera::nextFrameTick() const {
  if (!in_flight_.empty()) return in_flight_.front().tick() + latency_ticks_;
  const std::int64_t exposure = nextExposureTick();
  return exposure == kNeverTick ? kNeverTick : exposure + latency_ticks_;
}

bool Camera::frameTaken(std::int64_t now) const { return late() ? takenFrame() != nullptr : plan_.passedAt(now); }

void Camera::expose(Moment present, const MultibodyWorld& robot) {
  ExposedFrame frame;
  frame.q = robot.jointPositions();
  frame.v = robot.jointVelocities();
  frame.efforts = robot.jointEfforts();
  frame.V_WC_C = twist(robot);
  frame.present = std::move(present);
  if (blurs()) {
    for (const Exposure::Sample& sample : samplesOf(frame.present)) {
      frame.samples.emplace_back(*sample.moment, sample.count);
    }
  }
  frame.index = plan_.pass();
  in_flight_.push_back(std::move(frame));
}

std::int64_t Camera::takeDelivered() {
  taken_ = std::move(in_flight_.front());
  in_flight_.pop_front();
  unhashed_frame_ = taken_->index;
  return taken_->tick();
}

void Camera::passTo(std::int64_t now) {
  while (!in_flight_.empty() && in_flight_.front().tick() + latency_ticks_ < now) in_flight_.pop_front();
  if (taken_ && taken_->tick() + latency_ticks_ < now) taken_.reset();
}

void Camera::keepModels(const std::shared_ptr<ModelSet>& models) {
  for (ExposedFrame& frame : in_flight_) {
    if (!frame.models) frame.models = models;
  }
  if (taken_ && !taken_->models) taken_->models = models;
}

void Camera::loseFrames() {
  in_flight_.clear();
  taken_.reset();
}

std::vector<const ExposedFrame*> Camera::lateFrames() const {
  std::vector<const ExposedFrame*> frames;
  if (takenFrame()) frames.push_back(takenFrame());
  for (const ExposedFrame& frame : in_flight_) frames.push_back(&frame);
  return frames;
}

void Camera::note(Moment moment) {
  const std::int64_t frame_tick = plan_.tickFrom(moment.tick + 1);
  exposure_.note(std::move(moment), frame_tick);
}

bool Camera::readsOut() const {
  const CameraConfig& config = model_.config();
  const Encoding encoding = model_.encoding();
  return sensor_ || noiseOf(config) != 0.0 || config.noise_mean != 0.0 || isBayer(encoding) || isDeep(encoding);
}

void Camera::readOut(std::int64_t now) {
  const CameraConfig& config = model_.config();
  const std::int64_t index = takenFrame() ? takenFrame()->index : plan_.indexFrom(now);
  if (sensor_) return sensor_->readOut(light, static_cast<std::uint64_t>(index), unhashed_frame_ >= 0, image);
  if (isBayer(model_.encoding())) throughBayerFilter(light, model_.encoding(), mosaic_);
  addGaussianNoise(isBayer(model_.encoding()) ? mosaic_ : light, noiseOf(config), noise_seed_,
                   static_cast<std::uint64_t>(index), config.noise_mean, model_.encoding(), image);
}

bool Camera::imageIsOfNewFrame() { return std::exchange(unhashed_frame_, -1) >= 0; }

void Camera::check(const State& state, std::int64_t now) const {
  if (plan_.canBe(state.plan, now)) return;
  throw StateError("saved state: camera '" + model_.config().name + "': found the next frame " +
                   std::to_string(state.plan.next) + ", allowed " + std::to_string(plan_.indexFrom(now)) + " or " +
                   std::to_string(plan_.indexFrom(now + 1)) + " at this time");
}

Camera::State Camera::state() const {
  State state{plan_.state(), unhashed_frame_, exposure_.past(), taken_, in_flight_, {}};
  if (sensor_) state.sensor = sensor_->state();
  return state;
}

void Camera::restore(State state) {
  plan_.setState(state.plan);
  unhashed_frame_ = state.unhashed_frame;
  exposure_.setPast(std::move(state.past));
  taken_ = std::move(state.taken);
  in_flight_ = std::move(state.in_flight);
  if (sensor_) sensor_->restore(std::move(state.sensor));
}

void Camera::continueFrom(Camera& before, std::int64_t now) {
  State state = before.state();
  state.past.clear();
  if (!(sensor_ && sensor_->setsItself() && before.sensor_ && before.sensor_->setsItself())) state.sensor = {};
  restore(std::move(state));
  if (!late()) loseFrames();
  passTo(now);
  image = std::move(before.image);  // who shows it goes on showing the same memory
  geometry = std::move(before.geometry);
  light = std::move(before.light);
}

}  // namespace aras_visual_servo_sim
