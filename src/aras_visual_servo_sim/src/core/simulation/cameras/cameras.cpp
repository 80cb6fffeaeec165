#include "aras_visual_servo_sim/simulation/cameras/cameras.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

void Cameras::add(const CameraConfig& config, const RobotModel& robot, std::uint64_t seed, std::int64_t period_ns) {
  const std::string where = "camera '" + config.name + "': ";
  if (std::find(names_.begin(), names_.end(), config.name) != names_.end()) {
    throw ParameterError(where + "found twice, allowed once");
  }
  CameraModel model(config);  // names the camera in its faults
  FaultList faults;
  faults.collect(
      [&] {
        const int link = robot.linkIndex(config.mount.empty() ? config.frame : config.mount);
        cameras_.emplace_back(std::move(model), link, static_cast<int>(size()), seed, period_ns);
      },
      where);
  faults.throwIfAny();
  names_.push_back(config.name);
  longest_latency_ = std::max(longest_latency_, cameras_.back().latencyTicks());
}

int Cameras::index(const std::string& camera) const {
  const auto found = std::find(names_.begin(), names_.end(), camera);
  if (found == names_.end()) {
    std::string known;
    for (const std::string& name : names_) known += (known.empty() ? "" : ", ") + name;
    throw UnknownNameError("camera '" + camera + "': not found, cameras are: " + (known.empty() ? "none" : known));
  }
  return static_cast<int>(found - names_.begin());
}

std::uint64_t Cameras::droppedFrames() const {
  std::uint64_t dropped = 0;
  for (const Camera& camera : cameras_) dropped += camera.droppedFrames();
  return dropped;
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

void Cameras::reset() {
  for (Camera& camera : cameras_) camera.restore(Camera::State{});
}

}  // namespace aras_visual_servo_sim
