#include "mesh_cache.hpp"

namespace aras_visual_servo_sim {

MeshPtr MeshCache::of(const Geometry& geometry) {
  switch (geometry.type) {
    case Geometry::Type::kBox:
      return makeBox(geometry.size_m);
    case Geometry::Type::kCylinder:
      return makeCylinder(geometry.radius_m, geometry.length_m);
    case Geometry::Type::kCone:
      return makeCone(geometry.radius_m, geometry.length_m);
    case Geometry::Type::kSphere:
      return makeSphere(geometry.radius_m);
    default:
      MeshPtr& mesh = meshes_[keyOf(geometry)];
      if (!mesh) mesh = loadMesh(packages_.resolve(geometry.filename), geometry.scale, packages_);
      return mesh;
  }
}

std::vector<MaterialMesh> MeshCache::partsOf(const Geometry& geometry) {
  if (geometry.type != Geometry::Type::kMesh) return {{of(geometry), Material{}}};
  std::vector<MaterialMesh>& parts = parts_[keyOf(geometry)];
  if (parts.empty()) parts = loadMaterialMeshes(packages_.resolve(geometry.filename), geometry.scale, packages_);
  return parts;
}

std::string MeshCache::keyOf(const Geometry& geometry) const {
  const Eigen::Vector3d& scale = geometry.scale;
  return packages_.resolve(geometry.filename) + ' ' + std::to_string(scale.x()) + ' ' + std::to_string(scale.y()) +
         ' ' + std::to_string(scale.z());
}

TexturePtr MeshCache::picture(const std::string& uri) {
  const std::string path = packages_.resolve(uri);
  TexturePtr& texture = textures_[path];
  if (!texture) texture = loadTexture(path);
  return texture;
}

}  // namespace aras_visual_servo_sim
