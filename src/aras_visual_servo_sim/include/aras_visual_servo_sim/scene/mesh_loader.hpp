#pragma once

#include <Eigen/Core>
#include <string>

#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/image/texture.hpp"
#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim {

/** Reads a mesh file (STL, DAE, OBJ, whatever assimp reads). Scene graph transforms are applied and DAE units;
 *  axes stay as in the file whatever its up axis, as in RViz. Materials' diffuse colours are kept where the file has
 *  them (STL has none), and so are their diffuse pictures with the first set of texture coordinates; a picture
 *  takes the place of a DAE's colour and is multiplied by that of other files.
 *  @param path      file on disk
 *  @param scale     factor along each axis, not zero
 *  @param packages  for pictures named by package:// or model://
 *  @throws ModelError naming the file and assimp's reason: missing, unreadable, no triangles, a picture that is not
 *          found or not readable */
MeshPtr loadMesh(const std::string& path, const Eigen::Vector3d& scale = Eigen::Vector3d::Ones(),
                 const PackagePaths& packages = PackagePaths());

/** A mesh with one picture all over instead of its own colours and pictures. @throws ModelError if it has no texture
 *  coordinates (an STL file never has any) */
MeshPtr withPicture(const TriangleMesh& mesh, const TexturePtr& texture);

}  // namespace aras_visual_servo_sim
