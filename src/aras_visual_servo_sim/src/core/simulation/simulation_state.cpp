// Saving and restoring a Simulation, one magic word first.
#include <deque>
#include <string>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "simulation/state/state_record.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint64_t kMagic = 0x33304d4953415241ULL;  // "ARASIM03"

/** Later than this no saved state is: thirty years. Stamps are added to times without a look at their limits. */
constexpr std::int64_t kLatestNs = 1000000000LL * 1000000000LL;

/** Of a camera, as it stands in the record. */
struct FrameCounters {
  std::int64_t next_frame, unhashed_frame, asked;
  std::uint64_t dropped;
};

void putCommands(const std::deque<Commands::Held>& held, StateWriter& out) {
  out.put<std::uint64_t>(held.size());
  for (const auto& [due_ns, command] : held) {
    out.put(due_ns);
    for (const auto* values : {&command.position, &command.velocity, &command.effort}) {
      out.put<std::uint64_t>(values->size());
      for (const auto& [joint, value] : *values) {
        out.putText(joint);
        out.put(value);
      }
    }
  }
}

std::deque<Commands::Held> getCommands(StateReader& in) {
  std::deque<Commands::Held> held;
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    Commands::Held one;
    one.due_ns = in.get<std::int64_t>();
    if (one.due_ns < 0 || one.due_ns > kLatestNs)
      throw StateError("saved state: found a command that is due at " + std::to_string(one.due_ns) +
                       " ns, allowed 0 to " + std::to_string(kLatestNs));
    for (auto* values : {&one.command.position, &one.command.velocity, &one.command.effort}) {
      for (auto joints = in.get<std::uint64_t>(); joints > 0; --joints) {
        const std::string joint = in.getText();
        (*values)[joint] = in.get<double>();
      }
    }
    held.push_back(std::move(one));
  }
  return held;
}

}  // namespace

std::string Simulation::saveState() const {
  StateWriter out;
  out.put(kMagic);
  out.putText(world_->saveState());
  out.put(run_hash_.state());
  out.put(commands_.refused());
  out.putText(commands_.lastRefusal());
  out.put<std::uint64_t>(cameras_.size());
  for (const Camera& camera : cameras_) {
    const FramePlan::State& plan = camera.plan();
    out.put(FrameCounters{plan.next, camera.unhashedFrame(), plan.asked, plan.dropped});
  }
  out.putModels(models_.set().saved());
  out.putLights(lights());
  out.putMotions(models_.motions());
  for (const Camera& camera : cameras_) {
    if (!camera.blurs()) continue;
    out.put<std::uint64_t>(camera.past().size());
    for (const Moment& moment : camera.past()) out.putMoment(moment);
  }
  for (const Camera& camera : cameras_) {
    if (camera.late()) out.putFrames(camera.flight());
  }
  for (const Camera& camera : cameras_) {
    if (camera.sensor() && camera.sensor()->setsItself()) out.putSensor(camera.sensor()->state());
  }
  if (commands_.delays()) putCommands(commands_.held(), out);
  return out.take();
}

/** Restores the world's state, with the contacts of this set of models, if the cameras can be in theirs at its time.
 *  @throws StateError; nothing changes then */
void Simulation::restoreWorld(const std::string& state, const ModelSet& models,
                              const std::vector<Camera::State>& cameras) {
  const ModelSet& now = models_.set();
  const bool changed = !models.spawned.empty() || !now.spawned.empty() || models.starts.size() != now.starts.size();
  const std::string before = world_->saveState();
  if (changed) contacts_.change(models, *world_);
  try {
    world_->restoreState(state);
    checkTime(cameras);
  } catch (const ArasError&) {
    if (changed) contacts_.change(now, *world_);
    world_->restoreState(before);
    throw;
  }
}

/** @throws StateError  the time of the world is none, or cameras cannot be in these states then */
void Simulation::checkTime(const std::vector<Camera::State>& cameras) const {
  if (ticks() < 0 || ticks() > kLatestNs / periodNs())
    throw StateError("saved state: found period " + std::to_string(ticks()) + ", allowed 0 to " +
                     std::to_string(kLatestNs / periodNs()));
  for (std::size_t k = 0; k < cameras.size(); ++k) cameras_[static_cast<int>(k)].check(cameras[k], ticks());
}

void Simulation::restoreState(const std::string& state) {
  StateReader in(state);
  if (in.get<std::uint64_t>() != kMagic)
    throw StateError("saved state: found one of another version, allowed one of this");
  const std::string world = in.getText();
  const auto hash = in.get<std::uint64_t>();
  const auto refused = in.get<std::uint64_t>();
  const std::string refusal = in.getText();
  if (const auto count = in.get<std::uint64_t>(); count != cameras_.size()) {
    throw StateError("saved state: found " + std::to_string(count) + " cameras, allowed " +
                     std::to_string(cameras_.size()) + " as in this simulation");
  }
  std::vector<Camera::State> cameras(cameras_.size());
  for (Camera::State& camera : cameras) {
    const auto counters = in.get<FrameCounters>();
    camera.plan = {counters.next_frame, counters.asked != 0, counters.dropped};
    camera.unhashed_frame = counters.unhashed_frame;
  }
  const auto compose = [this](const std::vector<SavedModel>& saved) { return models_.composed(saved); };
  ModelSet models = in.getSet(compose);
  models.checkCarriers(model_);
  std::map<std::string, MotionRun> motions = in.getMotions(models);
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    if (!cameras_[static_cast<int>(k)].blurs()) continue;
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) cameras[k].past.push_back(in.getMoment(models.scene));
  }
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    if (cameras_[static_cast<int>(k)].late())
      in.getFrames(static_cast<int>(world_->jointNames().size()), models.scene, compose, cameras[k]);
  }
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const Sensor* sensor = cameras_[static_cast<int>(k)].sensor();
    if (sensor && sensor->setsItself()) cameras[k].sensor = in.getSensor();
  }
  std::deque<Commands::Held> held;
  if (commands_.delays()) held = getCommands(in);
  if (!in.atEnd()) throw StateError("saved state: found bytes after its end, allowed a state of this simulation");

  restoreWorld(world, models, cameras);  // throws before anything else changed
  run_hash_.setState(hash);
  commands_.restore(refused, refusal);
  commands_.restoreHeld(std::move(held));
  for (std::size_t k = 0; k < cameras.size(); ++k) cameras_[static_cast<int>(k)].restore(std::move(cameras[k]));
  models_.become(std::move(models), std::move(motions));
  models_.carry(*world_);
}

}  // namespace aras_visual_servo_sim
