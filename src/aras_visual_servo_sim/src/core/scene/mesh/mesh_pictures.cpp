#include "mesh_pictures.hpp"

#include <algorithm>
#include <filesystem>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

MeshPictures::Use MeshPictures::of(const aiMesh& mesh) {
  Use use;
  if (mesh.mMaterialIndex >= scene_.mNumMaterials) return use;
  const aiMaterial& material = *scene_.mMaterials[mesh.mMaterialIndex];
  aiString name;
  aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  const auto found_at = of_material_.find(mesh.mMaterialIndex);
  TexturePtr normals = found_at == of_material_.end() ? normalsOf(material) : pictures_[found_at->second].normals;
  const bool colored =
      material.GetTexture(aiTextureType_DIFFUSE, 0, &name, nullptr, &use.set, nullptr, nullptr, modes) == AI_SUCCESS;
  if (!colored) {
    if (!normals) return use;
    name = "";  // a white picture, for the colour to stay
    normalsSet(material, use.set, modes);
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
  if (!colored) return use;
  // COLLADA has a picture or a colour; assimp gives its own default for the colour then.
  const std::string extension = fs::path(mesh_path_).extension().string();
  use.replaces_color = extension == ".dae" || extension == ".DAE";
  return use;
}

/** The normals of a material; null if it has none. OBJ's map_Bump, which assimp calls heights, often holds normals. */
TexturePtr MeshPictures::normalsOf(const aiMaterial& material) const {
  aiString name;
  if (material.GetTexture(aiTextureType_NORMALS, 0, &name) == AI_SUCCESS) return load(name.C_Str());
  if (material.GetTexture(aiTextureType_HEIGHT, 0, &name) != AI_SUCCESS) return nullptr;
  const TexturePtr picture = load(name.C_Str());
  return showsNormals(*picture) ? picture : nullptr;
}

void MeshPictures::normalsSet(const aiMaterial& material, unsigned& set, aiTextureMapMode* modes) {
  aiString name;
  for (const aiTextureType type : {aiTextureType_NORMALS, aiTextureType_HEIGHT}) {
    if (material.GetTexture(type, 0, &name, nullptr, &set, nullptr, nullptr, modes) == AI_SUCCESS) return;
  }
}

TexturePtr MeshPictures::load(const std::string& name) const {
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
std::string MeshPictures::find(const std::string& name) const {
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

}  // namespace aras_visual_servo_sim
