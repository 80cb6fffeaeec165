#include "aras_visual_servo_sim/simulation/cameras/camera.hpp"

#include <utility>

#include "aras_visual_servo_sim/image/sensor/gaussian_noise.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint64_t kSeedStride = 1000003;   // keeps the noise of several cameras apart
constexpr std::uint64_t kDropSeed = 0x64726f70;  // keeps the drawing of drops apart from that of noise

}  // namespace

Camera::Camera(CameraModel model, int link, int index, std::uint64_t seed, std::int64_t period_ns)
    : model_(std::move(model)),
      link_(link),
      noise_seed_(seed + kSeedStride * static_cast<std::uint64_t>(index)),
      plan_(model_.config(), period_ns, seed + kDropSeed + static_cast<std::uint64_t>(index)),
      exposure_(model_.config().exposure_s, model_.config().exposure_samples, period_ns),
      flight_(model_.config().latency_s, period_ns) {}

Pose Camera::pose(const MultibodyWorld& world) const {
  const Pose X_WM = world.linkPose(link_);
  const CameraConfig& config = model_.config();
  return config.mount.empty() ? X_WM : X_WM * config.X_MC;
}

Twist Camera::twist(const MultibodyWorld& world) const {
  const Twist V_WM_M = world.linkTwist(link_);
  const CameraConfig& config = model_.config();
  if (config.mount.empty()) return V_WM_M;
  const Eigen::Vector3d v = V_WM_M.head<3>(), w = V_WM_M.tail<3>();
  const Eigen::Quaterniond q_CM = config.X_MC.q.conjugate();
  Twist V_WC_C;
  V_WC_C << q_CM * (v + w.cross(config.X_MC.p)), q_CM * w;
  return V_WC_C;
}

std::int64_t Camera::nextFrameTick() const {
  if (!flight_.inFlight().empty()) return flight_.nextDelivery();
  const std::int64_t exposure = nextExposureTick();
  return exposure == kNeverTick ? kNeverTick : exposure + latencyTicks();
}

bool Camera::frameTaken(std::int64_t now) const { return late() ? takenFrame() != nullptr : plan_.passedAt(now); }

void Camera::expose(Moment present, const MultibodyWorld& world) {
  ExposedFrame frame;
  frame.q = world.jointPositions();
  frame.v = world.jointVelocities();
  frame.efforts = world.jointEfforts();
  frame.V_WC_C = twist(world);
  frame.present = std::move(present);
  if (blurs()) {
    for (const Exposure::Sample& sample : samplesOf(frame.present)) {
      frame.samples.emplace_back(*sample.moment, sample.count);
    }
  }
  frame.index = plan_.pass();
  flight_.expose(std::move(frame));
}

std::int64_t Camera::takeDelivered() {
  const ExposedFrame& frame = flight_.take();
  unhashed_frame_ = frame.index;
  return frame.tick();
}

std::vector<const ExposedFrame*> Camera::lateFrames() const {
  std::vector<const ExposedFrame*> frames;
  if (takenFrame()) frames.push_back(takenFrame());
  for (const ExposedFrame& frame : flight_.inFlight()) frames.push_back(&frame);
  return frames;
}

void Camera::note(Moment moment) {
  const std::int64_t frame_tick = plan_.tickFrom(moment.tick + 1);
  exposure_.note(std::move(moment), frame_tick);
}

bool Camera::noisy() const { return model_.config().noise_stddev != 0.0 || model_.config().noise_mean != 0.0; }

void Camera::readOut(std::int64_t now) {
  const CameraConfig& config = model_.config();
  const std::int64_t index = takenFrame() ? takenFrame()->index : plan_.indexFrom(now);
  addGaussianNoise(light, config.noise_stddev, noise_seed_, static_cast<std::uint64_t>(index), config.noise_mean,
                   image);
}

bool Camera::imageIsOfNewFrame() { return std::exchange(unhashed_frame_, -1) >= 0; }

void Camera::restore(State state) {
  plan_.setState(state.plan);
  unhashed_frame_ = state.unhashed_frame;
  exposure_.setPast(std::move(state.past));
  flight_.restore(std::move(state.taken), std::move(state.in_flight));
}

}  // namespace aras_visual_servo_sim
