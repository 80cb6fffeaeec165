// Saving and restoring a World, one magic word first.
#include <deque>
#include <string>
#include <utility>

#include "aras_visual_servo_sim/simulation/world.hpp"
#include "simulation/state/state_archive.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint64_t kMagic = 0x35304d4953415241ULL;  // "ARASIM05"

/** Later than this no saved state is: thirty years. Stamps are added to times without a look at their limits. */
constexpr std::int64_t kLatestNs = 1000000000LL * 1000000000LL;

void checkTick(std::int64_t tick, std::int64_t period_ns) {
  if (tick >= 0 && tick <= kLatestNs / period_ns) return;
  throw StateError("saved state: found period " + std::to_string(tick) + ", allowed 0 to " +
                   std::to_string(kLatestNs / period_ns));
}

}  // namespace

void visit(Archive& archive, Commands::Held& held) {
  archive(held.due_ns, held.command);
  if (held.due_ns >= 0 && held.due_ns <= kLatestNs) return;
  throw StateError("saved state: found a command that is due at " + std::to_string(held.due_ns) + " ns, allowed 0 to " +
                   std::to_string(kLatestNs));
}

/** What a saved state holds besides the models. */
struct World::Record {
  struct OfRobot {
    std::string body, last_refusal;
    std::uint64_t refused = 0;
    std::deque<Commands::Held> held;
  };
  std::int64_t tick = 0;
  std::uint64_t hash = 0;
  std::vector<OfRobot> robots;
  std::vector<Camera::State> cameras;
  std::map<std::string, MotionRun> motions;
  WeldedLinks welds;
};

/** Writes or reads a state of this world. */
void World::visit(StateArchive& archive, Record& record, ModelSet& models) const {
  std::uint64_t magic = kMagic, count = cameras_.size();
  archive(magic);
  if (magic != kMagic) throw StateError("saved state: found one of another version, allowed one of this");
  archive(record.tick);
  checkTick(record.tick, periodNs());
  for (Record::OfRobot& robot : record.robots) archive(robot.body);
  archive(record.hash);
  for (Record::OfRobot& robot : record.robots) archive(robot.refused, robot.last_refusal);
  archive(count);
  if (count != cameras_.size()) {
    throw StateError("saved state: found " + std::to_string(count) + " cameras, allowed " +
                     std::to_string(cameras_.size()) + " as in this simulation");
  }
  for (Camera::State& camera : record.cameras) archive(camera.plan, camera.unhashed_frame);
  const auto compose = [this](const std::vector<SavedModel>& saved) { return models_.composed(saved); };
  archive.models(models, compose);
  models.checkCarriers(linkNames());
  archive.motions(record.motions, models);
  for (std::size_t k = 0; k < record.cameras.size(); ++k) {
    const int index = static_cast<int>(k);
    const auto frame = [&](ExposedFrame& each) {
      archive.frame(each, static_cast<Eigen::Index>(bodyOf(index).jointNames().size()), models.scene, compose);
    };
    Camera::State& camera = record.cameras[k];
    const Sensor* sensor = cameras_[index].sensor();
    if (cameras_[index].blurs()) {
      archive.all(camera.past, [&](Moment& moment) { archive.moment(moment, models.scene); });
    }
    if (cameras_[index].late()) {
      archive.all(camera.taken, frame);
      archive.all(camera.in_flight, frame);
    }
    if (sensor && sensor->setsItself()) archive(camera.sensor);
  }
  archive.all(record.welds, [&](Welded& each) {
    archive(each.a, each.b, each.X_AB);
    if (!archive.reads()) return;
    try {
      checkWeld(each.a, each.b);
    } catch (const ArasError& error) {
      throw StateError(std::string("saved state: ") + error.what());
    }
  });
  for (std::size_t k = 0; k < robots_.size(); ++k) {
    if (robots_[k]->commands().delays()) archive(record.robots[k].held);
  }
}

std::string World::saveState() const {
  Record record{ticks(), run_hash_.state(), {}, {}, models_.motions(), welds_};
  for (const auto& robot : robots_) {
    const Commands& commands = robot->commands();
    record.robots.push_back({robot->body().saveState(), commands.lastRefusal(), commands.refused(), commands.held()});
  }
  for (const Camera& camera : cameras_) record.cameras.push_back(camera.state());
  StateArchive archive;
  visit(archive, record, const_cast<ModelSet&>(models_.set()));  // nothing changes where an archive writes
  return archive.take();
}

/** Restores the states of the robots, with the contacts of this set of models, if the cameras can be in theirs at their
 *  time. @throws StateError; nothing changes then */
void World::restoreRobots(const Record& record, const ModelSet& models) {
  const ModelSet& now = models_.set();
  const bool changed = !models.spawned.empty() || !now.spawned.empty() || models.starts.size() != now.starts.size();
  const auto changeContacts = [&](const ModelSet& set) {
    if (changed && keeper_) keeper_->contacts_.change(set, *keeper_->body_);
  };
  std::vector<std::string> before;
  for (const auto& robot : robots_) before.push_back(robot->body().saveState());
  changeContacts(models);
  try {
    for (std::size_t k = 0; k < robots_.size(); ++k) robots_[k]->body_->restoreState(record.robots[k].body);
    checkTime(record);
  } catch (const ArasError&) {
    changeContacts(now);
    for (std::size_t k = 0; k < robots_.size(); ++k) robots_[k]->body_->restoreState(before[k]);
    throw;
  }
}

/** @throws StateError  the time of the world is none, or cameras cannot be in these states then */
void World::checkTime(const Record& record) const {
  const std::int64_t now = robots_.empty() ? record.tick : ticks();
  checkTick(now, periodNs());
  for (const auto& robot : robots_) {
    if (robot->body().ticks() != now) throw StateError("saved state: found robots at different times");
  }
  for (std::size_t k = 0; k < record.cameras.size(); ++k) cameras_[static_cast<int>(k)].check(record.cameras[k], now);
}

void World::restoreState(const std::string& state) {
  StateArchive archive(state);
  Record record;
  record.robots.resize(robots_.size());
  record.cameras.resize(cameras_.size());
  ModelSet models;
  visit(archive, record, models);
  if (archive.left() > 0)
    throw StateError("saved state: found bytes after its end, allowed a state of this simulation");

  restoreRobots(record, models);  // throws before anything else changed
  ticks_ = record.tick;
  run_hash_.setState(record.hash);
  for (std::size_t k = 0; k < robots_.size(); ++k) {
    robots_[k]->commands_.restore(record.robots[k].refused, record.robots[k].last_refusal);
    robots_[k]->commands_.restoreHeld(std::move(record.robots[k].held));
  }
  for (std::size_t k = 0; k < cameras_.size(); ++k) cameras_[static_cast<int>(k)].restore(std::move(record.cameras[k]));
  welds_ = std::move(record.welds);
  models_.become(std::move(models), std::move(record.motions));
  models_.carry(link_poses_);
  rays_ = {};
}

}  // namespace aras_visual_servo_sim
