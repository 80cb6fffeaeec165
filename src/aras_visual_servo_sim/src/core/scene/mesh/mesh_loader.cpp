#include "aras_visual_servo_sim/scene/mesh_loader.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <aras_visual_servo_common/files.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "mesh_materials.hpp"
#include "mesh_pictures.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::size_t kMostMeshBytes = 256 * 1024 * 1024;  // five million triangles of STL

std::uint8_t toByte(float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f); }

/** Diffuse colour of a mesh; nothing if its file gave no material (assimp then makes one of its own). */
bool materialColor(const aiScene& scene, const aiMesh& mesh, Rgb& color) {
  if (mesh.mMaterialIndex >= scene.mNumMaterials) return false;
  const aiMaterial& material = *scene.mMaterials[mesh.mMaterialIndex];
  aiString name;
  if (material.Get(AI_MATKEY_NAME, name) == AI_SUCCESS && name == aiString(AI_DEFAULT_MATERIAL_NAME)) return false;
  aiColor4D diffuse;
  if (material.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse) != AI_SUCCESS) return false;
  color = {toByte(diffuse.r), toByte(diffuse.g), toByte(diffuse.b)};
  return true;
}

/** Collects the meshes of a scene graph into one, everything in the frame of its root. */
class Collector {
 public:
  /** @param pictures  null: colours and pictures are left out  @param taken  by material, whether its triangles are
   *  taken; empty: all are */
  Collector(const aiScene& scene, const Eigen::Vector3d& scale, MeshPictures* pictures, std::vector<bool> taken)
      : scene_(scene),
        scale_(scale.cast<float>()),
        pictures_(pictures),
        taken_(std::move(taken)),
        mesh_(std::make_shared<TriangleMesh>()) {}

  void addNode(const aiNode& node, const aiMatrix4x4& parent) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) addMesh(*scene_.mMeshes[node.mMeshes[i]], transform);
    for (unsigned i = 0; i < node.mNumChildren; ++i) addNode(*node.mChildren[i], transform);
  }

  std::shared_ptr<TriangleMesh> finish() {
    if (!any_color_) mesh_->colors.clear();
    if (pictures_) mesh_->pictures = pictures_->all();
    if (mesh_->pictures.empty()) {
      mesh_->texture_coordinates.clear();
      mesh_->picture_of.clear();
    }
    mesh_->finish();
    return mesh_;
  }

 private:
  void addMesh(const aiMesh& mesh, const aiMatrix4x4& transform) {
    if (!taken_.empty() && !taken_.at(mesh.mMaterialIndex)) return;
    const auto first = static_cast<std::uint32_t>(mesh_->points.size());
    const aiMatrix3x3 linear(transform);
    aiMatrix3x3 cofactor = linear;  // normals turn with the inverse transpose
    cofactor.Inverse().Transpose();
    const bool mirrored = (linear.Determinant() < 0.0f) != (scale_.prod() < 0.0f);
    Rgb color{178, 178, 178};
    if (pictures_ && materialColor(scene_, mesh, color)) any_color_ = true;
    const MeshPictures::Use use = pictures_ ? pictures_->of(mesh) : MeshPictures::Use{};
    if (use.replaces_color) color = {255, 255, 255};
    any_color_ = any_color_ || use.index >= 0;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D p = transform * mesh.mVertices[i];
      const aiVector3D n = cofactor * mesh.mNormals[i];
      mesh_->points.push_back(Eigen::Vector3f(p.x, p.y, p.z).cwiseProduct(scale_));
      mesh_->normals.push_back(Eigen::Vector3f(n.x, n.y, n.z).cwiseQuotient(scale_).normalized());
      mesh_->colors.push_back(color);
      mesh_->texture_coordinates.push_back(use.coordinates(mesh, i));
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;
      std::array<std::uint32_t, 3> triangle{first + face.mIndices[0], first + face.mIndices[1],
                                            first + face.mIndices[2]};
      if (mirrored) std::swap(triangle[1], triangle[2]);
      mesh_->triangles.push_back(triangle);
      mesh_->picture_of.push_back(use.index);
    }
  }

  const aiScene& scene_;
  Eigen::Vector3f scale_;
  MeshPictures* pictures_;
  std::vector<bool> taken_;
  bool any_color_ = false;
  std::shared_ptr<TriangleMesh> mesh_;
};

