#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"
#include "aras_visual_servo_sim/simulation/models/model_set.hpp"

namespace aras_visual_servo_sim {

/** A motion under way. */
struct MotionRun {
  ModelMotion motion;
  Pose X_WM0;             ///< where the model was when it began
  std::int64_t start_ns;  ///< when that was
};

/** The models of the scene, which are flat models and solids: where they are, and how they move by themselves.
 *  Times are simulated ones, in nanoseconds. */
class Models {
 public:
  /** No model at all. */
  Models() = default;
  /** The models of a configuration, each where it starts.
   *  @throws ParameterError listing every fault of the files they are made of */
  Models(const SceneConfig& config, const PackagePaths& packages);
  /** Adds the bodies and lights of a robot, also to the set as constructed. @throws ModelError; nothing changes then */
  void addRobot(const RobotModel& robot, const std::string& name, int number);
  /** As ModelSet::removeRobot, also of the set as constructed. */
  void removeRobot(int number, const std::vector<std::string>& links);

  const ModelSet& set() const { return set_; }
  const Scene& scene() const { return set_.scene; }
  /** The scene, for a caller that draws it as it was at another time and then puts everything back. */
  Scene& scene() { return set_.scene; }
  std::vector<std::string> names() const { return set_.names(); }
  /** X_WM. @throws UnknownNameError naming the models there are */
  const Pose& pose(const std::string& model) const { return set_.place(model); }
  const std::map<std::string, MotionRun>& motions() const { return motions_; }
  /** The link that carries a model, empty if none does. @throws as pose */
  const std::string& carrier(const std::string& model) const { return set_.carrier(model); }
  bool anyCarried() const;
  bool hasMotion(const std::string& model) const { return motions_.count(model) > 0; }
  /** V_WM_W of a model that has a motion. @throws std::out_of_range if it has none */
  Twist motionTwist(const std::string& model, std::int64_t now_ns) const {
    return at(motions_.at(model), now_ns).V_WM_W;
  }

  /** Puts every model where it started, and begins the configured motions anew. */
  void start(std::int64_t now_ns);
  /** Puts the models that move where they are now. */
  void move(std::int64_t now_ns);
  /** Puts the models that links carry where these are. */
  void carry(const LinkPoses& links);
  /** The same, and the bodies of the robots where their links are, and the lights where their carriers are. */
  void follow(const LinkPoses& links);
  /** Places a model in what carries it: a link, else the world. A motion that it has goes on.
   *  @throws UnknownNameError */
  void place(const std::string& model, const Pose& X_AM) { set_.anchored(model) = X_AM; }
  /** Moves a model from now and from where it is; nothing: it stays where it is.
   *  @throws UnknownNameError, ParameterError if a link carries it */
  void setMotion(const std::string& model, const std::optional<ModelMotion>& motion, std::int64_t now_ns);

  // --- adding and removing models: first a new set is made and checked, then it replaces the present one
  /** A set of the present models and one more.
   *  @param yaml  what the entry was read from, for saved states  @param X_AM  in place of the entry's own pose
   *  @throws ParameterError if a model or link has its name, NotFiniteError, ModelError */
  ModelSet with(const SceneEntry& entry, const std::string& yaml, const std::optional<Pose>& X_AM) const;
  /** A set of the present models without this one. @throws UnknownNameError */
  ModelSet without(const std::string& model) const;
  /** A set of the models of a saved state. @throws StateError if one is neither configured nor was spawned */
  ModelSet composed(const std::vector<SavedModel>& saved) const;
  /** Makes this set the present one. Motions of models that are not in it end. */
  void become(ModelSet next);
  /** The same, with these motions instead of those that are under way. */
  void become(ModelSet next, std::map<std::string, MotionRun> motions);
  /** Changes background and lights, of the present set and of that as constructed: the lights that `before` names
   * become those of `next`, all others stay. @throws as checkLights; nothing changes then */
  void setLighting(const SceneConfig& before, const SceneConfig& next, const std::vector<std::string>& links);
  /** The set as constructed. */
  const ModelSet& built() const { return built_ ? *built_ : set_; }
  /** Back to the set as constructed; start() puts each model where it began. */
  void reset();

 private:
  template <typename Changed>
  void changeBoth(const Changed& changed);
  static ModelPlacement at(const MotionRun& run, std::int64_t now_ns);
  void add(ModelSet& set, const SceneEntry& entry, const std::string& yaml) const;

  PackagePaths packages_;
  ModelSet set_;
  std::shared_ptr<const ModelSet> built_;     ///< as constructed; null as long as it is the one there is
  std::map<std::string, MotionRun> motions_;  ///< of the models that move
};

}  // namespace aras_visual_servo_sim
