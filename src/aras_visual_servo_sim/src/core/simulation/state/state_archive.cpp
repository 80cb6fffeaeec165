#include "state_archive.hpp"

#include <algorithm>
#include <aras_visual_servo_common/files.hpp>
#include <memory>

#include "aras_visual_servo_sim/simulation/state/run_hash.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::size_t kSumBytes = sizeof(std::uint64_t);

std::string checksum(const std::string& bytes) {
  RunHash hash;
  hash.add(bytes.data(), bytes.size());
  const std::uint64_t sum = hash.state();
  return std::string(reinterpret_cast<const char*>(&sum), kSumBytes);
}

/** The record without its checksum. */
std::string checked(const std::string& record) {
  const std::string bytes = record.substr(0, record.size() - std::min(record.size(), kSumBytes));
  if (bytes.empty() || record.compare(bytes.size(), kSumBytes, checksum(bytes)) != 0) {
    throw StateError("saved state: found " + std::to_string(record.size()) +
                     " bytes that are damaged, cut short or none of save_state's");
  }
  return bytes;
}

ModelMotion motionFromText(const std::string& text, const std::string& name) {
  namespace common = aras_visual_servo_common;
  const std::string where = "saved motion of '" + name + "'";
  try {
    return ModelMotion::fromYaml(common::parseYaml(text, common::kMostFileYaml), "motion");
  } catch (const ArasError& error) {
    throw StateError(where + ": " + error.what());
  }
}

}  // namespace

void visit(Archive& archive, FramePlan::State& plan) { archive(plan.next, plan.asked, plan.dropped); }

void visit(Archive& archive, Sensor::State& sensor) {
  archive(sensor.brightness, sensor.balance, sensor.brightnesses, sensor.balances);
}

void visit(Archive& archive, SavedModel& model) { archive(model.name, model.entry, model.X_AM, model.X_AM0); }

void visit(Archive& archive, JointCommand& command) { archive(command.position, command.velocity, command.effort); }

void visit(Archive& archive, Light& light) {
  archive(light.name, light.attached_to, light.type, light.casts_shadows, light.X_WA);
  archive(light.position_W, light.direction_W, light.position_A, light.direction_A, light.diffuse, light.specular);
  archive(light.range_m, light.constant, light.linear_per_m, light.quadratic_per_m2, light.inner_angle_rad,
          light.outer_angle_rad, light.falloff);
}

StateArchive::StateArchive(const std::string& record) : Archive(checked(record)) {}

std::string StateArchive::take() const { return bytes() + checksum(bytes()); }

void StateArchive::models(ModelSet& set, const Compose& compose) {
  std::vector<SavedModel> saved = reads() ? std::vector<SavedModel>() : set.saved();
  std::vector<Light> lights = set.scene.lighting.lights;
  (*this)(saved, lights);
  if (!reads()) return;
  if (lights.size() > Lighting::kMostLights) {
    throw StateError("saved state: found " + std::to_string(lights.size()) + " lights, allowed up to " +
                     std::to_string(Lighting::kMostLights));
  }
  set = compose(saved);
  set.scene.lighting.lights = std::move(lights);
}

void StateArchive::motions(std::map<std::string, MotionRun>& motions, const ModelSet& set) {
  std::uint64_t count = motions.size();
  (*this)(count);
  auto run = motions.begin();
  for (; count > 0; --count) {
    std::string name = reads() ? "" : run->first, motion = reads() ? "" : run->second.motion.yaml();
    (*this)(name, motion);
    if (reads() && set.starts.count(name) == 0) {
      throw StateError("saved state: found a motion of '" + name + "', which is not a model");
    }
    if (reads()) run = motions.insert_or_assign(name, MotionRun{motionFromText(motion, name), Pose(), 0}).first;
    (*this)(run->second.X_WM0, run->second.start_ns);
    ++run;
  }
}

void StateArchive::moment(Moment& moment, const Scene& scene) {
  (*this)(moment.tick, moment.X_WC, moment.models, moment.bodies, moment.lights);
  const auto& lights = scene.lighting.lights;
  const auto attached =
      std::count_if(lights.begin(), lights.end(), [](const Light& light) { return !light.attached_to.empty(); });
  for (const auto& [found, allowed] :
       {std::pair(moment.models.size(), scene.models.size()), std::pair(moment.bodies.size(), scene.bodies.size()),
        std::pair(moment.lights.size(), static_cast<std::size_t>(attached))}) {
    if (!reads() || found == allowed) continue;
    throw StateError("saved state: found an exposure of " + std::to_string(found) +
                     " models, bodies or lights, allowed " + std::to_string(allowed) + " as in this scene");
  }
}

void StateArchive::frame(ExposedFrame& frame, Eigen::Index joints, const Scene& scene, const Compose& compose) {
  for (Eigen::VectorXd* values : {&frame.q, &frame.v, &frame.efforts}) values->resize(joints);
  bool own_models = frame.models != nullptr;
  (*this)(frame.index, frame.q, frame.v, frame.efforts, frame.V_WC_C, own_models);
  if (own_models && reads()) frame.models = std::make_shared<ModelSet>();
  if (own_models) models(*frame.models, compose);
  const Scene& seen = own_models ? frame.models->scene : scene;
  moment(frame.present, seen);
  all(frame.samples, [&](std::pair<Moment, std::uint32_t>& sample) {
    (*this)(sample.second);
    moment(sample.first, seen);
  });
}

}  // namespace aras_visual_servo_sim
