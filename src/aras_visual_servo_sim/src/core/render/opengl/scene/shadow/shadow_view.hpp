#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "aras_visual_servo_sim/scene/scene.hpp"

namespace aras_visual_servo_sim {

/** A thing that casts shadows. */
struct Caster {
  const MeshPtr* mesh;
  Eigen::Matrix4d X_WS;
  Eigen::Vector3d center_W;  ///< of the ball that holds it
  double radius_m;
  long serial;  ///< of its mesh: GlMesh::serial

  /** What its shadow depends on: the same numbers mean the same shadow. */
  std::array<double, 17> key() const;
};

/** What casts shadows in a scene, its serial 0. Poses are rounded to 2^-30 m: what two simulations have of one thing is
 *  the same then, however each has worked it out. */
std::vector<Caster> castersOf(const Scene& scene);

/** A box in the coordinates of a map: s, t and depth. */
struct MapBox {
  Eigen::Array3d low = Eigen::Array3d::Constant(1e9), high = -low;

  bool empty() const { return !(low <= high).all(); }
  void add(const Eigen::Vector3d& point) {
    low = low.min(point.array());
    high = high.max(point.array());
  }
  /** Whether this can lie in the shadow of a caster. */
  bool meets(const MapBox& caster) const {
    return (low.head<2>() <= caster.high.head<2>()).all() && (caster.low <= high).all();
  }
};

/** How a light that casts shadows sees the world. */
struct ShadowView {
  /** To the map's coordinates and depth, each 0 .. 1; of a point light to the world's axes about it. */
  Eigen::Matrix4d of_world = Eigen::Matrix4d::Identity();
  double texel = 0.0;            ///< width of a texel: of a directional light [m], else over the distance
  double near = 0.0, far = 1.0;  ///< of a cube's faces [m]
  bool directional = true, cube = false;
  Eigen::Vector3d light_W = Eigen::Vector3d::Zero();  ///< where the light is, unless directional
  int width = 0, height = 0;                          ///< of the map, or of a face [px]

  ShadowView() = default;
  /** The part of the world with all the casters in it, or all around a point light.
   *  @param casters  that the light reaches  @param side  of the map, the longer one of a rectangle [px] */
  ShadowView(const Light& light, const std::vector<const Caster*>& casters, int side);

  /** Of the map of a directional light, where a caster and, behind its low side, its shadow can be read. */
  MapBox boxOf(const Caster& caster) const;
  /** Of a cube map the view of face k, from the frame about the light. */
  Eigen::Matrix4d ofFace(int k) const;
  /** Whether face k of a cube map can show a caster. */
  bool isOnFace(int k, const Caster& caster) const;
  static constexpr int kFaces = 6;
  /** [texels] by how much a point is lifted off its surface for its shadow: as far as the taps reach. */
  static constexpr double kLift = 2.5;

 private:
  void placeDirectional(const Light& light, const std::vector<const Caster*>& casters, int side);
};

/** Of the casters those that a light reaches. */
std::vector<const Caster*> reachedBy(const Light& light, const std::vector<Caster>& casters);

}  // namespace aras_visual_servo_sim
