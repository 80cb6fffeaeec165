#include "aras_visual_servo_sim/simulation/cameras/cameras.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

void Cameras::add(const CameraConfig& config, const RobotModel& robot, std::uint64_t seed, std::int64_t period_ns,
                  const std::string& name, int number) {
  const std::string where = "camera '" + config.name + "': ";
  const std::string full = scoped(name, config.name);
  if (std::find(names_.begin(), names_.end(), full) != names_.end()) {
    throw ParameterError(where + "found twice, allowed once");
  }
  CameraModel model(config);  // names the camera in its faults
  FaultList faults;
  faults.collect(
      [&] {
        const int link = robot.linkIndex(config.mount.empty() ? config.frame : config.mount);
        cameras_.emplace_back(std::move(model), number, link, static_cast<int>(size()), seed, period_ns);
      },
      where);
  faults.throwIfAny();
  names_.push_back(full);
  findLongestLatency();
}

void Cameras::findLongestLatency() {
  longest_latency_ = 0;
  for (const Camera& camera : cameras_) longest_latency_ = std::max(longest_latency_, camera.latencyTicks());
}

void Cameras::add(Cameras others, std::int64_t tick) {
  for (std::size_t k = 0; k < others.size(); ++k) {
    names_.push_back(others.names_[k]);
    cameras_.push_back(std::move(others.cameras_[k]));
    cameras_.back().beginAt(tick);
  }
  findLongestLatency();
}

void Cameras::remove(int robot) {
  for (std::size_t k = size(); k-- > 0;) {
    if (cameras_[k].robot() != robot) continue;
    names_.erase(names_.begin() + static_cast<std::ptrdiff_t>(k));
    cameras_.erase(cameras_.begin() + static_cast<std::ptrdiff_t>(k));
  }
  findLongestLatency();
}

int Cameras::index(const std::string& camera) const {
  const auto found = std::find(names_.begin(), names_.end(), camera);
  if (found == names_.end()) {
    throw UnknownNameError("camera '" + camera +
                           "': not found, cameras are: " + (names_.empty() ? "none" : joined(names_)));
  }
  return static_cast<int>(found - names_.begin());
}

std::uint64_t Cameras::droppedFrames() const {
  std::uint64_t dropped = 0;
  for (const Camera& camera : cameras_) dropped += camera.droppedFrames();
  return dropped;
}

namespace {

/** Adds a fault for each setting that camera_info tells, or on which the schedule stands, and that is another one. */
void requireSameView(const CameraConfig& now, const CameraConfig& next, FaultList& faults) {
  const auto require = [&](bool same, const std::string& key) {
    if (!same) faults.add("camera '" + now.name + "': " + key + ": found another one, allowed that of the start");
  };
  require(next.name == now.name, "name");
  require(next.frame == now.frame && next.mount == now.mount, "frame");
  require(next.X_MC.p == now.X_MC.p && next.X_MC.q.coeffs() == now.X_MC.q.coeffs(), "pose");
  require(next.width == now.width && next.height == now.height, "size");
  require(next.horizontal_fov_rad == now.horizontal_fov_rad && next.fx_px == now.fx_px && next.fy_px == now.fy_px &&
              next.cx_px == now.cx_px && next.cy_px == now.cy_px,
          "intrinsics");
  require(next.distortion_model == now.distortion_model && next.distortion == now.distortion &&
              next.cutoff_angle_rad == now.cutoff_angle_rad,
          "distortion");
  require(next.rate_hz == now.rate_hz && next.triggered == now.triggered, "rate_hz");
  require(next.encoding == now.encoding, "encoding");
  require(next.baseline_m == now.baseline_m, "baseline_m");
}

}  // namespace

Cameras Cameras::with(const std::vector<CameraConfig>& configs, const RobotModel& robot, std::uint64_t seed,
                      std::int64_t period_ns) const {
  if (configs.size() != size()) {
    throw ParameterError("cameras: found " + std::to_string(configs.size()) + ", allowed " + std::to_string(size()) +
                         ", as at the start");
  }
  Cameras next;
  FaultList faults;
  for (std::size_t k = 0; k < size(); ++k) {
    requireSameView(cameras_[k].model().config(), configs[k], faults);
    faults.collect([&] { next.add(configs[k], robot, seed, period_ns); });
  }
  faults.throwIfAny();
  return next;
}

void Cameras::become(Cameras next, std::int64_t now) {
  for (std::size_t k = 0; k < size(); ++k) next.cameras_[k].continueFrom(cameras_[k], now);
  *this = std::move(next);
}

void Cameras::keepModels(const ModelSet& models) {
  std::shared_ptr<ModelSet> kept;
  for (Camera& camera : cameras_) {
    if (!camera.hasFramesInFlight()) continue;
    if (!kept) kept = std::make_shared<ModelSet>(models);
    camera.keepModels(kept);
  }
}

void Cameras::forgetPast() {
  for (Camera& camera : cameras_) camera.forgetPast();
}

void Cameras::loseFrames() {
  for (Camera& camera : cameras_) camera.loseFrames();
}

void Cameras::reset() {
  for (Camera& camera : cameras_) camera.restore(Camera::State{});
}

}  // namespace aras_visual_servo_sim
