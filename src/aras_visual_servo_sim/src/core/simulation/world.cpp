#include "aras_visual_servo_sim/simulation/world.hpp"

#include <algorithm>
#include <utility>

#include "aras_visual_servo_sim/camera/camera_tags.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/robot/joint_limits_reader.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Assigns Gazebo's default material (white) to visuals without one. */
void whiten(RobotModel& robot) {
  for (Link& link : robot.links) {
    for (Visual& visual : link.visuals) {
      if (!visual.has_color) visual.color = {1.0, 1.0, 1.0, 1.0};
    }
  }
}

}  // namespace

World::World(SimulationConfig config, const PackagePaths& packages)
    : config_(std::move(config)),
      packages_(packages),
      clock_(config_.world.period_s),
      models_(config_.scene, packages) {
  checkLights(models_.set(), {});
  models_.set().checkCarriers({});
  startModels();
}

World::World(const SimulationConfig& config, const PackagePaths& packages, Unbuilt)
    : config_(config), packages_(packages), clock_(config_.world.period_s) {}

void World::build(const std::shared_ptr<Robot>& robot, const YAML::Node& controllers) {
  FaultList faults;
  faults.collect([&] { models_ = Models(config_.scene, packages_); });
  addRobot(robot, config_, controllers, faults);
  startModels();
}

// --- robots ---------------------------------------------------------------------------------------------------------

std::shared_ptr<Robot> World::spawn(const std::string& name, RobotModel model, SimulationConfig config,
                                    const YAML::Node& controllers) {
  if (name.empty() || name.find("::") != std::string::npos) {
    throw ParameterError("robot '" + name + "': found this name, allowed is one without ::");
  }
  const auto same = [&](const auto& robot) { return robot->name() == name; };
  if (std::any_of(robots_.begin(), robots_.end(), same)) {
    throw ParameterError("robot '" + name + "': found twice, allowed once");
  }
  if (!config.scene.models.empty() || !config.scene.solids.empty()) {
    throw ParameterError("robot '" + name + "': scene: found models, allowed in the configuration of the world");
  }
  config.world.period_s = config_.world.period_s;
  if (config.world.contacts.neighbours && config.world.base != Base::kDriven) {
    config.world.contacts.ground = config_.world.contacts.ground;
  }
  FaultList faults;
  const auto robot = std::make_shared<Robot>(name, next_number_++, std::move(model), config, periodNs(), packages_);
  addRobot(robot, config, controllers, faults);
  moveModels();
  return robot;
}

/** @param faults  that were found before @throws ParameterError listing all faults; nothing changes then */
void World::addRobot(const std::shared_ptr<Robot>& robot, const SimulationConfig& config, const YAML::Node& controllers,
                     FaultList& faults) {
  faults.collect([&] { applyJointLimits(controllers, robot->model_); });
  faults.collect([&] { robot->config_.controllers = parseControllers(controllers, robot->model_); });
  if (config.gazebo_cameras) whiten(robot->model_);
  faults.collect([&] { models_.addRobot(robot->model_, robot->name(), robot->number()); });
  std::vector<std::string> links = linkNames();
  for (const std::string& link : robot->scopedLinks()) links.push_back(link);
  if (faults.empty()) faults.collect([&] { checkLights(models_.set(), links); });
  if (faults.empty()) faults.collect([&] { models_.set().checkCarriers(links); });
  const bool keeps_solids = !keeper_ && (robot->name().empty() || config.world.base != Base::kDriven);
  if (faults.empty()) {
    faults.collect([&] { keeps_solids ? simulateSolids(*robot) : robot->contacts_.begin(ModelSet(), {}); });
  }
  faults.collect([&] { robot->checkStart(); });
  std::vector<CameraConfig> views = config.cameras;
  if (views.empty()) {
    faults.collect([&] { views = camerasFromTags(robot->model_, robot->model_.warnings, config.gazebo_cameras); });
    for (CameraConfig& camera : views) camera.renderer = config.tag_renderer;
  }
  Cameras cameras;
  for (const CameraConfig& camera : views) {
    faults.collect(
        [&] { cameras.add(camera, robot->model_, config.seed, periodNs(), robot->name(), robot->number()); });
  }
  if (faults.empty()) faults.collect([&] { robot->makeBody(); });
  if (!faults.empty()) models_.removeRobot(robot->number(), robot->scopedLinks());
  faults.throwIfAny();
  robot->body_->beginAt(ticks());
  robot->placed_ = [this] {
    models_.carry(link_poses_);
    cameras_.forgetPast();
  };
  robots_.push_back(robot);
  if (keeps_solids) keeper_ = robot;
  for (const std::string& solid : models_.names()) robot->contacts_.place(solid, models_, *robot->body_);
  cameras_.loseFrames();
  cameras_.forgetPast();
  cameras_.add(std::move(cameras), ticks());
  allowLatency();
  rays_ = {};
  warnings_.insert(warnings_.end(), robot->model_.warnings.begin(), robot->model_.warnings.end());
  tellUndrawn();
}

