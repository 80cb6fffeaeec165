#pragma once

#include <assimp/scene.h>

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/scene/mesh_loader.hpp"

namespace aras_visual_servo_sim {

/** The pictures of a mesh file's materials: read once each, from files or out of the mesh file itself. */
class MeshPictures {
 public:
  MeshPictures(const aiScene& scene, std::string mesh_path, const PackagePaths& packages)
      : scene_(scene), mesh_path_(std::move(mesh_path)), packages_(packages) {}

  /** How one part of the mesh uses its picture. */
  struct Use {
    std::int32_t index = -1;      ///< into all(), -1: no picture
    unsigned set = 0;             ///< of texture coordinates
    bool replaces_color = false;  ///< else its texels are multiplied by the material's colour

    /** s to the right, t down. */
    Eigen::Vector2f coordinates(const aiMesh& mesh, unsigned vertex) const {
      if (index < 0) return Eigen::Vector2f::Zero();
      const aiVector3D& uv = mesh.mTextureCoords[set][vertex];
      return {uv.x, 1.0f - uv.y};
    }
  };
  /** @throws ModelError naming mesh and picture: not found, not readable, no texture coordinates */
  Use of(const aiMesh& mesh);

  const std::vector<MeshPicture>& all() const { return pictures_; }

 private:
  TexturePtr normalsOf(const aiMaterial& material) const;
  /** Set of coordinates and continuation of the normals of a material without another picture. */
  static void normalsSet(const aiMaterial& material, unsigned& set, aiTextureMapMode* modes);
  TexturePtr load(const std::string& name) const;
  std::string find(const std::string& name) const;

  const aiScene& scene_;
  std::string mesh_path_;
  const PackagePaths& packages_;
  std::vector<MeshPicture> pictures_;
  std::map<unsigned, std::int32_t> of_material_;
};

}  // namespace aras_visual_servo_sim
