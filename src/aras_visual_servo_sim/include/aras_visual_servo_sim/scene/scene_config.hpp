#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/image/image.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/scene/lighting.hpp"
#include "aras_visual_servo_sim/scene/model_motion.hpp"
#include "aras_visual_servo_sim/scene/planar_model.hpp"

namespace aras_visual_servo_sim {

/** What a planar model looks like; its picture is not loaded yet. */
struct PlanarShape {
  struct PictureFile {
    std::string file;
    Eigen::Vector2d size_m{0.0, 0.0};
  };
  std::vector<Polygon> outlines;
  Rgb color;
  std::optional<PlanarModel::Board> board;
  std::optional<PictureFile> picture;
};

/** An entry of `models`: a flat model. */
struct ModelEntry {
  std::string name;
  std::string file;  ///< the target file that has its shape; empty: `shape`
  PlanarShape shape;
  Pose X_WM;            ///< in the frame of the link that carries it, if one does
  std::string carrier;  ///< that link; empty: it stands in the world
  bool visible = true;
  std::optional<ModelMotion> motion;
};

/** An entry of `solids`. */
struct SolidEntry {
  std::string name;
  std::string urdf;  ///< a document or the name of a file that has its shapes; empty: `geometry`
  Geometry geometry;
  Rgb color;
  Material material;
  bool casts_shadows = true;
  Pose X_WB;
  std::optional<ModelMotion> motion;
  double mass_kg = 0.0;              ///< 0: it stays where it is put
  std::vector<std::string> touches;  ///< `all`, `robot`, links and solids
};

using SceneEntry = std::variant<ModelEntry, SolidEntry>;

/** The `scene:` section of a scenario, checked; files are not read yet. schema/scene.yaml says what each key means. */
struct SceneConfig {
  Rgb background;
  Eigen::Vector3d light_direction_W = Eigen::Vector3d::Zero();
  Lighting lighting;
  bool has_lights = false, has_background = false;  ///< whether they stand in the section
  std::vector<ModelEntry> models;
  std::vector<SolidEntry> solids;

  /** @param node  the section; null gives an empty scene @throws ParameterError listing every fault */
  static SceneConfig fromYaml(const YAML::Node& node);
  /** Of a section that is a part of a larger document: faults are added to it. */
  SceneConfig(const SceneKeys& settings, const SectionCheck& section);
  SceneConfig() = default;

  /** Where the section says nothing of lights and background: those of a Gazebo world with its sun. */
  void lightAsGazebo();
};

/** An entry of `models`, or of `solids` if it has one of their shapes. @throws ParameterError listing every fault */
SceneEntry sceneEntryFromYaml(const YAML::Node& node);

/** Name of an entry. */
const std::string& nameOf(const SceneEntry& entry);

/** The entry, as YAML, of a model that is described by one text (the service spawn_model takes it): a URDF document of
 * fixed links, the name of a file (.urdf; .yaml: a flat target; else a mesh), or the entry itself as YAML.
 *  @throws ParameterError if it is none of these */
YAML::Node modelEntry(const std::string& name, const std::string& description);

}  // namespace aras_visual_servo_sim
