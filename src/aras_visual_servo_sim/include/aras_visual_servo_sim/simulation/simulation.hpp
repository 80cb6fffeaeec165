#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/render/geometry_image.hpp"
#include "aras_visual_servo_sim/render/renderer.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"
#include "aras_visual_servo_sim/simulation/exposure.hpp"
#include "aras_visual_servo_sim/simulation/frame_schedule.hpp"
#include "aras_visual_servo_sim/simulation/frames_in_flight.hpp"
#include "aras_visual_servo_sim/simulation/model_set.hpp"
#include "aras_visual_servo_sim/simulation/run_hash.hpp"
#include "aras_visual_servo_sim/simulation/simulation_config.hpp"

namespace aras_visual_servo_sim {

class StateReader;
class StateWriter;

/** Robot, scene and cameras under one clock of integer nanoseconds.
 *
 *  One tick: controllers and physics take the state from t to t + period. Frame k of a camera belongs to the first tick
 *  at or after k / rate, frame 0 to tick 0. A frame is *taken* by takeFrame or stepToImage, or missed by stepping past
 *  it; either way its joint state enters the run hash, and so does its image if it is rendered at that tick after it
 *  was taken. A camera with latency exposes frame k at that tick by itself, and the frame can be taken when it is
 * delivered, latency_s later: it shows what was when it was exposed. Same construction, same calls: same bytes. Frames:
 * W world (of a fixed base, unless placed elsewhere, the root link), C camera optical (x right, y down, z forward), M
 * model. Not thread-safe.
 */
class Simulation {
 public:
  /** @param controllers  ros_control's layout, see parseControllers
   *  @throws ParameterError, ModelError listing what is wrong */
  Simulation(RobotModel model, SimulationConfig config, const YAML::Node& controllers,
             const PackagePaths& packages = PackagePaths());
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  const RobotModel& model() const { return model_; }
  const SimulationConfig& config() const { return config_; }
  const MultibodyWorld& world() const { return *world_; }
  const Scene& scene() const { return models_.scene; }

  // --- time
  std::int64_t ticks() const { return world_->ticks(); }
  std::int64_t periodNs() const { return period_ns_; }
  std::int64_t timeNs() const { return ticks() * period_ns_; }
  double timeS() const { return 1e-9 * static_cast<double>(timeNs()); }
  /** Advances n >= 0 periods. Frames not taken before are missed. @throws ParameterError if n < 0 */
  void step(std::int64_t n = 1);
  /** Advances to the next frame of a camera that was neither taken nor missed, and takes it.
   *  @return its stamp: when it was exposed [ns] @throws UnknownNameError */
  std::int64_t stepToImage(const std::string& camera);

  // --- cameras, by index in cameraNames()
  const std::vector<std::string>& cameraNames() const { return camera_names_; }
  /** @throws UnknownNameError naming the cameras there are */
  int cameraIndex(const std::string& camera) const;
  const CameraModel& camera(int index) const { return cameras_[index].model; }
  /** True if a frame can be taken at the present tick and was not taken yet. */
  bool frameDue(int camera) const;
  /** True if a frame was taken at the present tick. */
  bool frameTaken(int camera) const;
  /** True if a frame that is neither dropped nor missed is exposed at the present tick: without latency the one that
   * is due. */
  bool frameExposed(int camera) const;
  static constexpr std::int64_t kNever = FramesInFlight::kNever;
  /** Tick at which the next frame that was neither taken, missed nor dropped can be taken; kNever for a triggered
   *  camera nobody asked. */
  std::int64_t nextFrameTick(int camera) const;
  /** Tick at which the next frame is exposed that was not yet: without latency, nextFrameTick. */
  std::int64_t nextExposureTick(int camera) const;
  /** Exposes what is due of cameras with latency. step does it on its way: for those who show the present to others
   *  before they let it be changed. */
  void expose();
  /** The frame taken last and those in flight of a camera with latency, oldest first; none of one without. */
  std::vector<const ExposedFrame*> lateFrames(int camera) const;
  /** The frame taken at the present tick of a camera with latency; null if there is none, or no latency. */
  const ExposedFrame* takenFrame(int camera) const { return cameras_[camera].flight.taken(); }
  /** Asks a triggered camera for one frame: the next of its schedule after the present tick. Asking again before it was
   *  taken changes nothing, nor does asking a camera that is not triggered. */
  void trigger(int camera);
  /** Frames passed over so far because of drop_probability, of all cameras. */
  std::uint64_t droppedFrames() const;
  /** Takes the frame that is due. @return its stamp: when it was exposed [ns] @throws ParameterError if none is due */
  std::int64_t takeFrame(int camera);
  /** What the camera sees now; at a frame's tick of a camera with an exposure, the mean over it, see Exposure. Joints
   *  and models that are placed, spawned or deleted have no past: the exposure begins there. Of a camera with latency,
   *  at the tick at which a frame was taken, that frame. Poses and twists are always those of the present, see
   *  takenFrame. The reference stays valid; its content until the next render of this camera. @throws RenderError */
  const Image& render(int camera);
  /** Depth and ids of what the image of this camera shows, noise and blur apart; content until the next call for this
   *  camera. segmentationIds of the scene it shows, see shownScene, says what the ids mean. */
  const GeometryImage& renderGeometry(int camera, Distance distance = Distance::kDepth);
  /** The models that the image of a camera shows: those of a frame that was taken late, else those there are. */
  const Scene& shownScene(int camera) const;
  /** Where the models were when that image was exposed: X_WM by name. */
  std::map<std::string, Pose> shownModels(int camera) const;
  Pose cameraPose(int camera) const;    ///< X_WC
  Twist cameraTwist(int camera) const;  ///< V_WC_C, [v; w]

