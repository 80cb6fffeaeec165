#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/image/image.hpp"
#include "aras_visual_servo_sim/physics/ray_caster.hpp"
#include "aras_visual_servo_sim/physics/touching_robots.hpp"
#include "aras_visual_servo_sim/render/coverage_renderer.hpp"
#include "aras_visual_servo_sim/simulation/cameras/cameras.hpp"
#include "aras_visual_servo_sim/simulation/cameras/drawing_threads.hpp"
#include "aras_visual_servo_sim/simulation/cameras/frame_drawer.hpp"
#include "aras_visual_servo_sim/simulation/models/model_set.hpp"
#include "aras_visual_servo_sim/simulation/models/models.hpp"
#include "aras_visual_servo_sim/simulation/robot.hpp"
#include "aras_visual_servo_sim/simulation/simulation_config.hpp"
#include "aras_visual_servo_sim/simulation/state/run_hash.hpp"
#include "aras_visual_servo_sim/simulation/time/clock.hpp"

namespace aras_visual_servo_sim {

/** What was true when an image was exposed. */
struct FrameState {
  std::int64_t stamp_ns = 0;           ///< simulated time of the exposure
  Eigen::VectorXd q, v;                ///< of the joints, sorted by name [m or rad, per s]
  Pose X_WC;                           ///< of the camera
  Twist V_WC_C = Twist::Zero();        ///< of the camera
  std::map<std::string, Pose> models;  ///< X_WM by name
};

/** What to draw of a frame that is taken, and what became of it. */
struct FrameWanted {
  int camera;                           ///< by index in World::cameras()
  bool image = true, geometry = false;  ///< of which Camera has the results then
  std::exception_ptr failed{};          ///< the RenderError of what could not be drawn, or null
};

/** An image and what was true when it was exposed. */
struct Frame {
  const Image* image;  ///< the camera's own: its content lasts until the next render of this camera
  FrameState state;
};

class StateArchive;

/** Robots, one scene and the cameras of the robots under one clock of integer nanoseconds.
 *
 *  One tick: controllers and physics take the state of all robots from t to t + period; robots whose contacts have
 *  `neighbours` touch each other. Frame k of a camera belongs to the first tick at or after k / rate, frame 0 to tick
 * 0. A frame is *taken* by takeFrame or stepToImage, or missed by stepping past it; either way the joint states enter
 * the run hash, and so does its image if it is rendered at that tick after it was taken. Frames of cameras with latency
 * are exposed by themselves and taken when they are delivered (Camera). Same construction, same calls: same bytes.
 * Frames: W world (of a fixed base, unless placed elsewhere, the root link), C camera optical (x right, y down), M
 * model. Links and cameras of a robot are named ROBOT::NAME. Solids of the scene move with the first robot whose base
 * is not driven; without one they stand still. Not thread-safe. */
class World {
 public:
  static constexpr std::int64_t kNever = kNeverTick;

  /** A world without robots. @param config  of which period, scene and ground plane count
   *  @throws ParameterError, ModelError listing what is wrong */
  explicit World(SimulationConfig config, const PackagePaths& packages = PackagePaths());
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // --- robots
  /** Adds a robot, which is there after a reset too. Its time is that of the world, and so are the scene and, for
   * robots that touch others and are not driven, the ground plane. Frames of cameras with latency that are on their way
   * are lost, as when a robot is removed.
   *  @param controllers  ros_control's layout, see parseControllers
   *  @return a handle, valid as long as the world
   *  @throws ParameterError, ModelError listing what is wrong; nothing changes then */
  std::shared_ptr<Robot> spawn(const std::string& name, RobotModel model, SimulationConfig config,
                               const YAML::Node& controllers = YAML::Node());
  /** Removes a robot, and the lights and models that its links carry. @throws UnknownNameError */
  void remove(const std::string& name);
  /** Gives a robot other masses, limits and gravity; its state, cameras and looks stay.
   *  @param model  with the same links and joints
   *  @throws ParameterError, ModelError, StateError if it cannot be in this state; nothing changes then */
  void renew(const std::string& name, RobotModel model, const Eigen::Vector3d& gravity_m_s2);
  const Robots& robots() const { return robots_; }
  /** @throws UnknownNameError naming the robots there are */
  Robot& robot(const std::string& name);
  /** The links of all robots, ROBOT::LINK. */
  std::vector<std::string> linkNames() const;
  /** Holds link b to link a where it is now, as if they were one body, until unweld, a reset or the end of a robot.
   *  @param a, b  links of two robots, as the world names them; at least one of them can move
   *  @throws UnknownNameError, ParameterError: of one robot, welded already, or a robot without neighbours */
  void weld(const std::string& a, const std::string& b);
  /** @throws UnknownNameError: these links, in either order, are not welded */
  void unweld(const std::string& a, const std::string& b);
  /** The links that are welded, in the order in which they were. */
  std::vector<std::pair<std::string, std::string>> welds() const;
  /** Sets the plane that robots with `neighbours` touch and rays meet; nothing: there is none. */
  void setGround(const std::optional<GroundPlane>& ground);

