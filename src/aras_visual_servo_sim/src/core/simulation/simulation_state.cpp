// Saving and restoring a Simulation, one magic word first.
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "simulation/state/state_record.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint64_t kMagic = 0x32304d4953415241ULL;  // "ARASIM02"

struct FrameCounters {
  std::int64_t next_frame, unhashed_frame, asked;
  std::uint64_t dropped;
};

void saveModels(StateWriter& out, const std::vector<SavedModel>& models) {
  out.put<std::uint64_t>(models.size());
  for (const SavedModel& model : models) {
    out.putText(model.name);
    out.putText(model.entry);
    out.putPose(model.X_WM);
    out.putPose(model.X_WM0);
  }
}

std::vector<SavedModel> readModels(StateReader& in) {
  std::vector<SavedModel> models;
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    SavedModel model;
    model.name = in.getText();
    model.entry = in.getText();
    model.X_WM = in.getPose();
    model.X_WM0 = in.getPose();
    models.push_back(std::move(model));
  }
  return models;
}

}  // namespace

std::vector<SavedModel> Simulation::savedModels(const ModelSet& set) {
  std::vector<SavedModel> models;
  const auto add = [&](const std::string& name, const Pose& X_WM) {
    const auto entry = set.spawned.find(name);
    models.push_back({name, entry == set.spawned.end() ? "" : entry->second, X_WM, set.starts.at(name)});
  };
  for (const PlanarModel& model : set.scene.models) add(model.name(), model.X_WM);
  for (std::size_t k = 0; k < set.body_links.size(); ++k) {
    if (set.body_links[k] < 0) add(set.scene.bodies[k].name, set.scene.bodies[k].X_WB);
  }
  return models;
}

void Simulation::saveFrame(StateWriter& out, const ExposedFrame& frame) {
  out.put(frame.index);
  for (const Eigen::VectorXd* values : {&frame.q, &frame.v, &frame.efforts}) out.putVector(*values);
  out.putVector(frame.V_WC_C);
  out.put<std::uint64_t>(frame.models != nullptr);
  if (frame.models) saveModels(out, savedModels(*frame.models));
  out.putMoment(frame.present);
  out.put<std::uint64_t>(frame.samples.size());
  for (const auto& [moment, count] : frame.samples) {
    out.put(count);
    out.putMoment(moment);
  }
}

ExposedFrame Simulation::readFrame(StateReader& in, const Scene& scene) const {
  ExposedFrame frame;
  frame.index = in.get<std::int64_t>();
  for (Eigen::VectorXd* values : {&frame.q, &frame.v, &frame.efforts}) *values = in.getVector(model_.dofs());
  frame.V_WC_C = in.getVector(6);
  if (in.get<std::uint64_t>() != 0) frame.models = std::make_shared<ModelSet>(composed(readModels(in)));
  const Scene& seen = frame.models ? frame.models->scene : scene;
  frame.present = in.getMoment(seen);
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    const auto count = in.get<std::uint32_t>();
    frame.samples.emplace_back(in.getMoment(seen), count);
  }
  return frame;
}

void Simulation::saveFrames(StateWriter& out, const FramesInFlight& flight) {
  out.put<std::uint64_t>(flight.taken() != nullptr);
  if (flight.taken()) saveFrame(out, *flight.taken());
  out.put<std::uint64_t>(flight.inFlight().size());
  for (const ExposedFrame& frame : flight.inFlight()) saveFrame(out, frame);
}

Simulation::RestoredFrames Simulation::readFrames(StateReader& in, const Scene& scene) const {
  RestoredFrames frames;
  if (in.get<std::uint64_t>() != 0) frames.taken = readFrame(in, scene);
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) frames.in_flight.push_back(readFrame(in, scene));
  return frames;
}

