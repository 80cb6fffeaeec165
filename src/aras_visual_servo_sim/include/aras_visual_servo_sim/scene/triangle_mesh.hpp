#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "aras_visual_servo_sim/image/image.hpp"
#include "aras_visual_servo_sim/image/texture.hpp"

namespace aras_visual_servo_sim {

/** How a picture continues on a surface beyond its edges. */
enum class Wrap {
  kRepeat,
  kMirror,  ///< repeated, every other copy mirrored
  kClamp    ///< the texels at the edge continue
};

/** A picture on triangles of a mesh. */
struct MeshPicture {
  TexturePtr texture;  ///< never null
  Wrap wrap_s = Wrap::kRepeat, wrap_t = Wrap::kRepeat;
  /** Null, or a picture, on the same coordinates, of where the surface's normal points: red along s, green up the
   *  picture, blue off the surface, each from -1 (0) to 1 (255), as glTF has it. For the OpenGL renderer. */
  TexturePtr normals{};
};

/** What a mesh of a round body stands for, centred at the origin and along z. */
struct RoundShape {
  enum class Kind { kSphere, kCylinder, kCone };  ///< the cone's tip is at +z
  Kind kind;
  double radius_m;
  double length_m = 0.0;  ///< not of a sphere
};

/** Triangles with a normal and a colour at each vertex [m], counter-clockwise seen from outside. Shared by shapes. */
struct TriangleMesh {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< one for each point, unit length
  std::vector<Rgb> colors;               ///< one for each point; empty: the shape's own colour
  /** One for each point, or none: s to the right and t down the picture, which reaches from 0 to 1. */
  std::vector<Eigen::Vector2f> texture_coordinates;
  std::vector<MeshPicture> pictures;
  /** Whoever can draw this exactly does; its triangles are for the others. */
  std::optional<RoundShape> round;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::int32_t> picture_of;  ///< for each triangle an index into pictures, -1: none; empty: none has one
  /** For each triangle and its edge from corner k to k + 1, the triangle beyond that edge which has both of these
   * points, so that the surface continues without a crease; -1 if there is none. */
  std::vector<std::array<std::uint32_t, 3>> neighbours;
  static constexpr std::uint32_t kNone = 0xffffffff;
  Eigen::Vector3f box_min = Eigen::Vector3f::Zero();  ///< bounding box
  Eigen::Vector3f box_max = Eigen::Vector3f::Zero();

  /** Corner of the box: bits 0, 1, 2 of k choose the side in x, y, z. */
  Eigen::Vector3d corner(int k) const {
    const auto side = [&](int axis) { return k >> axis & 1 ? box_max[axis] : box_min[axis]; };
    return {side(0), side(1), side(2)};
  }
  /** Of the ball about the box. */
  Eigen::Vector3d center() const { return (0.5f * (box_min + box_max)).cast<double>(); }
  double radius() const { return 0.5 * (box_max - box_min).cast<double>().norm(); }

  /** Sets neighbours and box, when all else is there; a normal that is missing or no direction becomes the mean of
   *  those of the triangles about its point. */
  void finish();
};

using MeshPtr = std::shared_ptr<const TriangleMesh>;

/** Box centred at the origin. @param size_m  edge lengths, > 0  @throws ModelError */
MeshPtr makeBox(const Eigen::Vector3d& size_m);
/** Cylinder along z, centred at the origin. @throws ModelError unless radius_m and length_m are > 0 */
MeshPtr makeCylinder(double radius_m, double length_m, int segments = 32);
/** Cone along z, its tip at +z, the middle of its length at the origin. @throws as makeCylinder */
MeshPtr makeCone(double radius_m, double length_m, int segments = 32);
/** Sphere centred at the origin. @throws ModelError unless radius_m > 0 */
MeshPtr makeSphere(double radius_m, int segments = 32);

}  // namespace aras_visual_servo_sim
