#include "state_record.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/simulation/state/run_hash.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Hash of the first `size` bytes. */
std::uint64_t checksum(const std::string& bytes, std::size_t size) {
  RunHash hash;
  hash.add(bytes.data(), size);
  return hash.state();
}

}  // namespace

void StateWriter::putText(const std::string& text) {
  put<std::uint64_t>(text.size());
  bytes_ += text;
}

void StateWriter::putVector(const Eigen::VectorXd& values) {
  put<std::uint64_t>(values.size());
  for (const double value : values) put(value);
}

void StateWriter::putPose(const Pose& pose) {
  for (int k = 0; k < 3; ++k) put(pose.p[k]);
  for (int k = 0; k < 4; ++k) put(pose.q.coeffs()[k]);
}

void StateWriter::putMoment(const Moment& moment) {
  put(moment.tick);
  putPose(moment.X_WC);
  for (const std::vector<Pose>* poses : {&moment.models, &moment.bodies, &moment.lights}) {
    put<std::uint64_t>(poses->size());
    for (const Pose& pose : *poses) putPose(pose);
  }
}

std::string StateWriter::take() {
  put(checksum(bytes_, bytes_.size()));
  return std::move(bytes_);
}

StateReader::StateReader(const std::string& bytes) : bytes_(bytes) {
  std::uint64_t sum = 0;
  if (bytes.size() >= sizeof(sum)) {
    end_ = bytes.size() - sizeof(sum);
    std::memcpy(&sum, bytes.data() + end_, sizeof(sum));
  }
  if (end_ == 0 || sum != checksum(bytes, end_)) {
    throw StateError("saved state: found " + std::to_string(bytes.size()) +
                     " bytes that are damaged, cut short or none of save_state's");
  }
}

std::string StateReader::getText() {
  const auto size = get<std::uint64_t>();
  const char* data = take(size);
  return std::string(data, size);
}

Eigen::VectorXd StateReader::getVector(Eigen::Index size) {
  if (const auto found = get<std::uint64_t>(); found != static_cast<std::uint64_t>(size)) {
    throw StateError("saved state: found a vector of " + std::to_string(found) + " numbers, allowed " +
                     std::to_string(size) + " for this robot");
  }
  Eigen::VectorXd values(size);
  for (double& value : values) value = get<double>();
  return values;
}

Pose StateReader::getPose() {
  Pose pose;
  for (int k = 0; k < 3; ++k) pose.p[k] = get<double>();
  for (int k = 0; k < 4; ++k) pose.q.coeffs()[k] = get<double>();
  if (!pose.p.allFinite() || !pose.q.coeffs().allFinite()) throw StateError("saved state: a pose is not finite");
  return pose;
}

std::vector<Pose> StateReader::getPoses(std::size_t count) {
  if (const auto found = get<std::uint64_t>(); found != count) {
    throw StateError("saved state: found an exposure of " + std::to_string(found) +
                     " models, bodies or lights, allowed " + std::to_string(count) + " as in this scene");
  }
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < count; ++k) poses.push_back(getPose());
  return poses;
}

Moment StateReader::getMoment(const Scene& scene) {
  Moment moment;
  moment.tick = get<std::int64_t>();
  moment.X_WC = getPose();
  moment.models = getPoses(scene.models.size());
  moment.bodies = getPoses(scene.bodies.size());
  const auto attached = [](const Light& light) { return !light.attached_to.empty(); };
  const auto& lights = scene.lighting.lights;
  moment.lights = getPoses(static_cast<std::size_t>(std::count_if(lights.begin(), lights.end(), attached)));
  return moment;
}

const char* StateReader::take(std::uint64_t size) {
  if (size > end_ - at_)
    throw StateError("saved state: found " + std::to_string(end_) + " bytes, allowed more: it ends early");
  const char* data = bytes_.data() + at_;
  at_ += size;
  return data;
}

}  // namespace aras_visual_servo_sim
