#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "aras_visual_servo_sim/scene/mesh_loader.hpp"

namespace aras_visual_servo_sim {

/** A triangle of the scene before it is clipped to the view and cut for the lens, in the camera's frame C.
 *
 *  Everything about a point of it follows linearly from the ray (in C) that sees it, whatever the lens: with
 *  b = areal * ray, the sum of b is 1 / Z (along the ray's own length) and b / sum(b) are the areal coordinates. */
struct Facet {
  Eigen::Matrix3d areal = Eigen::Matrix3d::Zero();  ///< row k: (p_i x p_j) / det(p_0, p_1, p_2), corner k left out
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();  ///< plane . ray = 1 / Z: the sum of the rows
  double nearest = 0.0;                             ///< largest 1 / Z of a corner; infinite if one is not ahead
  double bias = 0.0;                     ///< added to near_m / Z: lifts faces over what lies in the same plane
  std::array<Eigen::Vector3f, 3> rgb;    ///< at the corners, lit, 0 .. 255
  int picture = -1;                      ///< index into PlanarLayer::pictures(), which has its colour instead
  const MeshPicture* texture = nullptr;  ///< its texels are multiplied by rgb / 255
  /** Texture coordinates at the corners, in texels: s to the right, t down. */
  std::array<Eigen::Vector2d, 3> texels{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  /** Edge k goes from corner k to k + 1: a ray meets the triangle if edge . ray >= 0 for all three. Unit length; of two
   *  triangles that share an edge one has the negative of the other's, to the last bit. */
  std::array<Eigen::Vector3d, 3> edges{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  std::array<bool, 3> seams{};  ///< the surface goes on smoothly beyond an edge
  std::uint32_t surface = 0;    ///< facets of one shape or one face of a planar model share it
  bool planar = false;          ///< of a planar model, not of a body
  bool one_color = false;       ///< the corners' colours are equal

  /** @return false if its plane passes through the camera: it covers nothing */
  bool place(const std::array<Eigen::Vector3d, 3>& p) {
    areal.row(0) = p[1].cross(p[2]);
    areal.row(1) = p[2].cross(p[0]);
    areal.row(2) = p[0].cross(p[1]);
    const double determinant = areal.row(0).dot(p[0]);
    constexpr double kLeast = 1e-100;  // its inverse, and products with it, stay finite
    if (!(std::abs(determinant) > kLeast)) return false;
    areal /= determinant;
    plane = areal.colwise().sum();
    const double least_z = std::min({p[0].z(), p[1].z(), p[2].z()});
    nearest = least_z > 0.0 ? 1.0 / least_z : std::numeric_limits<double>::infinity();
    return true;
  }
  /** Sets edges too. @return false as place */
  bool placeWithEdges(const std::array<Eigen::Vector3d, 3>& p) {
    if (!place(p)) return false;
    const double side = p[0].dot(p[1].cross(p[2])) < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d normal = p[k].cross(p[(k + 1) % 3]);
      const double length = normal.norm();
      if (!(length > 0.0)) return false;
      edges[k] = side / length * normal;
    }
    return true;
  }
  /** Areal coordinates of the point on a ray, held inside the triangle. */
  Eigen::Vector3d weights(const Eigen::Vector3d& ray) const {
    const Eigen::Vector3d b = (areal * ray).cwiseMax(0.0);
    const double sum = b.sum();
    return sum > 0.0 ? Eigen::Vector3d(b / sum) : Eigen::Vector3d::Constant(1.0 / 3.0);
  }
  /** Of the corners, texture left out. */
  Eigen::Vector3d color(const Eigen::Vector3d& ray) const {
    if (one_color) return rgb[0].cast<double>();
    const Eigen::Vector3d w = weights(ray);
    return w[0] * rgb[0].cast<double>() + w[1] * rgb[1].cast<double>() + w[2] * rgb[2].cast<double>();
  }
  /** Texture coordinates of its plane on a ray, inside or not. @return false if it is not ahead, or grazing */
  bool texel(const Eigen::Vector3d& ray, Eigen::Vector2d& point) const {
    const Eigen::Vector3d b = areal * ray;
    const double sum = b.sum();
    constexpr double kGrazing = 1e-9;  // sine of the angle to the plane: beyond, texture coordinates mean nothing
    if (!(sum > kGrazing * plane.norm() * ray.norm())) return false;
    point = (b[0] * texels[0] + b[1] * texels[1] + b[2] * texels[2]) / sum;
    return true;
  }
};

/** Corner of a projected triangle [px]: image edges at 0 and width or height, y down. */
struct Vertex {
  float x, y;
  bool seam;  ///< the surface goes on smoothly beyond the edge from here to the triangle's next corner
};

}  // namespace aras_visual_servo_sim
