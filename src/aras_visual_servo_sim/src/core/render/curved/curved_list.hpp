#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/scene/scene.hpp"
#include "render/view/view_volume.hpp"

namespace aras_visual_servo_sim {

/** One smooth part of a round body as one camera sees it: a sphere, the side of a cylinder or cone, or a disc.
 *
 *  A point of the surface on a ray d (in the camera's frame C) is d / n, with n the inverse of its depth along the ray.
 *  Put into the equation of the surface, which is quadratic, that gives
 *  n(d) = linear . d + root sqrt(d^T form d), and the ray misses where d^T form d < 0. Where a side ends, and where
 * what lies behind the camera is left out, is a bound linear in d and n. Of the front of a convex body n is concave in
 * d, so over a pixel it is least in a corner and below its tangent plane. */
struct CurvedPatch {
  enum class Part { kSphere, kCylinderSide, kConeSide, kDisc };
  /** Seen only where ray . d + nearness * n >= 0. */
  struct Bound {
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();
    double nearness = 0.0;
  };
  /** Where a ray meets the surface, whatever its bounds. */
  struct Hit {
    double within;    ///< d^T form d: a miss if it is negative
    double nearness;  ///< n
  };

  Hit hit(const Eigen::Vector3d& ray) const;
  bool isWithinBounds(const Eigen::Vector3d& ray, double nearness) const {
    for (const Bound& bound : bounds) {
      if (bound.ray.dot(ray) + bound.nearness * nearness < 0.0) return false;
    }
    return nearness > 0.0;
  }
  /** Gradient of n with respect to the ray: the tangent plane of the surface, plane . d = n there. */
  Eigen::Vector3d plane(const Eigen::Vector3d& ray, const Hit& hit) const;
  /** Colour of the point on a ray, lit, its picture left out; 0 .. 255. Beyond the outline: of its nearest point. */
  Eigen::Vector3d color(const Eigen::Vector3d& ray) const;
  /** Texture coordinates of the point on a ray, in texels: s to the right, t down. @pre texture */
  Eigen::Vector2d texel(const Eigen::Vector3d& ray) const;

  Part part;
  Eigen::Matrix3d form = Eigen::Matrix3d::Zero();
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
  double root = 0.0;
  std::array<Bound, 2> bounds;

  Eigen::Matrix3d R_SC = Eigen::Matrix3d::Identity();  ///< S: frame of the shape
  Eigen::Vector3d p_SC = Eigen::Vector3d::Zero();      ///< the camera in S [m]
  RoundShape shape{};
  double side = 0.0;  ///< of a disc: -1 at the lower end of its body, 1 at the upper one
  Eigen::Vector3d rgb = Eigen::Vector3d::Zero();
  Eigen::Vector3d light_S = Eigen::Vector3d::Zero();  ///< where the light travels, unit
  const MeshPicture* texture = nullptr;

 private:
  Eigen::Vector3d point(const Eigen::Vector3d& ray) const;
};

/** The round shapes of a scene as one camera sees them: their parts, and the tiles of the image that each may touch. */
class CurvedList {
 public:
  struct Entry {
    CurvedPatch patch;
    std::size_t body;  ///< index into the scene's bodies
  };

  /** Starts a frame. */
  void begin(const CameraModel& camera, const ViewVolume& volume);
  /** Adds what may be in view of the bodies' round shapes, and sorts it into tiles. @return false if nothing is */
  bool addBodies(const Scene& scene, const Pose& X_CW);

  const std::vector<Entry>& entries() const { return entries_; }
  /** Entries that a tile (CameraModel::blockCones has their order) may see; none in tiles beyond tiles(). */
  const std::uint32_t* begin(int tile) const { return sorted_.data() + starts_[tile]; }
  const std::uint32_t* end(int tile) const { return sorted_.data() + starts_[tile + 1]; }
  int tiles() const { return starts_.empty() ? 0 : static_cast<int>(starts_.size()) - 1; }

 private:
  void addShape(const Shape& shape, const Pose& X_CS, const Eigen::Vector3d& light_C, std::size_t body);
  void sort();

  const CameraModel* camera_ = nullptr;
  const ViewVolume* volume_ = nullptr;
  std::vector<Entry> entries_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> touched_;  // tile, entry
  std::vector<std::uint32_t> near_tiles_;                         // scratch
  std::vector<std::uint32_t> starts_, next_, sorted_;
};

}  // namespace aras_visual_servo_sim