/** Gives the solids of the scene to the contacts of a robot. */
void World::simulateSolids(Robot& robot) {
  robot.contacts_.begin(models_.built(), config_.scene.solids);
  robot.contacts_.change(models_.set());
}

Robots::iterator World::find(const std::string& name) {
  const auto found =
      std::find_if(robots_.begin(), robots_.end(), [&](const auto& each) { return each->name() == name; });
  if (found != robots_.end()) return found;
  std::string known;
  for (const auto& each : robots_) known += (known.empty() ? "" : ", ") + each->name();
  throw UnknownNameError("robot '" + name + "' does not exist; robots: " + (known.empty() ? "none" : known));
}

Robot& World::robot(const std::string& name) { return **find(name); }

void World::remove(const std::string& name) {
  const auto found = find(name);
  const std::shared_ptr<Robot> gone = *found;
  if (name.empty()) throw ParameterError("the robot of a simulation cannot be removed");
  ticks_ = ticks();
  robots_.erase(found);
  gone->placed_ = [] {};
  const std::string prefix = scoped(name, "");
  const auto of = [&](const std::string& link) { return link.compare(0, prefix.size(), prefix) == 0; };
  welds_.erase(
      std::remove_if(welds_.begin(), welds_.end(), [&](const Welded& each) { return of(each.a) || of(each.b); }),
      welds_.end());
  models_.removeRobot(gone->number(), gone->scopedLinks());
  cameras_.loseFrames();
  cameras_.forgetPast();
  cameras_.remove(gone->number());
  allowLatency();
  rays_ = {};
  if (keeper_ != gone) return;
  keeper_.reset();
  for (const auto& robot : robots_) {
    if (robot->body().drivenBase()) continue;
    simulateSolids(*robot);
    robot->body_->setContacts(robot->contacts_.present());
    robot->body_->takeObstacles(*gone->body_);
    keeper_ = robot;
    return;
  }
}

void World::renew(const std::string& name, RobotModel model, const Eigen::Vector3d& gravity_m_s2) {
  Robot& robot = this->robot(name);
  const auto same = [](const Link& one, const Link& other) { return one.name == other.name; };
  const std::vector<Link>& links = robot.model_.links;
  if (!std::equal(links.begin(), links.end(), model.links.begin(), model.links.end(), same)) {
    throw ParameterError("robot '" + name + "': found other links, allowed those that it has");
  }
  const Eigen::Vector3d gravity_before = std::exchange(robot.config_.gravity_m_s2, gravity_m_s2);
  std::swap(robot.model_, model);
  const Robot::Start start = robot.start_;
  std::unique_ptr<MultibodyWorld> before = std::move(robot.body_);
  try {
    robot.makeBody();
    robot.body_->restoreState(before->saveState());
  } catch (const ArasError&) {
    robot.body_ = std::move(before);
    robot.start_ = start;
    std::swap(robot.model_, model);
    robot.config_.gravity_m_s2 = gravity_before;
    throw;
  }
}

