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

}  // namespace

MeshPictures::Use MeshPictures::of(const aiMesh& mesh) {
  Use use;
  if (mesh.mMaterialIndex >= scene_.mNumMaterials) return use;
  const aiMaterial& material = *scene_.mMaterials[mesh.mMaterialIndex];
  aiString name;
  aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  if (material.GetTexture(aiTextureType_DIFFUSE, 0, &name, nullptr, &use.set, nullptr, nullptr, modes) != AI_SUCCESS) {
    return use;
  }
  if (use.set >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !mesh.HasTextureCoords(use.set)) {
    throw ModelError("mesh '" + mesh_path_ + "': has the picture '" + name.C_Str() +
                     "' but no texture coordinates of set " + std::to_string(use.set));
  }
  const auto [found, is_new] = of_material_.emplace(mesh.mMaterialIndex, static_cast<std::int32_t>(pictures_.size()));
  if (is_new) pictures_.push_back({load(name.C_Str()), wrapOf(modes[0]), wrapOf(modes[1])});
  use.index = found->second;
  // COLLADA has a picture or a colour; assimp gives its own default for the colour then.
  const std::string extension = fs::path(mesh_path_).extension().string();
  use.replaces_color = extension == ".dae" || extension == ".DAE";
  return use;
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