std::string Simulation::saveState() const {
  StateWriter out;
  out.put(kMagic);
  out.putText(world_->saveState());
  out.put(run_hash_.state());
  out.put(refused_commands_);
  out.putText(last_refusal_);
  out.put<std::uint64_t>(cameras_.size());
  for (const Camera& camera : cameras_)
    out.put(FrameCounters{camera.next_frame, camera.unhashed_frame, camera.asked, camera.dropped});
  saveModels(out, savedModels(models_));
  out.put<std::uint64_t>(motions_.size());
  for (const auto& [name, run] : motions_) {
    out.putText(name);
    out.putText(run.motion.yaml());
    out.putPose(run.X_WM0);
    out.put(run.start_ns);
  }
  for (const Camera& camera : cameras_) {
    if (!camera.exposure.blurs()) continue;
    out.put<std::uint64_t>(camera.exposure.past().size());
    for (const Moment& moment : camera.exposure.past()) out.putMoment(moment);
  }
  for (const Camera& camera : cameras_) {
    if (camera.flight.late()) saveFrames(out, camera.flight);
  }
  return out.take();
}

/** The state of the world, what touches in it being that of a set of models. @throws StateError; nothing changes then
 */
void Simulation::restoreWorld(const std::string& state, const ModelSet& models, bool changed) {
  if (!changed) return world_->restoreState(state);
  const std::string before = world_->saveState();
  touch(models);
  try {
    world_->restoreState(state);
  } catch (const ArasError&) {
    touch(models_);
    world_->restoreState(before);
    throw;
  }
}

void Simulation::restoreState(const std::string& state) {
  StateReader in(state);
  if (in.get<std::uint64_t>() != kMagic) throw StateError("saved state: not written by this version");
  const std::string world = in.getText();
  const auto hash = in.get<std::uint64_t>();
  const auto refused = in.get<std::uint64_t>();
  const std::string refusal = in.getText();
  if (in.get<std::uint64_t>() != cameras_.size()) throw StateError("saved state: other number of cameras");
  std::vector<FrameCounters> frames;
  for (std::size_t k = 0; k < cameras_.size(); ++k) frames.push_back(in.get<FrameCounters>());
  const std::vector<SavedModel> saved = readModels(in);
  ModelSet models = composed(saved);
  const bool changed =
      !models.spawned.empty() || !models_.spawned.empty() || models.starts.size() != models_.starts.size();
  std::map<std::string, MotionRun> motions;
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    const std::string name = in.getText();
    const ModelMotion motion = ModelMotion::fromYaml(YAML::Load(in.getText()), "saved motion of '" + name + "'");
    const Pose X_WM0 = in.getPose();
    motions.emplace(name, MotionRun{motion, X_WM0, in.get<std::int64_t>()});
    if (models.starts.count(name) == 0) throw StateError("saved state: motion of '" + name + "', which is no model");
  }
  std::vector<std::vector<Moment>> pasts(cameras_.size());
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    if (!cameras_[k].exposure.blurs()) continue;
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) pasts[k].push_back(in.getMoment(models.scene));
  }
  std::vector<RestoredFrames> flights(cameras_.size());
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    if (cameras_[k].flight.late()) flights[k] = readFrames(in, models.scene);
  }
  if (!in.atEnd()) throw StateError("saved state: bytes left over");

  restoreWorld(world, models, changed);  // throws before anything else changed
  run_hash_.setState(hash);
  refused_commands_ = refused;
  last_refusal_ = refusal;
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    cameras_[k].next_frame = frames[k].next_frame;
    cameras_[k].unhashed_frame = frames[k].unhashed_frame;
    cameras_[k].asked = frames[k].asked != 0;
    cameras_[k].dropped = frames[k].dropped;
    cameras_[k].exposure.setPast(std::move(pasts[k]));
    cameras_[k].flight.restore(std::move(flights[k].taken), std::move(flights[k].in_flight));
  }
  if (changed) keepBuilt();
  models_ = std::move(models);
  for (const SavedModel& model : saved) placeOf(model.name) = model.X_WM;
  motions_ = std::move(motions);
}

}  // namespace aras_visual_servo_sim
