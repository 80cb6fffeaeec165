// How models, motions and frames in flight are written into a saved state and read from it.
#include <aras_visual_servo_common/files.hpp>
#include <memory>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "state_record.hpp"

namespace aras_visual_servo_sim {

void StateWriter::putModels(const std::vector<SavedModel>& models) {
  put<std::uint64_t>(models.size());
  for (const SavedModel& model : models) {
    putText(model.name);
    putText(model.entry);
    putPose(model.X_AM);
    putPose(model.X_AM0);
  }
}

std::vector<SavedModel> StateReader::getModels() {
  std::vector<SavedModel> models;
  for (auto left = get<std::uint64_t>(); left > 0; --left) {
    SavedModel model;
    model.name = getText();
    model.entry = getText();
    model.X_AM = getPose();
    model.X_AM0 = getPose();
    models.push_back(std::move(model));
  }
  return models;
}

ModelSet StateReader::getSet(const Compose& compose) {
  ModelSet set = compose(getModels());
  set.scene.lighting.lights = getLights();
  return set;
}

void StateWriter::putMotions(const std::map<std::string, MotionRun>& motions) {
  put<std::uint64_t>(motions.size());
  for (const auto& [name, run] : motions) {
    putText(name);
    putText(run.motion.yaml());
    putPose(run.X_WM0);
    put(run.start_ns);
  }
}

namespace {

ModelMotion savedMotion(const std::string& text, const std::string& name) {
  namespace common = aras_visual_servo_common;
  const std::string where = "saved motion of '" + name + "'";
  YAML::Node node;
  try {
    node = common::parseYaml(text, common::kMostFileYaml);
  } catch (const ArasError& error) {
    throw StateError(where + ": " + error.what());
  }
  return ModelMotion::fromYaml(node, where);
}

}  // namespace

std::map<std::string, MotionRun> StateReader::getMotions(const ModelSet& set) {
  std::map<std::string, MotionRun> motions;
  for (auto left = get<std::uint64_t>(); left > 0; --left) {
    const std::string name = getText();
    const ModelMotion motion = savedMotion(getText(), name);
    const Pose X_WM0 = getPose();
    motions.emplace(name, MotionRun{motion, X_WM0, get<std::int64_t>()});
    if (set.starts.count(name) == 0)
      throw StateError("saved state: found a motion of '" + name + "', which is not a model");
  }
  return motions;
}

void StateWriter::putFrame(const ExposedFrame& frame) {
  put(frame.index);
  for (const Eigen::VectorXd* values : {&frame.q, &frame.v, &frame.efforts}) putVector(*values);
  putVector(frame.V_WC_C);
  put<std::uint64_t>(frame.models != nullptr);
  if (frame.models) {
    putModels(frame.models->saved());
    putLights(frame.models->scene.lighting.lights);
  }
  putMoment(frame.present);
  put<std::uint64_t>(frame.samples.size());
  for (const auto& [moment, count] : frame.samples) {
    put(count);
    putMoment(moment);
  }
}

ExposedFrame StateReader::getFrame(int joints, const Scene& scene, const Compose& compose) {
  ExposedFrame frame;
  frame.index = get<std::int64_t>();
  for (Eigen::VectorXd* values : {&frame.q, &frame.v, &frame.efforts}) *values = getVector(joints);
  frame.V_WC_C = getVector(6);
  if (get<std::uint64_t>() != 0) frame.models = std::make_shared<ModelSet>(getSet(compose));
  const Scene& seen = frame.models ? frame.models->scene : scene;
  frame.present = getMoment(seen);
  for (auto left = get<std::uint64_t>(); left > 0; --left) {
    const auto count = get<std::uint32_t>();
    frame.samples.emplace_back(getMoment(seen), count);
  }
  return frame;
}

void StateWriter::putFrames(const FramesInFlight& flight) {
  put<std::uint64_t>(flight.taken() != nullptr);
  if (flight.taken()) putFrame(*flight.taken());
  put<std::uint64_t>(flight.inFlight().size());
  for (const ExposedFrame& frame : flight.inFlight()) putFrame(frame);
}

void StateWriter::putSensor(const Sensor::State& state) {
  put(state.brightness);
  put(state.balance);
  put<std::uint64_t>(state.brightnesses.size());
  for (const double each : state.brightnesses) put(each);
  put<std::uint64_t>(state.balances.size());
  for (const std::array<double, 2>& each : state.balances) put(each);
}

Sensor::State StateReader::getSensor() {
  Sensor::State state;
  state.brightness = get<double>();
  state.balance = get<std::array<double, 2>>();
  for (auto left = get<std::uint64_t>(); left > 0; --left) state.brightnesses.push_back(get<double>());
  for (auto left = get<std::uint64_t>(); left > 0; --left) state.balances.push_back(get<std::array<double, 2>>());
  return state;
}

void StateReader::getFrames(int joints, const Scene& scene, const Compose& compose, Camera::State& camera) {
  if (get<std::uint64_t>() != 0) camera.taken = getFrame(joints, scene, compose);
  for (auto left = get<std::uint64_t>(); left > 0; --left) {
    camera.in_flight.push_back(getFrame(joints, scene, compose));
  }
}

}  // namespace aras_visual_servo_sim