std::vector<std::string> World::linkNames() const {
  std::vector<std::string> names;
  for (const auto& robot : robots_) {
    for (const std::string& link : robot->scopedLinks()) names.push_back(link);
  }
  return names;
}

void World::checkWeld(const std::string& a, const std::string& b) const {
  const Robot* one = findLink(robots_, a).first;
  const Robot* other = findLink(robots_, b).first;
  const std::string what = "weld of " + a + " and " + b + ": found ";
  if (one == other) throw ParameterError(what + "links of one robot, allowed are links of two");
  for (const Robot* robot : {one, other}) {
    if (robot->body().takesWelds()) continue;
    throw ParameterError(what + "robot '" + robot->name() +
                         "' without contacts.neighbours, allowed are robots with it");
  }
}

World::WeldedLinks::iterator World::findWeld(const std::string& a, const std::string& b) {
  return std::find_if(welds_.begin(), welds_.end(),
                      [&](const Welded& each) { return (each.a == a && each.b == b) || (each.a == b && each.b == a); });
}

void World::weld(const std::string& a, const std::string& b) {
  checkWeld(a, b);
  if (findWeld(a, b) != welds_.end()) throw ParameterError("weld of " + a + " and " + b + ": they are welded already");
  welds_.push_back({a, b, link_poses_.of_name(a).inverse() * link_poses_.of_name(b)});
}

void World::unweld(const std::string& a, const std::string& b) {
  const auto found = findWeld(a, b);
  if (found == welds_.end()) throw UnknownNameError("weld of " + a + " and " + b + " does not exist");
  welds_.erase(found);
}

std::vector<std::pair<std::string, std::string>> World::welds() const {
  std::vector<std::pair<std::string, std::string>> links;
  for (const Welded& each : welds_) links.emplace_back(each.a, each.b);
  return links;
}

/** As the robots' bodies have them. */
std::vector<Weld> World::weldsByIndex() const {
  std::vector<Weld> welds;
  const auto indexOf = [this](const Robot* robot) {
    const auto same = [robot](const auto& each) { return each.get() == robot; };
    return static_cast<std::size_t>(std::find_if(robots_.begin(), robots_.end(), same) - robots_.begin());
  };
  for (const Welded& each : welds_) {
    const auto [robot_a, link_a] = findLink(robots_, each.a);
    const auto [robot_b, link_b] = findLink(robots_, each.b);
    welds.push_back({indexOf(robot_a), indexOf(robot_b), link_a, link_b, each.X_AB});
  }
  return welds;
}

void World::setGround(const std::optional<GroundPlane>& ground) {
  config_.world.contacts.ground = ground;
  rays_ = {};
  for (const auto& robot : robots_) {
    if (!robot->config_.contacts.neighbours || robot->body().drivenBase()) continue;
    robot->contacts_.setGround(ground, *robot->body_);
  }
}

/** To be called when cameras have come, gone or changed. */
void World::allowLatency() {
  for (const auto& robot : robots_) robot->commands_.allowLatency(clock_.ns(cameras_.longestLatencyTicks()));
}

// --- time -----------------------------------------------------------------------------------------------------------

void World::step(std::int64_t n) {
  if (n < 0) throw ParameterError("step: found " + std::to_string(n) + " steps, allowed >= 0");
  const std::int64_t end = ticks() + n;
  while (ticks() < end) {
    const std::int64_t now = ticks();
    const std::int64_t next = leaveTick(end);
    advance(next - now);
    for (Camera& camera : cameras_) camera.passTo(ticks());
  }
  moveModels();
  if (n > 0) expose();
}

