#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/sections.hpp"
#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** How a surface answers light, for the OpenGL renderer. The shape, mesh or picture has its diffuse colour. */
struct Material {
  double ambient_share = 1.0;                          ///< ambient colour over the diffuse one
  std::optional<Eigen::Vector3d> ambient;              ///< in place of that, 0 .. 1; not of pictures
  Eigen::Vector3d specular = Eigen::Vector3d::Zero();  ///< 0 .. 1
  double shininess = 1.0;                              ///< exponent of the highlight
  Eigen::Vector3d emissive = Eigen::Vector3d::Zero();  ///< 0 .. 1
  bool unlit = false;                                  ///< drawn in its own colour: neither lights nor shadows count
  double opacity = 1.0;                                ///< 0 .. 1
  bool two_sided = false;                              ///< its back is drawn too, lit as a front
};

/** A lamp. Intensities are 0 .. 1, or more. */
struct Light {
  using Type = LightType;
  std::string name;
  Type type = Type::kDirectional;
  Eigen::Vector3d position_W = Eigen::Vector3d::Zero();     ///< of point and spot lights [m]
  Eigen::Vector3d direction_W = -Eigen::Vector3d::UnitZ();  ///< where light travels, of directional and spot ones
  Eigen::Vector3d diffuse = Eigen::Vector3d::Ones(), specular = Eigen::Vector3d::Zero();
  double range_m = std::numeric_limits<double>::infinity();  ///< farther away a point or spot light lights nothing
  double constant = 1.0, linear_per_m = 0.0, quadratic_per_m2 = 0.0;  ///< 1 / (c + l d + q d^2) at the distance d
  double inner_angle_rad = 0.0, outer_angle_rad = 0.0;  ///< of a spot, whole angles: full light inside, none outside
  double falloff = 1.0;                                 ///< of a spot: exponent from 1 to 0 between these angles
  bool casts_shadows = true;
  bool at_camera = false;  ///< a point light that the camera carries at its origin

  /** What carries it, a link or a model with the frame A; empty: it stands in the world. */
  std::string attached_to;
  Eigen::Vector3d position_A = Eigen::Vector3d::Zero(), direction_A = -Eigen::Vector3d::UnitZ();  ///< if attached
  Pose X_WA;                                                                                      ///< set by carry()

  /** Puts an attached light where its carrier is. */
  void carry(const Pose& carrier) {
    X_WA = carrier;
    position_W = carrier * position_A;
    direction_W = carrier.q * direction_A;
  }
};

/** Fog: of a thing at distance d exp(-(density d)^2) is left. */
struct Fog {
  Rgb color;
  double density_per_m = 0.0;
};

/** What the things of a scene are lit by. The coverage renderer knows but one light, Scene::light_direction_W. */
struct Lighting {
  static constexpr int kMostLights = 8;  ///< as schema/scene.yaml says

  Eigen::Vector3d ambient = Eigen::Vector3d::Zero();  ///< light from everywhere, 0 .. 1
  std::vector<Light> lights;
  /** Whether there is what the coverage renderer has, besides these lights and in place of `ambient`; nothing: if there
   *  are no lights. */
  std::optional<bool> as_coverage;
  bool shadows = true;
  int shadow_map_px = 1024;
  std::optional<Fog> fog;
  std::optional<Rgb> zenith;  ///< colour of the sky above; the background is that of the horizon

  /** Index into lights, or nothing. */
  std::optional<std::size_t> find(const std::string& light) const {
    for (std::size_t k = 0; k < lights.size(); ++k) {
      if (lights[k].name == light) return k;
    }
    return std::nullopt;
  }
};

}  // namespace aras_visual_servo_sim
