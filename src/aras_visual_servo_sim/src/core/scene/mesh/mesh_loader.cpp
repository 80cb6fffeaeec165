#include "aras_visual_servo_sim/scene/mesh_loader.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <aras_visual_servo_common/files.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "mesh_cache.hpp"

namespace aras_visual_servo_sim {
namespace {

namespace fs = std::filesystem;

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

bool hasExtension(const std::string& path, const char* small, const char* capital) {
  const fs::path extension = fs::path(path).extension();
  return extension == small || extension == capital;
}

Wrap wrapOf(aiTextureMapMode mode) {
  switch (mode) {
    case aiTextureMapMode_Mirror:
      return Wrap::kMirror;
    case aiTextureMapMode_Clamp:
    case aiTextureMapMode_Decal:
      return Wrap::kClamp;
    default:
      return Wrap::kRepeat;
  }
}

TexturePtr textureOf(const std::string& name, const aiTexture& embedded) {
  if (embedded.mHeight == 0) {  // a file as it is
    return loadTexture(name, reinterpret_cast<const std::uint8_t*>(embedded.pcData), embedded.mWidth);
  }
  std::vector<std::uint8_t> rgb;
  for (std::size_t k = 0; k < std::size_t(embedded.mWidth) * embedded.mHeight; ++k) {
    rgb.insert(rgb.end(), {embedded.pcData[k].r, embedded.pcData[k].g, embedded.pcData[k].b});
  }
  return std::make_shared<Texture>(name, embedded.mWidth, embedded.mHeight, std::move(rgb));
}

TexturePtr white() {
  static const TexturePtr texel = std::make_shared<Texture>("white", 1, 1, std::vector<std::uint8_t>(3, 255));
  return texel;
}

/** Whether a picture is of normals, which point off the surface in the mean, and not of heights, which are grey. */
bool showsNormals(const Texture& texture) {
  constexpr int kBlue = 40;  // grey levels
  const Rgb mean = texture.meanColor();
  return mean.b > mean.r + kBlue && mean.b > mean.g + kBlue;
}

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
  Use of(const aiMesh& mesh) {
    Use use;
    if (mesh.mMaterialIndex >= scene_.mNumMaterials) return use;
    const aiMaterial& material = *scene_.mMaterials[mesh.mMaterialIndex];
    aiString name;
    aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    const auto get = [&](aiTextureType type) {
      return material.GetTexture(type, 0, &name, nullptr, &use.set, nullptr, nullptr, modes) == AI_SUCCESS;
    };
    const auto found_at = of_material_.find(mesh.mMaterialIndex);
    TexturePtr normals = found_at == of_material_.end() ? normalsOf(material) : pictures_[found_at->second].normals;
    const bool colored = get(aiTextureType_DIFFUSE);
    if (!colored) {
      if (!normals) return use;
      if (!get(aiTextureType_NORMALS)) get(aiTextureType_HEIGHT);
      name = "";  // a white picture, for the colour to stay
    }
    if (use.set >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !mesh.HasTextureCoords(use.set)) {
      throw ModelError("mesh '" + mesh_path_ + "': has the picture '" + name.C_Str() +
                       "' but no texture coordinates of set " + std::to_string(use.set));
    }
    const auto [found, is_new] = of_material_.emplace(mesh.mMaterialIndex, static_cast<std::int32_t>(pictures_.size()));
    if (is_new) {
      pictures_.push_back({colored ? load(name.C_Str()) : white(), wrapOf(modes[0]), wrapOf(modes[1]), normals});
    }
    use.index = found->second;
    // COLLADA has a picture or a colour; assimp gives its own default for the colour then.
    use.replaces_color = colored && hasExtension(mesh_path_, ".dae", ".DAE");
    return use;
  }

  const std::vector<MeshPicture>& all() const { return pictures_; }

 private:
  /** The normals of a material, or null. OBJ's map_Bump, which assimp calls heights, often holds normals. */
  TexturePtr normalsOf(const aiMaterial& material) const {
    aiString name;
    if (material.GetTexture(aiTextureType_NORMALS, 0, &name) == AI_SUCCESS) return load(name.C_Str());
    if (material.GetTexture(aiTextureType_HEIGHT, 0, &name) != AI_SUCCESS) return nullptr;
    const TexturePtr picture = load(name.C_Str());
    return showsNormals(*picture) ? picture : nullptr;
  }

  TexturePtr load(const std::string& name) const {
    try {
      if (const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str())) {
        return textureOf(mesh_path_ + ": " + name, *embedded);
      }
      return loadTexture(find(name));
    } catch (const ModelError& error) {
      throw ModelError("mesh '" + mesh_path_ + "': " + error.what());
    }
  }