/** Takes all robots, and the solids, some periods further. */
void World::advance(std::int64_t periods) {
  const bool touched = keeper_ && keeper_->contacts_.any();
  if (robots_.empty()) ticks_ += periods;
  if (robots_.size() == 1 && !touched) robots_.front()->body_->step(static_cast<int>(periods));
  if (robots_.empty() || (robots_.size() == 1 && !touched)) return;
  std::vector<MultibodyWorld*> bodies;
  for (const auto& robot : robots_) bodies.push_back(robot->body_.get());
  std::vector<std::string> names;
  for (const auto& robot : robots_) names.push_back(robot->name());
  TouchingRobots group(bodies, names, weldsByIndex());
  for (std::int64_t k = 0; k < periods; ++k) {
    if (touched) keeper_->contacts_.beforePeriod(periodNs(), models_, *keeper_->body_);
    bodies.size() == 1 ? bodies.front()->step() : group.step();
    if (touched) keeper_->contacts_.afterPeriod(models_, *keeper_->body_);
  }
}

/** Adds the state of all robots to the run hash. */
void World::hashRobots() {
  for (const auto& robot : robots_) run_hash_.add(robot->body(), timeNs());
}

/** Does what is due at this tick. @return the next tick at which something is, at most `end` */
std::int64_t World::leaveTick(std::int64_t end) {
  expose();
  const std::int64_t now = ticks();
  std::int64_t next = end;
  for (const auto& robot : robots_) {
    Commands& commands = robot->commands_;
    commands.applyDue(timeNs(), *robot->body_);
    if (commands.nextDueNs() == Commands::kNeverNs) continue;
    next = std::min(next, (commands.nextDueNs() + periodNs() - 1) / periodNs());
  }
  for (Camera& camera : cameras_) {
    if (!camera.late() && camera.frameDue(now)) {
      hashRobots();
      camera.missFrame();
    }
    camera.leaveTick();
    next = std::min(next, camera.nextExposureTick());
    if (!camera.blurs()) continue;
    if (camera.samples(now)) camera.note(present(camera));
    next = std::min(next, camera.nextSampleTick(now));
  }
  return next;
}

std::int64_t World::stepToImage(const std::string& camera) {
  const int index = cameras_.index(camera);
  const std::int64_t tick = cameras_[index].nextFrameTick();
  if (tick == kNever) {
    throw ParameterError("camera '" + camera + "': takes frames only when triggered, and was not");
  }
  step(tick - ticks());
  return takeFrame(index);
}

// --- cameras --------------------------------------------------------------------------------------------------------

void World::setCameras(const std::vector<CameraConfig>& cameras, const Robot& robot) {
  cameras_.become(cameras_.with(cameras, robot.model(), config_.seed, periodNs()), ticks());
  tellUndrawn();
  allowLatency();
}

void World::setLighting(const SceneConfig& scene) {
  models_.setLighting(config_.scene, scene, linkNames());
  config_.scene.background = scene.background;
  config_.scene.light_direction_W = scene.light_direction_W;
  config_.scene.lighting = scene.lighting;
  tellUndrawn();
}

// --- models ---------------------------------------------------------------------------------------------------------

/** Puts the models that move, or that links carry, where they are now. */
void World::moveModels() {
  models_.move(timeNs());
  models_.carry(link_poses_);
}

/** To be called after models were added or removed. */
void World::change(ModelSet next) {
  cameras_.keepModels(models_.set());
  rays_ = {};
  models_.become(std::move(next));
  models_.carry(link_poses_);
  cameras_.forgetPast();
  tellUndrawn();
}

/** Warns of what cameras of the coverage renderer leave out, of each thing once. */
void World::tellUndrawn() {
  std::string cameras;
  for (const Camera& camera : cameras_) {
    const CameraConfig& config = camera.model().config();
    if (config.renderer != "opengl") cameras += (cameras.empty() ? "'" : ", '") + config.name + "'";
  }
  if (cameras.empty()) return;
  Undrawn undrawn;
  for (const auto& [part, names] : undrawnByCoverage(scene())) {
    for (const std::string& name : names) {
      if (undrawn_[part].insert(name).second) undrawn[part].insert(name);
    }
  }
  if (undrawn.empty()) return;
  warnings_.push_back("camera " + cameras + ": renderer coverage does not draw " + textOf(undrawn));
}

