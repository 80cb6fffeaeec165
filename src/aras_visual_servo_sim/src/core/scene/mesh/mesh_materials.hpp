#pragma once

#include <string>
#include <vector>

#include "aras_visual_servo_sim/scene/lighting.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"

struct aiScene;

namespace aras_visual_servo_sim {

/** Triangles of a mesh file that have one material; their colours and pictures are the mesh's. */
struct MaterialMesh {
  MeshPtr mesh;
  Material material;
};

/** A mesh file by its materials; one mesh of the plain one where it says nothing of them. @throws ModelError as
 * loadMesh */
std::vector<MaterialMesh> loadMaterialMeshes(const std::string& path, const Eigen::Vector3d& scale,
                                             const PackagePaths& packages);

/** Whether a material has no highlights, no light of its own, no back, and lets none through. */
bool isPlain(const Material& material);
/** What a mesh file says of highlights, own light, opacity and backs: of each of its materials. */
std::vector<Material> materialsOf(const aiScene& scene, const std::string& mesh_path);

}  // namespace aras_visual_servo_sim
