// Saving and restoring a World, one magic word first.
#include <deque>
#include <string>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/simulation/world.hpp"
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

void checkTick(std::int64_t tick, std::int64_t period_ns) {
  if (tick >= 0 && tick <= kLatestNs / period_ns) return;
  throw StateError("saved state: found period " + std::to_string(tick) + ", allowed 0 to " +
                   std::to_string(kLatestNs / period_ns));
}

}  // namespace

std::string World::saveState() const {
  StateWriter out;
  out.put(kMagic);
  if (robots_.size() != 1) out.put(ticks());
  for (const auto& robot : robots_) out.putText(robot->body().saveState());
  out.put(run_hash_.state());
  for (const auto& robot : robots_) {
    out.put(robot->commands().refused());
    out.putText(robot->commands().lastRefusal());
  }
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
  for (const auto& robot : robots_) {
    if (robot->commands().delays()) putCommands(robot->commands().held(), out);
  }
  return out.take();
}

/** Restores the states of the robots, with the contacts of this set of models, if the cameras can be in theirs at their
 *  time. @throws StateError; nothing changes then */
void World::restoreRobots(const std::vector<std::string>& states, const ModelSet& models,
                          const std::vector<Camera::State>& cameras) {
  const ModelSet& now = models_.set();
  const bool changed = !models.spawned.empty() || !now.spawned.empty() || models.starts.size() != now.starts.size();
  const auto changeContacts = [&](const ModelSet& set) {
    if (changed && keeper_) keeper_->contacts_.change(set, *keeper_->body_);
  };
  const auto restore = [&](const std::vector<std::string>& all) {
    for (std::size_t k = 0; k < robots_.size(); ++k) robots_[k]->body_->restoreState(all[k]);
  };
  std::vector<std::string> before;
  for (const auto& robot : robots_) before.push_back(robot->body().saveState());
  changeContacts(models);
  try {
    restore(states);
    checkTime(cameras);
  } catch (const ArasError&) {
    changeContacts(now);
    restore(before);
    throw;
  }
}

/** @throws StateError  the time of the world is none, or cameras cannot be in these states then */
void World::checkTime(const std::vector<Camera::State>& cameras) const {
  checkTick(ticks(), periodNs());
  for (const auto& robot : robots_) {
    if (robot->body().ticks() != ticks()) throw StateError("saved state: found robots at different times");
  }
  for (std::size_t k = 0; k < cameras.size(); ++k) cameras_[static_cast<int>(k)].check(cameras[k], ticks());
}

void World::restoreState(const std::string& state) {
  StateReader in(state);
  if (in.get<std::uint64_t>() != kMagic)
    throw StateError("saved state: found one of another version, allowed one of this");
  const std::int64_t tick = robots_.size() == 1 ? 0 : in.get<std::int64_t>();
  checkTick(tick, periodNs());
  std::vector<std::string> robots(robots_.size());
  for (std::string& robot : robots) robot = in.getText();
  const auto hash = in.get<std::uint64_t>();
  std::vector<std::pair<std::uint64_t, std::string>> refusals(robots_.size());
  for (auto& [refused, last] : refusals) {
    refused = in.get<std::uint64_t>();
    last = in.getText();
  }
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
  models.checkCarriers(linkNames());
  std::map<std::string, MotionRun> motions = in.getMotions(models);
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    if (!cameras_[static_cast<int>(k)].blurs()) continue;
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) cameras[k].past.push_back(in.getMoment(models.scene));
  }
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const int camera = static_cast<int>(k);
    if (!cameras_[camera].late()) continue;
    in.getFrames(static_cast<int>(bodyOf(camera).jointNames().size()), models.scene, compose, cameras[k]);
  }
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const Sensor* sensor = cameras_[static_cast<int>(k)].sensor();
    if (sensor && sensor->setsItself()) cameras[k].sensor = in.getSensor();
  }
  std::vector<std::deque<Commands::Held>> held(robots_.size());
  for (std::size_t k = 0; k < robots_.size(); ++k) {
    if (robots_[k]->commands().delays()) held[k] = getCommands(in);
  }
  if (!in.atEnd()) throw StateError("saved state: found bytes after its end, allowed a state of this simulation");

  restoreRobots(robots, models, cameras);  // throws before anything else changed
  ticks_ = tick;
  run_hash_.setState(hash);
  for (std::size_t k = 0; k < robots_.size(); ++k) {
    robots_[k]->commands_.restore(refusals[k].first, refusals[k].second);
    robots_[k]->commands_.restoreHeld(std::move(held[k]));
  }
  for (std::size_t k = 0; k < cameras.size(); ++k) cameras_[static_cast<int>(k)].restore(std::move(cameras[k]));
  models_.become(std::move(models), std::move(motions));
  models_.carry(link_poses_);
  rays_ = {};
}

}  // namespace aras_visual_servo_sim