void World::spawnModel(const YAML::Node& node, const std::optional<Pose>& X_WM) {
  const SceneEntry entry = sceneEntryFromYaml(node);
  YAML::Emitter text;
  text << YAML::Flow << node;
  const std::string& name = nameOf(entry);
  const auto* flat = std::get_if<ModelEntry>(&entry);
  std::optional<Pose> X_AM = X_WM;
  if (X_WM && flat && !flat->carrier.empty()) X_AM = link_poses_.of_name(flat->carrier).inverse() * *X_WM;
  ModelSet next = models_.with(entry, text.c_str(), X_AM);
  next.checkCarriers(linkNames());
  if (keeper_ && next.solids.count(name) > 0) {
    keeper_->contacts_.check(name, next);
    keeper_->contacts_.change(next, *keeper_->body_);
  }
  change(std::move(next));
  const auto motion = scene().motions.find(name);
  if (motion != scene().motions.end()) setModelMotion(name, motion->second);
}

void World::deleteModel(const std::string& model) {
  ModelSet next = models_.without(model);
  if (keeper_ && keeper_->contacts_.has(model)) keeper_->contacts_.change(next, *keeper_->body_);
  change(std::move(next));
}

void World::setModelPose(const std::string& model, const Pose& X_WM) {
  checkPlace("model '" + model + "'", X_WM);
  const Pose placed{X_WM.p, X_WM.q.normalized()};
  const std::string link = models_.carrier(model);
  models_.place(model, link.empty() ? placed : link_poses_.of_name(link).inverse() * placed);
  models_.carry(link_poses_);
  setModelMotion(model, std::nullopt);
  if (keeper_) keeper_->contacts_.place(model, models_, *keeper_->body_);
  cameras_.forgetPast();
}

Twist World::modelTwist(const std::string& model) const {
  models_.pose(model);  // throws
  if (models_.hasMotion(model)) return models_.motionTwist(model, timeNs());
  const std::string& carrier = models_.carrier(model);
  if (carrier.empty()) {
    return keeper_ && keeper_->contacts_.has(model) ? keeper_->body().obstacleTwist(model) : Twist(Twist::Zero());
  }
  const auto [robot, link] = findLink(robots_, carrier);
  const Pose X_WL = robot->body().linkPose(link);
  const Twist V_WL_L = robot->body().linkTwist(link);
  Twist twist;
  twist.tail<3>() = X_WL.q * V_WL_L.tail<3>();
  twist.head<3>() = X_WL.q * V_WL_L.head<3>() + twist.tail<3>().cross(models_.pose(model).p - X_WL.p);
  return twist;
}

bool World::modelsMove() const {
  return !models_.motions().empty() || models_.anyCarried() ||
         (keeper_ && !keeper_->config_.contacts.free_bodies.empty());
}

// --- starting again -------------------------------------------------------------------------------------------------

void World::startModels() {
  models_.start(timeNs());
  if (keeper_) {
    for (const std::string& model : models_.names()) keeper_->contacts_.place(model, models_, *keeper_->body_);
  }
  moveModels();
}

void World::resetWorld() {
  welds_.clear();
  for (const auto& robot : robots_) {
    robot->putBack();
    robot->commands_.drop();
  }
  startModels();
  cameras_.forgetPast();
}

void World::reset() {
  ticks_ = 0;
  models_.reset();
  if (keeper_) keeper_->contacts_.change(models_.set());
  for (const auto& robot : robots_) {
    const std::unique_ptr<MultibodyWorld> before = std::move(robot->body_);
    robot->makeBody();
    robot->body_->takeControllers(*before);
    robot->commands_.restore(0, "");
  }
  resetWorld();
  cameras_.reset();
  run_hash_.reset();
  rays_ = {};
}

}  // namespace aras_visual_servo_sim
