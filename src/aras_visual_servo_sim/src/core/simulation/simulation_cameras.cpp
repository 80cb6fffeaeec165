// Cameras of a Simulation: frames, images, poses.
#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/splitmix.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint64_t kSeedStride = 1000003;  // keeps the noise of several cameras apart

}  // namespace

int Simulation::cameraIndex(const std::string& camera) const {
  const auto found = std::find(camera_names_.begin(), camera_names_.end(), camera);
  if (found == camera_names_.end()) {
    std::string names;
    for (const std::string& name : camera_names_) names += (names.empty() ? "" : ", ") + name;
    throw UnknownNameError("camera '" + camera + "': not found, cameras are: " + (names.empty() ? "none" : names));
  }
  return static_cast<int>(found - camera_names_.begin());
}

bool Simulation::frameDue(int camera) const { return nextFrameTick(camera) == ticks(); }

bool Simulation::frameTaken(int camera) const {
  const Camera& each = cameras_[camera];
  if (each.flight.late()) return each.flight.taken() != nullptr;
  const std::int64_t last = each.next_frame - 1;
  return last >= 0 && !each.asked && each.schedule.tickOf(last) == ticks();
}

std::int64_t Simulation::nextExposureTick(int camera) const {
  const Camera& each = cameras_[camera];
  if (each.model.config().triggered && !each.asked) return kNever;
  return each.schedule.tickOf(nextFrame(each));
}

std::int64_t Simulation::nextFrameTick(int camera) const {
  const FramesInFlight& flight = cameras_[camera].flight;
  if (!flight.inFlight().empty()) return flight.nextDelivery();
  const std::int64_t exposure = nextExposureTick(camera);
  return exposure == kNever ? kNever : exposure + flight.latencyTicks();
}

bool Simulation::isDropped(const Camera& camera, std::int64_t frame) {
  const double probability = camera.model.config().drop_probability;
  if (probability <= 0.0) return false;
  using splitmix::kGolden;
  using splitmix::mix;
  const std::uint64_t draw = mix(mix(camera.drop_seed + kGolden) ^ (static_cast<std::uint64_t>(frame) * kGolden + 1));
  return static_cast<double>(draw >> 11) < probability * 0x1p53;
}

/** The smallest index neither taken nor missed that is not dropped. */
std::int64_t Simulation::nextFrame(const Camera& camera) {
  std::int64_t frame = camera.next_frame;
  while (isDropped(camera, frame)) ++frame;
  return frame;
}

void Simulation::trigger(int camera) {
  Camera& each = cameras_[camera];
  if (!each.model.config().triggered || each.asked) return;
  each.asked = true;
  each.next_frame = std::max(each.next_frame, each.schedule.firstIndexFrom(ticks() + 1));
}

std::uint64_t Simulation::droppedFrames() const {
  std::uint64_t dropped = 0;
  for (const Camera& camera : cameras_) dropped += camera.dropped;
  return dropped;
}

std::int64_t Simulation::takeFrame(int camera) {
  if (!frameDue(camera)) {
    throw ParameterError("camera '" + camera_names_[camera] + "': no frame is due at tick " + std::to_string(ticks()));
  }
  Camera& each = cameras_[camera];
  if (any_late_) expose();  // before anything of this tick is taken
  if (each.flight.late()) {
    const ExposedFrame& frame = each.flight.take();
    each.unhashed_frame = frame.index;
    return frame.tick() * period_ns_;
  }
  const std::int64_t frame = nextFrame(each);
  passFrame(each);
  each.unhashed_frame = frame;
  return timeNs();
}

void Simulation::placeBodies() {
  for (std::size_t k = 0; k < models_.body_links.size(); ++k) {
    if (models_.body_links[k] >= 0) models_.scene.bodies[k].X_WB = world_->linkPose(models_.body_links[k]);
  }
}

const Image& Simulation::render(int index) {
  Camera& camera = cameras_[index];
  const ExposedFrame* late = camera.flight.taken();
  if (late) {
    drawFrame(camera, *late);
  } else {
    drawPresent(index);
  }
  const CameraConfig& config = camera.model.config();
  if (config.noise_stddev > 0.0 || config.noise_mean != 0.0) {
    const std::int64_t frame = late ? late->index : camera.schedule.firstIndexFrom(ticks());
    addGaussianNoise(camera.image, config.noise_stddev, config_.seed + kSeedStride * static_cast<std::uint64_t>(index),
                     static_cast<std::uint64_t>(frame), config.noise_mean);
  }
  if (camera.unhashed_frame >= 0) {
    run_hash_.add(camera.image.data.data(), camera.image.data.size());
    camera.unhashed_frame = -1;
  }
  return camera.image;
}

Pose Simulation::cameraPose(int camera) const {
  const Pose X_WM = world_->linkPose(cameras_[camera].link);
  const CameraConfig& config = cameras_[camera].model.config();
  return config.mount.empty() ? X_WM : X_WM * config.X_MC;
}

Twist Simulation::cameraTwist(int camera) const {
  const Twist V_WM_M = world_->linkTwist(cameras_[camera].link);
  const CameraConfig& config = cameras_[camera].model.config();
  if (config.mount.empty()) return V_WM_M;
  const Eigen::Vector3d v = V_WM_M.head<3>(), w = V_WM_M.tail<3>();
  const Eigen::Quaterniond q_CM = config.X_MC.q.conjugate();
  Twist V_WC_C;
  V_WC_C << q_CM * (v + w.cross(config.X_MC.p)), q_CM * w;
  return V_WC_C;
}

}  // namespace aras_visual_servo_sim