  // --- commands
  /** Applies a command whole, or refuses it whole: then it is counted, every commanded velocity becomes 0 (the arm
   *  holds) and the reason is thrown.
   *  @param stamp_ns  time of the state it answers: neither in the future nor, unless the command is empty, older than
   *                   command_timeout_s and the longest latency of a camera; nothing = now
   *  @throws NotFiniteError, UnknownNameError, ParameterError */
  void setCommand(const JointCommand& command, std::optional<std::int64_t> stamp_ns = std::nullopt);
  /** As a Float64 on a controller's command topic; refused in the same way. */
  void setControllerCommand(const std::string& controller, double value);
  /** Counts a command that could not even be read, and makes the arm hold. */
  void refuse(const std::string& reason);
  std::uint64_t refusedCommands() const { return refused_commands_; }
  const std::string& lastRefusal() const { return last_refusal_; }
  void setGains(const std::string& controller, const PidGains& gains) { world_->setGains(controller, gains); }

  /** Places joints, at rest. @throws as MultibodyWorld::setJointPositions */
  void setJointPositions(const std::map<std::string, double>& positions) {
    world_->setJointPositions(positions);
    forgetPast();
  }

  // --- models: what is in the scene besides the robot, flat ones and solids
  std::vector<std::string> modelNames() const;
  /** Adds a model until the next reset.
   *  @param entry  one of `models` or `solids` of the scene section, see loadScene and modelEntry
   *  @param X_WM   where, in place of its position_m and rpy_rad
   *  @throws ParameterError (also: a model or link has the name), ModelError, NotFiniteError; nothing changes then */
  void spawnModel(const YAML::Node& entry, const std::optional<Pose>& X_WM = std::nullopt);
  /** Removes a model; one of the configuration is back after a reset. @throws UnknownNameError */
  void deleteModel(const std::string& model);
  /** True if some model has a motion, or is a free body. */
  bool modelsMove() const { return !motions_.empty() || !config_.world.contacts.free_bodies.empty(); }
  /** Places a model, which then stays there: a motion it had ends.
   *  @throws UnknownNameError naming the models there are, NotFiniteError */
  void setModelPose(const std::string& model, const Pose& X_WM);
  /** Moves a model from now and from where it is; nothing: it stays where it is. @throws UnknownNameError */
  void setModelMotion(const std::string& model, const std::optional<ModelMotion>& motion);
  /** X_WM at the present tick. @throws UnknownNameError */
  Pose modelPose(const std::string& model) const;
  /** V_WM_W at the present tick, as in ModelPlacement; zero for a model without motion or mass. @throws
   * UnknownNameError */
  Twist modelTwist(const std::string& model) const;

