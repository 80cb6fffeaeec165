#include "aras_visual_servo_sim/simulation/simulation.hpp"

#include <algorithm>
#include <utility>

#include "aras_visual_servo_sim/camera/camera_tags.hpp"
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/place.hpp"
#include "aras_visual_servo_sim/physics/world_group.hpp"
#include "aras_visual_servo_sim/robot/joint_limits_reader.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Gives visuals to which the URDF gave no material Gazebo's, White. */
void whiten(RobotModel& robot) {
  for (Link& link : robot.links) {
    for (Visual& visual : link.visuals) {
      if (!visual.has_color) visual.color = {1.0, 1.0, 1.0, 1.0};
    }
  }
}

}  // namespace

Simulation::Simulation(RobotModel model, SimulationConfig config, const YAML::Node& controllers,
                       const PackagePaths& packages)
    : model_(std::move(model)),
      config_(std::move(config)),
      clock_(config_.world.period_s),
      start_(config_.initial_positions),
      contacts_(config_.world.contacts, model_, packages),
      commands_(config_.world.command_timeout_s, config_.command_delay_s, periodNs()) {
  FaultList faults;
  faults.collect([&] { applyJointLimits(controllers, model_); });
  faults.collect([&] { config_.world.controllers = parseControllers(controllers, model_); });
  if (config_.gazebo_cameras) whiten(model_);
  faults.collect([&] { models_ = Models(config_.scene, model_, packages); });
  if (faults.empty()) faults.collect([&] { checkLights(models_.set(), model_); });
  if (faults.empty()) faults.collect([&] { models_.set().checkCarriers(model_); });
  if (faults.empty()) faults.collect([&] { contacts_.begin(models_.set(), config_.scene.solids); });
  faults.collect([&] { start_.check(model_, config_.world); });
  if (config_.cameras.empty()) {
    faults.collect([&] { config_.cameras = camerasFromTags(model_, model_.warnings, config_.gazebo_cameras); });
    for (CameraConfig& camera : config_.cameras) camera.renderer = config_.tag_renderer;
  }
  for (const CameraConfig& camera : config_.cameras) {
    faults.collect([&] { cameras_.add(camera, model_, config_.seed, periodNs()); });
  }
  commands_.allowLatency(clock_.ns(cameras_.longestLatencyTicks()));
  if (faults.empty()) faults.collect([&] { makeWorld(); });
  faults.throwIfAny();
  startModels();
  tellUndrawn();
}

void Simulation::makeWorld() {
  WorldConfig config = config_.world;
  config.contacts = contacts_.present();
  world_ = start_.makeWorld(model_, config);
}

// --- time -----------------------------------------------------------------------------------------------------------

void Simulation::step(std::int64_t n) {
  if (n < 0) throw ParameterError("step: found " + std::to_string(n) + " steps, allowed >= 0");
  const std::int64_t end = ticks() + n;
  while (ticks() < end) {
    const std::int64_t now = ticks();
    const std::int64_t next = leaveTick(end);
    if (contacts_.any()) {
      contacts_.step(next - now, periodNs(), models_, *world_);
    } else {
      world_->step(static_cast<int>(next - now));
    }
    for (Camera& camera : cameras_) camera.passTo(ticks());
  }
  moveModels();
  if (n > 0) expose();
}

