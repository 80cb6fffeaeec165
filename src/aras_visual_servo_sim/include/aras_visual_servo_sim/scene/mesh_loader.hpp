#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/image/texture.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim {

/** Reads a mesh file (STL, DAE, OBJ and what else assimp reads). Transforms of the scene graph and units of DAE files
 *  are applied; the axes stay as in the file, whatever up axis it names, as in RViz. Diffuse colours of materials are
 *  kept where the file has them (STL has none), and so are diffuse pictures with the first set of texture coordinates.
 *  In a DAE file a picture replaces the colour; in other files the two are multiplied.
 *  @param path      file on disk
 *  @param scale     factor along each axis, not zero
 *  @param packages  for pictures named by package:// or model://
 *  @throws ModelError naming the file and assimp's reason: missing, unreadable, no triangles, a picture that is not
 *          found or not readable */
MeshPtr loadMesh(const std::string& path, const Eigen::Vector3d& scale = Eigen::Vector3d::Ones(),
                 const PackagePaths& packages = PackagePaths());

/** A copy of a mesh with one picture instead of all colours.
 *  @param transform  of its texture coordinates; a round body with one is its polyhedron
 *  @throws ModelError if it has no texture coordinates */
MeshPtr withPicture(const TriangleMesh& mesh, const TexturePtr& texture,
                    const std::optional<TextureTransform>& transform = std::nullopt);

}  // namespace aras_visual_servo_sim
