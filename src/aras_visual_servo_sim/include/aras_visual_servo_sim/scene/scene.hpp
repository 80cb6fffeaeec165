#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/image/image.hpp"
#include "aras_visual_servo_sim/scene/lighting.hpp"
#include "aras_visual_servo_sim/scene/model_motion.hpp"
#include "aras_visual_servo_sim/scene/planar_model.hpp"
#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim {

/** A mesh on a body. */
struct Shape {
  Pose X_BS;     ///< pose of the mesh in the body
  MeshPtr mesh;  ///< never null
  Rgb color;     ///< for meshes without colours of their own
  Material material;
};

/** A rigid body to be drawn: a robot link or a solid. It is shaded by the light. Only its outer faces are drawn, so
 * that a camera inside its own housing sees out. */
struct Body {
  std::string name;
  std::vector<Shape> shapes;
  Pose X_WB;  ///< the caller sets it before each frame
  bool visible = true;
  bool casts_shadows = true;
};

/** Everything that cameras see. Plain data: the caller moves models and bodies between frames. */
struct Scene {
  /** Empty, with the defaults of section `scene`. */
  Scene();

  Rgb background;
  std::vector<PlanarModel> models;
  std::vector<Body> bodies;
  std::map<std::string, ModelMotion> motions;  ///< of models and fixed bodies, by name; the caller moves them
  Eigen::Vector3d light_direction_W;           ///< direction in which the light travels, not zero
  Lighting lighting;                           ///< for the OpenGL renderer

  /** @throws UnknownNameError naming what exists */
  PlanarModel& model(const std::string& name);
  const PlanarModel& model(const std::string& name) const;
  Body& body(const std::string& name);
  /** Index into bodies, or nothing. */
  std::optional<std::size_t> findBody(const std::string& name) const;
};

}  // namespace aras_visual_servo_sim