  /** What was ignored in the robots, and what cameras of the coverage renderer leave out of the scene, a line each.
   * Grows with what is spawned. */
  const std::vector<std::string>& warnings() const { return warnings_; }
  const SimulationConfig& config() const { return config_; }
  const Models& models() const { return models_; }
  const Scene& scene() const { return models_.scene(); }
  const Cameras& cameras() const { return cameras_; }

  // --- time
  std::int64_t ticks() const { return robots_.empty() ? ticks_ : robots_.front()->body().ticks(); }
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
   *  @return valid as long as the world; its content until the next render of this camera @throws RenderError */
  const Image& render(int camera);
  /** Takes frames that are due and draws them: as takeFrame, render and renderGeometry of one after another do, and
   * with the same run hash, but large images at the same time where there are processors.
   *  @throws ParameterError if one is not due; nothing is taken then */
  void takeFrames(std::vector<FrameWanted>& frames);
  /** What drew images by OpenGL so far, and its version; empty if nothing did. Run hashes hold for one of these. */
  std::string openGl() const { return drawer_.openGl(); }
  /** Depth and ids of what the image of this camera shows, noise and blur apart; content until the next call for this
   *  camera. segmentationIds of shownScene says what the ids mean. */
  const GeometryImage& renderGeometry(int camera, Distance distance = Distance::kDepth);
  /** The models that the image of a camera shows: those of a frame that was taken late, else those there are. */
  const Scene& shownScene(int camera) const;
  /** What was true when the image of a camera was exposed: of a frame that was taken late, else of the present. Joints
   *  are those of the camera's robot. */
  FrameState frameState(int camera) const;
  /** The image with it. */
  Frame frame(int camera) { return {&render(camera), frameState(camera)}; }
  Pose cameraPose(int camera) const { return cameras_[camera].pose(bodyOf(camera)); }     ///< X_WC at the present
  Twist cameraTwist(int camera) const { return cameras_[camera].twist(bodyOf(camera)); }  ///< V_WC_C, [v; w]

  /** Changes background and lights to those of this scene, whose models do not count; lights that something else has
   *  brought stay. @throws ParameterError; nothing changes then */
  void setLighting(const SceneConfig& scene);

  // --- rays
  /** What a ray met. */
  struct RayHit {
    double distance_m;  ///< infinite: nothing
    int link;           ///< index in linkNames(); -1: nothing, the ground plane or a solid
  };
  /** What straight rays meet first: the shapes of all robots, of the solids, and the ground plane.
   *  @param visuals  whether the rays meet the <visual>s of links, only from outside; else the <collision>s, from
   * inside too @throws as RayCaster::cast */
  std::vector<RayHit> castRays(const Eigen::Vector3d& p_W, const std::vector<Eigen::Vector3d>& directions_W,
                               double nearest_m, double farthest_m, bool visuals);

  // --- models: what is in the scene besides the robots, flat ones and solids
  /** Adds a model until the next reset.
   *  @param entry  one of `models` or `solids` of the scene section, see sceneEntryFromYaml and modelEntry
   *  @param X_WM   where, in place of its position_m and rpy_rad
   *  @throws ParameterError (also: a model or link has the name), ModelError, NotFiniteError; nothing changes then */
  void spawnModel(const YAML::Node& entry, const std::optional<Pose>& X_WM = std::nullopt);
  /** Removes a model; one of the configuration is back after a reset. @throws UnknownNameError */
  void deleteModel(const std::string& model);
  /** True if some model has a motion, is carried by a link, or is a free body. */
  bool modelsMove() const;
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
  void setLight(const Light& light) { change(withLight(models_.set(), light, linkNames())); }
  /** @throws UnknownNameError naming the lights there are */
  void deleteLight(const std::string& name) { change(withoutLight(models_.set(), name)); }

