#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/render/undrawn.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/simulation/cameras/cameras.hpp"
#include "aras_visual_servo_sim/simulation/cameras/frame_drawer.hpp"
#include "aras_visual_servo_sim/simulation/commands.hpp"
#include "aras_visual_servo_sim/simulation/frame.hpp"
#include "aras_visual_servo_sim/simulation/models/contacts.hpp"
#include "aras_visual_servo_sim/simulation/models/lights.hpp"
#include "aras_visual_servo_sim/simulation/models/models.hpp"
#include "aras_visual_servo_sim/simulation/simulation_config.hpp"
#include "aras_visual_servo_sim/simulation/start.hpp"
#include "aras_visual_servo_sim/simulation/state/run_hash.hpp"
#include "aras_visual_servo_sim/simulation/time/clock.hpp"

namespace aras_visual_servo_sim {

/** Robot, scene and cameras under one clock of integer nanoseconds.
 *
 *  One tick: controllers and physics take the state from t to t + period. Frame k of a camera belongs to the first tick
 *  at or after k / rate, frame 0 to tick 0. A frame is *taken* by takeFrame or stepToImage, or missed by stepping past
 *  it; either way its joint state enters the run hash, and so does its image if it is rendered at that tick after it
 *  was taken. Frames of a camera with latency are exposed by themselves and taken when they are delivered (Camera).
 *  Same construction, same calls: same bytes. Frames: W world (of a fixed base, unless placed elsewhere, the root
 *  link), C camera optical (x right, y down), M model. Not thread-safe. */
class Simulation {
 public:
  static constexpr std::int64_t kNever = kNeverTick;

  /** @param controllers  ros_control's layout, see parseControllers
   *  @throws ParameterError, ModelError listing what is wrong */
  Simulation(RobotModel model, SimulationConfig config, const YAML::Node& controllers,
             const PackagePaths& packages = PackagePaths());
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  const RobotModel& model() const { return model_; }
  /** What was ignored in the robot, and what cameras of the coverage renderer leave out of the scene, a line each.
   * Grows with what is spawned. */
  const std::vector<std::string>& warnings() const { return model_.warnings; }
  const SimulationConfig& config() const { return config_; }
  const MultibodyWorld& world() const { return *world_; }
  const Models& models() const { return models_; }
  const Scene& scene() const { return models_.scene(); }
  const Cameras& cameras() const { return cameras_; }
  const Commands& commands() const { return commands_; }

  // --- time
  std::int64_t ticks() const { return world_->ticks(); }
  std::int64_t periodNs() const { return clock_.periodNs(); }
  std::int64_t timeNs() const { return clock_.ns(ticks()); }
  double timeS() const { return 1e-9 * static_cast<double>(timeNs()); }
  /** Advances n >= 0 periods. Frames not taken before are missed. @throws ParameterError if n < 0 */
  void step(std::int64_t n = 1);
  /** Advances to the next frame of a camera that was neither taken nor missed, and takes it.
   *  @return its stamp: when it was exposed [ns] @throws UnknownNameError */
  std::int64_t stepToImage(const std::string& camera);

