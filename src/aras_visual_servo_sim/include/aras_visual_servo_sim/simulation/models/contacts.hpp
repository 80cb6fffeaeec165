#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/physics/contact_config.hpp"
#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/simulation/models/models.hpp"

namespace aras_visual_servo_sim {

/** Knows which bodies touch each other: by the contacts of the configuration, and by the entries of the solids that are
 *  present. It tells the physics world, and moves the solids that are pushed there. */
class Contacts {
 public:
  /** @param robot  outlives this object */
  Contacts(const ContactConfig& config, const RobotModel& robot, const PackagePaths& packages);

  /** Takes the models as they were constructed. @throws ParameterError, ModelError as check and change do */
  void begin(const ModelSet& built, const std::vector<SolidEntry>& solids);
  /** The contact configuration for a world that is made now. */
  const ContactConfig& present() const { return present_; }
  bool any() const { return present_.any(); }
  /** Whether a model can be touched. */
  bool has(const std::string& model) const;

  /** @throws ParameterError for a solid that touches what is not there, or has mass and nothing to touch */
  void check(const std::string& solid, const ModelSet& set) const;
  /** Makes the models of this set those that touch. @throws as MultibodyWorld::setContacts; nothing changes then */
  void change(const ModelSet& set, MultibodyWorld& world);
  /** The same, for a world that is made afterwards. */
  void change(const ModelSet& set) { present_ = among(set); }
  /** Sets the ground plane; nothing: there is none. */
  void setGround(const std::optional<GroundPlane>& ground, MultibodyWorld& world);
  /** Tells the world where a model was put. */
  void place(const std::string& model, const Models& models, MultibodyWorld& world) const;
  /** Before a period: places models with a motion. */
  void beforePeriod(std::int64_t period_ns, Models& models, MultibodyWorld& world) const;
  /** After it: moves solids that were pushed. */
  void afterPeriod(Models& models, const MultibodyWorld& world) const;

 private:
  ContactConfig among(const ModelSet& set);
  void addMeshPoints(ContactConfig& contacts);
  bool isThere(const std::string& name, const ModelSet& set) const;

  ContactConfig config_, present_;
  const RobotModel& robot_;
  PackagePaths packages_;
  std::vector<std::string> solids_;                                  ///< of the configuration, in its order
  std::map<std::string, Pose> built_starts_;                         ///< the models as constructed
  std::map<std::string, std::vector<Eigen::Vector3d>> mesh_points_;  ///< of the files read so far
  std::set<std::string> hollow_meshes_;                              ///< of these, see ContactConfig
};

}  // namespace aras_visual_servo_sim
