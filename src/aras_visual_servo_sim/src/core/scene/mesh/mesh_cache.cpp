#include "mesh_cache.hpp"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace aras_visual_servo_sim {
namespace {

/** The bytes of numbers that lie side by side. */
template <typename Value>
std::string_view bytesOf(const std::vector<Value>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

bool same(const TexturePtr& a, const TexturePtr& b) {
  if (!a || !b || a == b) return a == b;
  return a->name() == b->name() && a->width() == b->width() && a->height() == b->height() &&
         std::memcmp(a->texel(0, 0), b->texel(0, 0), std::size_t(3) * a->width() * a->height()) == 0;
}

bool same(const MeshPicture& a, const MeshPicture& b) {
  return a.wrap_s == b.wrap_s && a.wrap_t == b.wrap_t && same(a.texture, b.texture) && same(a.normals, b.normals);
}

bool same(const std::optional<RoundShape>& a, const std::optional<RoundShape>& b) {
  if (!a || !b) return !a && !b;
  return a->kind == b->kind && a->radius_m == b->radius_m && a->length_m == b->length_m;
}

bool same(const TriangleMesh& a, const TriangleMesh& b) {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float) && sizeof(Rgb) == 3);  // no bytes between them
  return bytesOf(a.points) == bytesOf(b.points) && bytesOf(a.normals) == bytesOf(b.normals) &&
         bytesOf(a.colors) == bytesOf(b.colors) && bytesOf(a.texture_coordinates) == bytesOf(b.texture_coordinates) &&
         bytesOf(a.triangles) == bytesOf(b.triangles) && bytesOf(a.picture_of) == bytesOf(b.picture_of) &&
         same(a.round, b.round) &&
         std::equal(a.pictures.begin(), a.pictures.end(), b.pictures.begin(), b.pictures.end(),
                    [](const MeshPicture& x, const MeshPicture& y) { return same(x, y); });
}

}  // namespace

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

MeshPtr shared(MeshPtr mesh) {
  static std::mutex mutex;
  static std::unordered_multimap<std::size_t, std::weak_ptr<const TriangleMesh>> known;
  static std::size_t cleaned_at = 64;
  const std::hash<std::string_view> hash;
  const std::size_t key = hash(bytesOf(mesh->points)) + 31 * hash(bytesOf(mesh->triangles));
  const std::lock_guard<std::mutex> lock(mutex);
  const auto [first, last] = known.equal_range(key);
  for (auto each = first; each != last; ++each) {
    MeshPtr other = each->second.lock();
    if (other && same(*other, *mesh)) return other;
  }
  if (known.size() >= cleaned_at) {
    for (auto each = known.begin(); each != known.end();) {
      each = each->second.expired() ? known.erase(each) : std::next(each);
    }
    cleaned_at = std::max<std::size_t>(64, 2 * known.size());
  }
  known.emplace(key, mesh);
  return mesh;
}

}  // namespace aras_visual_servo_sim
