#include "mesh_materials.hpp"

#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace aras_visual_servo_sim {
namespace {

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
  float opacity = 1.0f;
  // Nobody makes a thing that cannot be seen: files with 0 are those of exporters that meant a transparency of 0.
  if (from.Get(AI_MATKEY_OPACITY, opacity) == AI_SUCCESS && opacity > 0.0f) {
    to.opacity = std::min(static_cast<double>(opacity), 1.0);
  }
  int two_sided = 0;
  to.two_sided = from.Get(AI_MATKEY_TWOSIDED, two_sided) == AI_SUCCESS && two_sided != 0;
  return to;
}

}  // namespace

bool isPlain(const Material& material) {
  return material.specular.isZero() && material.emissive.isZero() && material.opacity == 1.0 && !material.two_sided;
}

std::vector<Material> materialsOf(const aiScene& scene, const std::string& mesh_path) {
  const std::string extension = std::filesystem::path(mesh_path).extension().string();
  const bool collada = extension == ".dae" || extension == ".DAE";
  std::vector<Material> all;
  for (unsigned k = 0; k < scene.mNumMaterials; ++k) all.push_back(materialOf(*scene.mMaterials[k], collada));
  return all;
}

}  // namespace aras_visual_servo_sim