  // --- whole state
  /** Puts robots and models back to where they started, at rest, and begins their motions anew. Time, frames and
   *  counters go on. */
  void resetWorld();
  /** Back to tick 0: everything as constructed, gains, models and counters included; the robots stay. */
  void reset();
  /** The whole state as bytes: a world that gets it back goes on exactly as this one does, run hash included. */
  std::string saveState() const;
  /** @throws StateError unless the bytes are from a world of this construction and robots; nothing changes then */
  void restoreState(const std::string& state);
  /** Hash of the joint positions and velocities at every frame and of every image rendered for one, since the reset. */
  std::string runHash() const { return run_hash_.hex(); }

 protected:
  /** What a constructor of a derived class calls: it adds the one robot, which has no name, and builds the scene. */
  void build(const std::shared_ptr<Robot>& robot, const YAML::Node& controllers);
  struct Unbuilt {};
  World(const SimulationConfig& config, const PackagePaths& packages, Unbuilt);
  void setCameras(const std::vector<CameraConfig>& cameras, const Robot& robot);

 private:
  void addRobot(const std::shared_ptr<Robot>& robot, const SimulationConfig& config, const YAML::Node& controllers,
                FaultList& faults);
  void startModels();
  const MultibodyWorld& bodyOf(int camera) const { return robotOf(robots_, cameras_[camera].robot()).body(); }
  Robots::iterator find(const std::string& name);
  void simulateSolids(Robot& robot);
  std::int64_t leaveTick(std::int64_t end);
  void advance(std::int64_t periods);
  void requireDue(int camera) const;
  void draw(std::vector<FrameWanted>& frames);
  void hashRobots();
  void allowLatency();
  Moment present(const Camera& camera);
  void moveModels();
  void change(ModelSet next);
  void tellUndrawn();
  /** Two links as the world names them, and link b in link a. */
  struct Welded {
    std::string a, b;
    Pose X_AB;
  };
  using WeldedLinks = std::vector<Welded>;
  WeldedLinks::iterator findWeld(const std::string& a, const std::string& b);
  std::vector<Weld> weldsByIndex() const;
  /** @throws UnknownNameError, ParameterError unless these links can be welded */
  void checkWeld(const std::string& a, const std::string& b) const;
  struct Record;
  void visit(StateArchive& archive, Record& record, ModelSet& models) const;
  void restoreRobots(const Record& record, const ModelSet& models);
  void checkTime(const Record& record) const;

  /** What rays meet, until robots or solids come or go. */
  struct RayScene {
    RayCaster caster;
    std::vector<int> links;           // of each shape
    std::vector<std::string> solids;  // their bodies follow those of the links
  };
  RayScene rayScene(bool visuals) const;

  SimulationConfig config_;
  PackagePaths packages_;
  Clock clock_;
  Models models_;
  Robots robots_;
  const LinkPoses link_poses_ = {
      [this](const BodyLink& shown) { return robotOf(robots_, shown.robot).body().linkPose(shown.link); },
      [this](const std::string& name) {
        const auto [robot, link] = findLink(robots_, name);
        return robot->body().linkPose(link);
      }};
  std::shared_ptr<Robot> keeper_;  // whose contacts have the solids; null: there is none
  int next_number_ = 1;            // 0 is that of the robot without a name
  WeldedLinks welds_;
  std::int64_t ticks_ = 0;  // while there are no robots
  Cameras cameras_;
  FrameDrawer drawer_;
  DrawingThreads threads_;
  RunHash run_hash_;
  std::array<std::unique_ptr<RayScene>, 2> rays_;  // of collisions, of visuals; null: to be made anew
  std::vector<std::string> warnings_;
  Undrawn undrawn_;  // of which there was a warning
};

}  // namespace aras_visual_servo_sim
