#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/image.hpp"

namespace aras_visual_servo_sim {

/** Triangles with a normal and a colour at each vertex; metres, counter-clockwise seen from outside. Never changed
 *  after it was made, so shapes share it. */
struct TriangleMesh {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< one for each point, unit length
  std::vector<Rgb> colors;               ///< one for each point; empty: the shape's own colour
  std::vector<std::array<std::uint32_t, 3>> triangles;
  Eigen::Vector3f box_min = Eigen::Vector3f::Zero();  ///< bounding box
  Eigen::Vector3f box_max = Eigen::Vector3f::Zero();

  void updateBox();
};

using MeshPtr = std::shared_ptr<const TriangleMesh>;

/** Box centred at the origin. @param size_m  edge lengths, > 0  @throws ModelError */
MeshPtr makeBox(const Eigen::Vector3d& size_m);
/** Cylinder along z, centred at the origin. @throws ModelError unless radius_m and length_m are > 0 */
MeshPtr makeCylinder(double radius_m, double length_m, int segments = 32);
/** Sphere centred at the origin. @throws ModelError unless radius_m > 0 */
MeshPtr makeSphere(double radius_m, int segments = 32);

/** Reads a mesh file (STL, DAE, OBJ, whatever assimp reads). Scene graph transforms are applied and DAE units;
 *  axes stay as in the file whatever its up axis, as in RViz. Materials' diffuse colours are kept where the file has
 * them (STL has none).
 *  @param path     file on disk
 *  @param scale    factor along each axis, not zero
 *  @throws ModelError naming the file and assimp's reason: missing, unreadable, no triangles */
MeshPtr loadMesh(const std::string& path, const Eigen::Vector3d& scale = Eigen::Vector3d::Ones());

/** Finds files named by `package://name/path`, `file://path` or a plain path.
 *
 *  Packages are looked up in the map given; then in ROS_PACKAGE_PATH, where an entry may be the package itself, a
 * folder of packages or an install space's share folder; then in share/ of every CMAKE_PREFIX_PATH entry. */
class PackagePaths {
 public:
  PackagePaths() = default;
  explicit PackagePaths(std::vector<std::pair<std::string, std::string>> packages) : packages_(std::move(packages)) {}

  /** @param base_dir  what relative plain paths are relative to; empty = working directory
   *  @return a path that exists
   *  @throws ModelError naming uri and where it was looked for */
  std::string resolve(const std::string& uri, const std::string& base_dir = "") const;

 private:
  std::string findPackage(const std::string& name) const;
  std::vector<std::pair<std::string, std::string>> packages_;
};

}  // namespace aras_visual_servo_sim
