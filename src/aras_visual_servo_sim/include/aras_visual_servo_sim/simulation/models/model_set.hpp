#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"

namespace aras_visual_servo_sim {

/** The link that a body of the scene shows. */
struct BodyLink {
  int robot = -1, link = -1;  ///< number of the robot in its world, -1: the body is a solid; index of the link

  bool isSolid() const { return robot < 0; }
};

/** X_WL of the links of all robots. */
struct LinkPoses {
  std::function<Pose(const BodyLink&)> shown;       ///< of one that is no solid
  std::function<Pose(const std::string&)> of_name;  ///< as the world names it, see scoped
};

/** A solid as something that can be touched. */
struct TouchableSolid {
  double mass_kg = 0.0;              ///< 0: it stays where it is put
  std::vector<Collision> shapes;     ///< in its frame
  std::vector<std::string> touches;  ///< `all`, `robot`, links and solids that it touches by its own entry
};

/** A model in a saved state. */
struct SavedModel {
  std::string name, entry;  ///< entry: its YAML if it was spawned, else empty
  Pose X_AM, X_AM0;         ///< where it is, where it started, see ModelSet::anchored
};

/** The models that are present. The scene holds the links of the robots among its bodies too. */
struct ModelSet {
  Scene scene;
  std::vector<BodyLink> body_links;    ///< of each body of the scene
  std::map<std::string, Pose> starts;  ///< of each model, see anchored
  std::map<std::string, TouchableSolid> solids;
  std::map<std::string, std::string> spawned;  ///< entry, as YAML, of each model that was spawned

  /** Flat models first, then solids, each in the order of the scene. */
  std::vector<std::string> names() const;
  /** @return X_WM of a model, to be read or set @throws UnknownNameError naming the models there are */
  Pose& place(const std::string& model);
  const Pose& place(const std::string& model) const;
  /** X_AM of a model in its anchor A, to be read or set: the link that carries it, else the world. @throws as place */
  Pose& anchored(const std::string& model);
  const Pose& anchored(const std::string& model) const;
  /** The link that carries a model, empty if none does. @throws as place */
  const std::string& carrier(const std::string& model) const;
  /** @param links  of all robots @throws ParameterError naming a model whose carrier is none of these, and the links */
  void checkCarriers(const std::vector<std::string>& links) const;
  /** X_WM of every model by name. */
  std::map<std::string, Pose> poses() const;
  /** Removes a model, and the lights that it carries. */
  void remove(const std::string& model);
  /** Removes the bodies of a robot, and the lights and models that its links carry.
   *  @param number  of the robot @param links  its links */
  void removeRobot(int number, const std::vector<std::string>& links);
  /** Everything that is needed to make this set again from the one that was constructed. */
  std::vector<SavedModel> saved() const;
};

/** @param links  of all robots
 *  @throws ParameterError naming a light that is attached to neither a link nor a model, or that is there twice, or
 *  their number if there are too many */
void checkLights(const ModelSet& set, const std::vector<std::string>& links);

/** The set with this light, in the place of that of the same name if there is one. @throws as checkLights */
ModelSet withLight(const ModelSet& set, const Light& light, const std::vector<std::string>& links);

/** The light of this name. @throws UnknownNameError naming the lights there are */
const Light& lightOf(const ModelSet& set, const std::string& name);

/** The set without the light of this name. @throws as lightOf */
ModelSet withoutLight(const ModelSet& set, const std::string& name);

}  // namespace aras_visual_servo_sim