/** Does what is due at this tick. @return the next tick at which something is, at most `end` */
std::int64_t Simulation::leaveTick(std::int64_t end) {
  expose();
  commands_.applyDue(timeNs(), *world_);
  const std::int64_t now = ticks();
  std::int64_t next = end;
  if (commands_.nextDueNs() != Commands::kNeverNs)
    next = std::min(next, (commands_.nextDueNs() + periodNs() - 1) / periodNs());
  for (Camera& camera : cameras_) {
    if (!camera.late() && camera.frameDue(now)) {
      run_hash_.add(*world_, timeNs());
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

void stepTogether(const std::vector<Simulation*>& simulations, std::int64_t n) {
  if (n < 0) throw ParameterError("step: found " + std::to_string(n) + " steps, allowed >= 0");
  std::vector<MultibodyWorld*> worlds;
  for (Simulation* each : simulations) worlds.push_back(each->world_.get());
  if (worlds.empty() || n == 0) return;
  WorldGroup group(worlds);
  while (n > 0) {
    std::int64_t span = n;
    for (Simulation* each : simulations) span = std::min(span, each->leaveTick(each->ticks() + span) - each->ticks());
    for (std::int64_t k = 0; k < span; ++k) {
      for (Simulation* each : simulations) {
        if (each->contacts_.any()) each->contacts_.beforePeriod(each->periodNs(), each->models_, *each->world_);
      }
      group.step();
      for (Simulation* each : simulations) {
        if (each->contacts_.any()) each->contacts_.afterPeriod(each->models_, *each->world_);
      }
    }
    for (Simulation* each : simulations) {
      for (Camera& camera : each->cameras_) camera.passTo(each->ticks());
    }
    n -= span;
  }
  for (Simulation* each : simulations) {
    each->moveModels();
    each->expose();
  }
}

std::int64_t Simulation::stepToImage(const std::string& camera) {
  const int index = cameras_.index(camera);
  const std::int64_t tick = cameras_[index].nextFrameTick();
  if (tick == kNever) {
    throw ParameterError("camera '" + camera + "': takes frames only when triggered, and nobody asked for one");
  }
  step(tick - ticks());
  return takeFrame(index);
}

// --- cameras --------------------------------------------------------------------------------------------------------

/** Poses of everything that this camera can see now. */
Moment Simulation::present(const Camera& camera) {
  models_.move(timeNs());
  models_.follow(*world_);
  return momentOf(ticks(), camera.pose(*world_), scene());
}

void Simulation::expose() {
  if (!cameras_.anyLate()) return;
  for (Camera& camera : cameras_) {
    if (!camera.late() || camera.nextExposureTick() != ticks()) continue;
    run_hash_.add(*world_, timeNs());
    camera.expose(present(camera), *world_);
  }
}

std::int64_t Simulation::takeFrame(int index) {
  Camera& camera = cameras_[index];
  if (!camera.frameDue(ticks())) {
    throw ParameterError("camera '" + cameras_.names()[index] + "': no frame is due at tick " +
                         std::to_string(ticks()));
  }
  expose();  // before anything of this tick is taken
  if (camera.late()) return clock_.ns(camera.takeDelivered());
  run_hash_.add(*world_, timeNs());
  camera.takeFrame();
  return timeNs();
}

const Image& Simulation::render(int index) {
  Camera& camera = cameras_[index];
  models_.follow(*world_);
  const Image& image = drawer_.draw(camera, ticks(), cameraPose(index), models_.scene());
  if (camera.imageIsOfNewFrame()) run_hash_.add(image.data.data(), image.data.size());
  return image;
}

const GeometryImage& Simulation::renderGeometry(int index, Distance distance) {
  models_.follow(*world_);
  return drawer_.drawGeometry(cameras_[index], cameraPose(index), scene(), distance);
}

const Scene& Simulation::shownScene(int camera) const {
  const ExposedFrame* late = cameras_[camera].takenFrame();
  return late && late->models ? late->models->scene : scene();
}

FrameState Simulation::frameState(int index) const {
  const Camera& camera = cameras_[index];
  if (const ExposedFrame* late = camera.takenFrame()) {
    const ModelSet& set = late->models ? *late->models : models_.set();
    return {clock_.ns(late->tick()), late->q,      late->v,
            late->present.X_WC,      late->V_WC_C, modelPoses(late->present, set)};
  }
  return {timeNs(),          world_->jointPositions(), world_->jointVelocities(),
          cameraPose(index), cameraTwist(index),       models_.set().poses()};
}

void Simulation::setCameras(const std::vector<CameraConfig>& cameras) {
  cameras_.become(cameras_.with(cameras, model_, config_.seed, periodNs()), ticks());
  config_.cameras = cameras;
  tellUndrawn();
  commands_.allowLatency(clock_.ns(cameras_.longestLatencyTicks()));
}

void Simulation::setLighting(const SceneConfig& scene) {
  models_.setLighting(config_.scene, scene, model_);
  config_.scene.background = scene.background;
  config_.scene.light_direction_W = scene.light_direction_W;
  config_.scene.lighting = scene.lighting;
  tellUndrawn();
}

void Simulation::setTwist(const Twist& V_WL_L, const std::string& link, std::optional<std::int64_t> stamp_ns) {
  JointCommand command;
  try {
    command = world_->twistCommand(V_WL_L, link);
  } catch (const ArasError& error) {
    refuse(error.what());
    throw;
  }
  setCommand(command, stamp_ns);
}

void Simulation::setJointPositions(const std::map<std::string, double>& positions) {
  world_->setJointPositions(positions);
  models_.carry(*world_);
  commands_.drop();
  cameras_.forgetPast();
}

// --- models ---------------------------------------------------------------------------------------------------------

/** Puts the models that move, or that links carry, where they are now. */
void Simulation::moveModels() {
  models_.move(timeNs());
  models_.carry(*world_);
}

/** To be called after models were added or removed. */
void Simulation::change(ModelSet next) {
  cameras_.keepModels(models_.set());
  models_.become(std::move(next));
  models_.carry(*world_);
  cameras_.forgetPast();
  tellUndrawn();
}

/** Warns of what cameras of the coverage renderer leave out, of each thing once. */
void Simulation::tellUndrawn() {
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
  model_.warnings.push_back("camera " + cameras + ": renderer coverage does not draw " + textOf(undrawn));
}

void Simulation::spawnModel(const YAML::Node& node, const std::optional<Pose>& X_WM) {
  const SceneEntry entry = sceneEntryFromYaml(node);
  YAML::Emitter text;
  text << YAML::Flow << node;
  const std::string& name = nameOf(entry);
  const auto* flat = std::get_if<ModelEntry>(&entry);
  std::optional<Pose> X_AM = X_WM;
  if (X_WM && flat && !flat->carrier.empty()) X_AM = world_->linkPose(flat->carrier).inverse() * *X_WM;
  ModelSet next = models_.with(entry, text.c_str(), X_AM);
  next.checkCarriers(model_);
  if (next.solids.count(name) > 0) {
    contacts_.check(name, next);
    contacts_.change(next, *world_);
  }
  change(std::move(next));
  const auto motion = scene().motions.find(name);
  if (motion != scene().motions.end()) setModelMotion(name, motion->second);
}

void Simulation::deleteModel(const std::string& model) {
  ModelSet next = models_.without(model);
  if (contacts_.has(model)) contacts_.change(next, *world_);
  change(std::move(next));
}

void Simulation::setModelPose(const std::string& model, const Pose& X_WM) {
  checkPlace("model '" + model + "'", X_WM);
  const Pose placed{X_WM.p, X_WM.q.normalized()};
  const std::string link = models_.carrier(model);
  models_.place(model, link.empty() ? placed : world_->linkPose(link).inverse() * placed);
  models_.carry(*world_);
  setModelMotion(model, std::nullopt);
  contacts_.place(model, models_, *world_);
  cameras_.forgetPast();
}

Twist Simulation::modelTwist(const std::string& model) const {
  models_.pose(model);  // throws
  if (models_.hasMotion(model)) return models_.motionTwist(model, timeNs());
  if (const std::string& link = models_.carrier(model); !link.empty()) return carriedTwist(link, models_.pose(model));
  return contacts_.has(model) ? world_->obstacleTwist(model) : Twist(Twist::Zero());
}

/** V_WM_W of a model at X_WM that moves with a link. */
Twist Simulation::carriedTwist(const std::string& link, const Pose& X_WM) const {
  const Pose X_WL = world_->linkPose(link);
  const Twist V_WL_L = world_->linkTwist(link);
  Twist twist;
  twist.tail<3>() = X_WL.q * V_WL_L.tail<3>();
  twist.head<3>() = X_WL.q * V_WL_L.head<3>() + twist.tail<3>().cross(X_WM.p - X_WL.p);
  return twist;
}

// --- starting again -------------------------------------------------------------------------------------------------

void Simulation::startModels() {
  models_.start(timeNs());
  for (const std::string& model : models_.names()) contacts_.place(model, models_, *world_);
  moveModels();
}

void Simulation::resetWorld() {
  start_.putBack(*world_);
  commands_.drop();
  startModels();
  cameras_.forgetPast();
}

void Simulation::reset() {
  models_.reset();
  contacts_.change(models_.set());
  const std::unique_ptr<MultibodyWorld> before = std::move(world_);
  makeWorld();
  world_->takeControllers(*before);
  resetWorld();
  cameras_.reset();
  run_hash_.reset();
  commands_.restore(0, "");
}

}  // namespace aras_visual_servo_sim