  // --- cameras, by index in cameras()
  /** Asks a triggered camera for one frame: the next of its schedule after the present tick. */
  void trigger(int camera) { cameras_[camera].trigger(ticks()); }
  /** Exposes the frames of this tick of cameras with latency. step() does so too, before time goes on; call it before
   *  what is true now is changed, to have it in these frames. */
  void expose();
  /** Takes the frame that is due. @return its stamp: when it was exposed [ns] @throws ParameterError if none is due */
  std::int64_t takeFrame(int camera);
  /** What the camera sees now; at a frame's tick of a camera with an exposure, the mean over it, see Exposure. Joints
   *  and models that are placed, spawned or deleted have no past: the exposure begins there. Of a camera with latency,
   *  at the tick at which a frame was taken, that frame.
   *  @return valid as long as the simulation; its content until the next render of this camera @throws RenderError */
  const Image& render(int camera);
  /** What drew images by OpenGL so far, and its version; empty if nothing did. Run hashes hold for one of these. */
  std::string openGl() const { return drawer_.openGl(); }
  /** Depth and ids of what the image of this camera shows, noise and blur apart; content until the next call for this
   *  camera. segmentationIds of shownScene says what the ids mean. */
  const GeometryImage& renderGeometry(int camera, Distance distance = Distance::kDepth);
  /** The models that the image of a camera shows: those of a frame that was taken late, else those there are. */
  const Scene& shownScene(int camera) const;
  /** What was true when the image of a camera was exposed: of a frame that was taken late, else of the present. */
  FrameState frameState(int camera) const;
  /** The image with it. */
  Frame frame(int camera) { return {&render(camera), frameState(camera)}; }
  Pose cameraPose(int camera) const { return cameras_[camera].pose(*world_); }     ///< X_WC at the present
  Twist cameraTwist(int camera) const { return cameras_[camera].twist(*world_); }  ///< V_WC_C, [v; w]

  /** Gives the cameras other settings while time goes on, also for the time after a reset: all but those that
   * camera_info tells, and the rate. Frames on their way come as the new latency says; those that it lets come no more
   * are lost.
   *  @throws ParameterError naming what would have to be as at the start; nothing changes then */
  void setCameras(const std::vector<CameraConfig>& cameras);
  /** Changes background and lights to those of this scene, whose models do not count; lights that something else has
   *  brought stay. @throws ParameterError; nothing changes then */
  void setLighting(const SceneConfig& scene);

  // --- commands, see Commands
  void setCommand(const JointCommand& command, std::optional<std::int64_t> stamp_ns = std::nullopt) {
    commands_.apply(command, stamp_ns, timeNs(), *world_);
  }
  /** Moves a driven base, see MultibodyWorld::twistCommand; else as setCommand. */
  void setTwist(const Twist& V_WL_L, const std::string& link, std::optional<std::int64_t> stamp_ns = std::nullopt);
  void setControllerCommand(const std::string& controller, double value) {
    commands_.apply(controller, value, *world_);
  }
  void refuse(const std::string& reason) { commands_.refuse(reason, *world_); }
  void setGains(const std::string& controller, const PidGains& gains) { world_->setGains(controller, gains); }
  /** Places joints, at rest. @throws as MultibodyWorld::setJointPositions */
  void setJointPositions(const std::map<std::string, double>& positions);

  // --- controllers that are loaded, started and stopped while time goes on, see MultibodyWorld; a reset starts those
  // anew that run
  std::vector<std::string> loadController(const std::string& name, const YAML::Node& parameters) {
    return world_->loadController(name, parameters);
  }
  void unloadController(const std::string& name) { world_->unloadController(name); }
  void switchControllers(const std::vector<std::string>& start, const std::vector<std::string>& stop, bool strict) {
    world_->switchControllers(start, stop, strict);
  }
  /** As MultibodyWorld::push. */
  void push(const std::map<std::string, Twist>& links, const std::map<std::string, double>& joints) {
    world_->push(links, joints);
  }
  Controller& runningController(const std::string& name) { return world_->runningController(name); }
  void setGroupCommand(const std::string& controller, const std::vector<double>& values) {
    world_->setGroupCommand(controller, values);
  }
  /** Places a floating base, with a twist [v; w] in world axes; a driven one takes no twist.
   *  @throws as MultibodyWorld::setBasePose; nothing changes then */
  void setBase(const Pose& X_WB, const Twist& V_WB_W) {
    if (!V_WB_W.allFinite()) throw NotFiniteError("setBase: found a twist that is not finite, must be finite");
    world_->setBasePose(X_WB);
    if (!world_->drivenBase()) world_->setBaseTwist(V_WB_W);
    models_.carry(*world_);
    cameras_.forgetPast();
  }