/** A mesh file as assimp reads it. */
class MeshFile {
 public:
  /** @throws ModelError naming the file */
  MeshFile(const std::string& path, const Eigen::Vector3d& scale, const PackagePaths& packages)
      : path_(path), scale_(scale), packages_(packages) {
    if (!scale.allFinite() || (scale.array() == 0.0).any()) {
      throw ModelError("mesh '" + path + "': scale must be finite and not zero");
    }
    try {
      aras_visual_servo_common::checkFile(path, kMostMeshBytes);
    } catch (const ArasError& error) {
      throw ModelError("mesh " + std::string(error.what()));
    }
    importer_.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 40.0f);  // sharper edges stay edges
    importer_.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_LINE | aiPrimitiveType_POINT);
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);  // axes as in the file, as RViz does
    const std::string extension = path.size() > 4 ? path.substr(path.size() - 4) : "";
    stl_ = extension == ".stl" || extension == ".STL";
    // STL carries a normal for each face only: drop them and smooth anew where faces meet at a blunt angle.
    if (stl_) importer_.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_COLORS);
    const unsigned flags = aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_GenSmoothNormals |
                           aiProcess_SortByPType | aiProcess_TransformUVCoords |
                           (stl_ ? unsigned{aiProcess_RemoveComponent} : 0u);
    scene_ = importer_.ReadFile(path, flags);
    if (!scene_ || !scene_->mRootNode) throw ModelError("mesh '" + path + "': " + importer_.GetErrorString());
  }

  /** Of each material; nothing if the file has none of its own. */
  std::vector<Material> materials() const { return stl_ ? std::vector<Material>() : materialsOf(*scene_, path_); }

  /** @param taken  of Collector @throws ModelError naming the file */
  MeshPtr mesh(const std::vector<bool>& taken = {}) const {
    MeshPictures pictures(*scene_, path_, packages_);
    Collector collector(*scene_, scale_, stl_ ? nullptr : &pictures, taken);
    collector.addNode(*scene_->mRootNode, aiMatrix4x4());
    const auto mesh = collector.finish();
    if (mesh->triangles.empty() && taken.empty()) throw ModelError("mesh '" + path_ + "': has no triangles");
    for (const Eigen::Vector3f& point : mesh->points) {
      if (!point.allFinite()) throw ModelError("mesh '" + path_ + "': a point is not finite");
    }
    return mesh;
  }

 private:
  std::string path_;
  Eigen::Vector3d scale_;
  const PackagePaths& packages_;
  Assimp::Importer importer_;
  const aiScene* scene_ = nullptr;
  bool stl_ = false;
};

bool same(const Material& a, const Material& b) {
  return a.specular == b.specular && a.shininess == b.shininess && a.emissive == b.emissive && a.opacity == b.opacity &&
         a.two_sided == b.two_sided;
}

}  // namespace

MeshPtr loadMesh(const std::string& path, const Eigen::Vector3d& scale, const PackagePaths& packages) {
  return MeshFile(path, scale, packages).mesh();
}

std::vector<MaterialMesh> loadMaterialMeshes(const std::string& path, const Eigen::Vector3d& scale,
                                             const PackagePaths& packages) {
  const MeshFile file(path, scale, packages);
  const std::vector<Material> materials = file.materials();
  if (std::all_of(materials.begin(), materials.end(), isPlain)) return {{file.mesh(), Material{}}};
  std::vector<MaterialMesh> all;
  std::vector<bool> done(materials.size());
  for (std::size_t k = 0; k < materials.size(); ++k) {
    if (done[k]) continue;
    std::vector<bool> taken(materials.size());
    for (std::size_t i = k; i < materials.size(); ++i) taken[i] = same(materials[i], materials[k]);
    for (std::size_t i = k; i < materials.size(); ++i) done[i] = done[i] || taken[i];
    const MeshPtr mesh = file.mesh(taken);
    if (!mesh->triangles.empty()) all.push_back({mesh, materials[k]});
  }
  if (all.empty()) throw ModelError("mesh '" + path + "': has no triangles");
  return all;
}

}  // namespace aras_visual_servo_sim