  // --- whole state
  /** Joints and models back to where they started, at rest, their motions from the beginning; time, frames and counters
   *  go on. */
  void resetWorld();
  /** Back to tick 0: everything as constructed, gains, models and counters included. */
  void reset();
  /** Everything that decides the future and the run hash, as bytes. */
  std::string saveState() const;
  /** @throws StateError if the bytes are not from a simulation of this construction; nothing changes then. */
  void restoreState(const std::string& state);
  /** Of the joint positions and velocities at every frame, and every image rendered for one, since the reset. */
  std::string runHash() const { return run_hash_.hex(); }

 private:
  struct Camera {
    CameraModel model;
    FrameSchedule schedule;
    Exposure exposure;
    FramesInFlight flight;
    int link;
    std::int64_t next_frame = 0;       ///< smallest index neither taken nor missed; with latency, not exposed
    std::int64_t unhashed_frame = -1;  ///< taken, image not hashed yet
    bool asked = false;                ///< of a triggered camera: one frame is wanted
    std::uint64_t drop_seed = 0;
    std::uint64_t dropped = 0;  ///< frames below next_frame that were dropped
    Image image{};
    GeometryImage geometry{};
  };
  struct MotionRun {
    ModelMotion motion;
    Pose X_WM0;
    std::int64_t start_ns;
  };

  void addCamera(const CameraConfig& config, std::vector<std::string>& faults);
  void makeWorld();
  static bool isDropped(const Camera& camera, std::int64_t frame);
  static std::int64_t nextFrame(const Camera& camera);
  ContactConfig touchable(const ModelSet& set) const;
  void checkTouched(const YAML::Node& solid, const ModelSet& set) const;
  bool isThere(const std::string& name, const ModelSet& set) const;
  void touch(const ModelSet& set);
  void restoreWorld(const std::string& state, const ModelSet& models, bool changed);
  bool touches(const std::string& model) const;
  void stepTouching(std::int64_t n);
  void showSolids();
  void touchModel(const std::string& model);
  void passFrame(Camera& camera);
  void placeBodies();
  Moment presentMoment(int camera) const;
  static void showMoment(const Moment& moment, Scene& scene);
  std::int64_t noteExposure(int camera);
  void forgetPast();
  void drawPresent(int camera);
  void drawFrame(Camera& camera, const ExposedFrame& frame);
  void passFramesInFlight();
  void keepSeenModels();
  static std::vector<SavedModel> savedModels(const ModelSet& set);
  static void saveFrame(StateWriter& out, const ExposedFrame& frame);
  ExposedFrame readFrame(StateReader& in, const Scene& scene) const;
  static void saveFrames(StateWriter& out, const FramesInFlight& flight);
  struct RestoredFrames {
    std::optional<ExposedFrame> taken;
    std::deque<ExposedFrame> in_flight;
  };
  RestoredFrames readFrames(StateReader& in, const Scene& scene) const;
  void holdStill();
  Pose& placeOf(const std::string& model);
  void keepBuilt();
  static void addModel(ModelSet& set, Scene added);
  static void removeModel(ModelSet& set, const std::string& model);
  ModelSet composed(const std::vector<SavedModel>& saved) const;
  void startModels();
  void moveModels();
  template <typename Action>
  void acceptOrRefuse(const Action& action);

  RobotModel model_;
  SimulationConfig config_;
  std::int64_t period_ns_;
  std::unique_ptr<MultibodyWorld> world_;
  Eigen::VectorXd initial_q_;
  Pose initial_base_;
  ContactConfig touching_;  ///< what touches now, spawned solids included
  PackagePaths packages_;
  ModelSet models_;
  std::unique_ptr<const ModelSet> built_;     ///< as constructed, kept when models come or go
  std::map<std::string, MotionRun> motions_;  ///< of the models that move, by name
  std::vector<std::string> camera_names_;
  std::vector<Camera> cameras_;
  bool any_late_ = false;  ///< some camera has latency
  std::int64_t longest_latency_ns_ = 0;
  std::unique_ptr<Renderer> renderer_;
  GeometryRenderer geometry_renderer_;
  RunHash run_hash_;
  std::uint64_t refused_commands_ = 0;
  std::string last_refusal_;
};

}  // namespace aras_visual_servo_sim