  // --- models: what is in the scene besides the robot, flat ones and solids
  /** Adds a model until the next reset.
   *  @param entry  one of `models` or `solids` of the scene section, see sceneEntryFromYaml and modelEntry
   *  @param X_WM   where, in place of its position_m and rpy_rad
   *  @throws ParameterError (also: a model or link has the name), ModelError, NotFiniteError; nothing changes then */
  void spawnModel(const YAML::Node& entry, const std::optional<Pose>& X_WM = std::nullopt);
  /** Removes a model; one of the configuration is back after a reset. @throws UnknownNameError */
  void deleteModel(const std::string& model);
  /** True if some model has a motion, is carried by a link, or is a free body. */
  bool modelsMove() const {
    return !models_.motions().empty() || models_.anyCarried() || !config_.world.contacts.free_bodies.empty();
  }
  /** Places a model, which then stays there, or there on the link that carries it: a motion it had ends.
   *  @throws UnknownNameError naming the models there are, NotFiniteError */
  void setModelPose(const std::string& model, const Pose& X_WM);
  /** Moves a model from now and from where it is; nothing: it stays where it is.
   *  @throws UnknownNameError, ParameterError if a link carries it */
  void setModelMotion(const std::string& model, const std::optional<ModelMotion>& motion) {
    models_.setMotion(model, motion, timeNs());
  }
  /** V_WM_W at the present tick, as in ModelPlacement; zero for a model without motion, mass or carrier.
   *  @throws UnknownNameError */
  Twist modelTwist(const std::string& model) const;

  // --- lights, of the OpenGL renderer; saved states have them, a reset brings back those of the configuration
  const std::vector<Light>& lights() const { return scene().lighting.lights; }
  /** Adds a light, or changes the one of its name. What it is attached to carries it. @throws as checkLights */
  void setLight(const Light& light) { change(withLight(models_.set(), light, model_)); }
  /** @throws UnknownNameError naming the lights there are */
  void deleteLight(const std::string& name) { change(withoutLight(models_.set(), name)); }

  // --- whole state
  /** Puts joints and models back to where they started, at rest, and begins their motions anew. Time, frames and
   *  counters go on. */
  void resetWorld();
  /** Back to tick 0: everything as constructed, gains, models and counters included. */
  void reset();
  /** The whole state as bytes: a simulation that gets it back goes on exactly as this one does, run hash included. */
  std::string saveState() const;
  /** @throws StateError if the bytes are not from a simulation of this construction; nothing changes then. */
  void restoreState(const std::string& state);
  /** Hash of the joint positions and velocities at every frame and of every image rendered for one, since the reset. */
  std::string runHash() const { return run_hash_.hex(); }

 private:
  friend void stepTogether(const std::vector<Simulation*>& simulations, std::int64_t n);

  std::int64_t leaveTick(std::int64_t end);
  void makeWorld();
  Moment present(const Camera& camera);
  void startModels();
  void moveModels();
  Twist carriedTwist(const std::string& link, const Pose& X_WM) const;
  void change(ModelSet next);
  void tellUndrawn();
  void restoreWorld(const std::string& state, const ModelSet& models, const std::vector<Camera::State>& cameras);
  void checkTime(const std::vector<Camera::State>& cameras) const;

  RobotModel model_;
  SimulationConfig config_;
  Clock clock_;
  std::unique_ptr<MultibodyWorld> world_;
  Start start_;
  Models models_;
  Contacts contacts_;
  Cameras cameras_;
  FrameDrawer drawer_;
  Commands commands_;
  RunHash run_hash_;
  Undrawn undrawn_;  // of which there was a warning
};

/** Advances several simulations by n periods, each as its step() does, but so that their robots touch each other, see
 *  WorldGroup. @throws ParameterError unless their periods are the same, and n >= 0 */
void stepTogether(const std::vector<Simulation*>& simulations, std::int64_t n);

}  // namespace aras_visual_servo_sim
