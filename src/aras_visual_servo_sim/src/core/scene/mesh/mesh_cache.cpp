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
      return load(geometry.filename, geometry.scale);
  }
}

MeshPtr MeshCache::load(const std::string& uri, const Eigen::Vector3d& scale) {
  const std::string path = packages_.resolve(uri);
  MeshPtr& mesh = meshes_[path + ' ' + std::to_string(scale.x()) + ' ' + std::to_string(scale.y()) + ' ' +
                          std::to_string(scale.z())];
  if (!mesh) mesh = loadMesh(path, scale, packages_);
  return mesh;
}

TexturePtr MeshCache::picture(const std::string& uri) {
  const std::string path = packages_.resolve(uri);
  TexturePtr& texture = textures_[path];
  if (!texture) texture = loadTexture(path);
  return texture;
}

}  // namespace aras_visual_servo_sim
