#pragma once

#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/scene/lighting.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"

namespace aras_visual_servo_sim {

/** Triangles of a mesh file that have one material; their colours and pictures are the mesh's. */
struct MaterialMesh {
  MeshPtr mesh;
  Material material;
};

/** A mesh file by its materials; one plain mesh where it says nothing of them. @throws ModelError as loadMesh */
std::vector<MaterialMesh> loadMaterialMeshes(const std::string& path, const Eigen::Vector3d& scale,
                                             const PackagePaths& packages);

/** Whether a material has no highlights, no light of its own, no back, and lets none through. */
bool isPlain(const Material& material);

/** Meshes of geometries and pictures of materials; loads each file once, however many shapes use it. */
class MeshCache {
 public:
  explicit MeshCache(const PackagePaths& packages) : packages_(packages) {}

  /** @throws ModelError if a file is missing or not readable */
  MeshPtr of(const Geometry& geometry);
  /** By the materials of a mesh file; of another geometry one, of the plain material. @throws ModelError as of() */
  std::vector<MaterialMesh> partsOf(const Geometry& geometry);
  /** @throws ModelError as of() */
  TexturePtr picture(const std::string& uri);

 private:
  std::string keyOf(const Geometry& geometry) const;

  const PackagePaths& packages_;
  std::map<std::string, MeshPtr> meshes_;
  std::map<std::string, std::vector<MaterialMesh>> parts_;
  std::map<std::string, TexturePtr> textures_;
};

/** A mesh with the same content that somebody in this process has, else this one. Thread-safe. */
MeshPtr shared(MeshPtr mesh);

}  // namespace aras_visual_servo_sim