  /** As it is written, from the mesh's folder; else by its last name where Gazebo's models have theirs. */
  std::string find(const std::string& name) const {
    const fs::path folder = fs::path(mesh_path_).parent_path();
    if (name.find("://") != std::string::npos) return packages_.resolve(name, folder.string());
    std::string written = name;
    std::replace(written.begin(), written.end(), '\\', '/');
    const fs::path last = fs::path(written).filename();
    std::string looked;
    for (const fs::path& path : {folder / written, folder / last, folder / ".." / "materials" / "textures" / last,
                                 folder / ".." / "textures" / last}) {
      std::error_code ignored;
      if (fs::is_regular_file(path, ignored)) return path.string();
      looked += (looked.empty() ? "" : ", ") + path.lexically_normal().string();
    }
    throw ModelError("picture '" + name + "' not found, looked for " + looked);
  }

  const aiScene& scene_;
  std::string mesh_path_;
  const PackagePaths& packages_;
  std::vector<MeshPicture> pictures_;
  std::map<unsigned, std::int32_t> of_material_;
};

/** Collects the meshes of a scene graph into one, everything in the frame of its root. */
class Collector {
 public:
  /** @param pictures  null: colours are left out too  @param taken  materials whose triangles are; empty: all */
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

/** 0 .. 1 each; black if the key is not there or not finite. */
Eigen::Vector3d colorOf(const aiMaterial& material, const char* key, unsigned type, unsigned index) {
  aiColor3D color(0.0f, 0.0f, 0.0f);
  if (material.Get(key, type, index, color) != AI_SUCCESS) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d found(color.r, color.g, color.b);
  return found.allFinite() ? Eigen::Vector3d(found.cwiseMax(0.0).cwiseMin(1.0)) : Eigen::Vector3d::Zero();
}

/** Whether the colour of highlights is one: assimp has a grey of its own for COLLADA's <lambert> and <constant>. */
bool hasHighlights(const aiMaterial& material, bool collada) {
  int model = aiShadingMode_Phong;
  if (material.Get(AI_MATKEY_SHADING_MODEL, model) != AI_SUCCESS) return true;
  if (model == aiShadingMode_NoShading) return false;
  return !collada || model == aiShadingMode_Phong || model == aiShadingMode_Blinn;
}

Material materialOf(const aiMaterial& from, bool collada) {
  constexpr double kMostShininess = 1000.0;  // as the schema has it
  Material to;
  if (hasHighlights(from, collada)) to.specular = colorOf(from, AI_MATKEY_COLOR_SPECULAR);
  float shininess = 0.0f;
  if (from.Get(AI_MATKEY_SHININESS, shininess) == AI_SUCCESS && std::isfinite(shininess)) {
    to.shininess = std::clamp(static_cast<double>(shininess), 0.0, kMostShininess);
  }
  to.emissive = colorOf(from, AI_MATKEY_COLOR_EMISSIVE);
  // Added to a picture, the most light that there can be leaves nothing of it: such files mean a picture that no light
  // shines on, and Gazebo draws it so.
  if (from.GetTextureCount(aiTextureType_DIFFUSE) > 0 && to.emissive.minCoeff() >= 1.0) {
    to.emissive.setZero();
    to.unlit = true;
  }
  float opacity = 1.0f;
  // Things that cannot be seen are not made: files with 0 are those of exporters that meant a transparency of 0.
  if (from.Get(AI_MATKEY_OPACITY, opacity) == AI_SUCCESS && opacity > 0.0f) {
    to.opacity = std::min(static_cast<double>(opacity), 1.0);
  }
  int two_sided = 0;
  to.two_sided = from.Get(AI_MATKEY_TWOSIDED, two_sided) == AI_SUCCESS && two_sided != 0;
  return to;
}

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
    stl_ = hasExtension(path, ".stl", ".STL");
    // STL carries a normal for each face only: drop them and smooth anew where faces meet at a blunt angle.
    if (stl_) importer_.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_COLORS);
    const unsigned flags = aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_GenSmoothNormals |
                           aiProcess_SortByPType | aiProcess_TransformUVCoords |
                           (stl_ ? unsigned{aiProcess_RemoveComponent} : 0u);
    scene_ = importer_.ReadFile(path, flags);
    if (!scene_ || !scene_->mRootNode) throw ModelError("mesh '" + path + "': " + importer_.GetErrorString());
  }

  /** Of each material; nothing if the file has none of its own. */
  std::vector<Material> materials() const {
    std::vector<Material> all;
    for (unsigned k = 0; k < scene_->mNumMaterials && !stl_; ++k) {
      all.push_back(materialOf(*scene_->mMaterials[k], hasExtension(path_, ".dae", ".DAE")));
    }
    return all;
  }

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
         a.two_sided == b.two_sided && a.unlit == b.unlit;
}

}  // namespace

bool isPlain(const Material& material) {
  return material.specular.isZero() && material.emissive.isZero() && material.opacity == 1.0 && !material.two_sided &&
         !material.unlit;
}

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
