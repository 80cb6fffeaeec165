#include <cmath>
#include <string>

#include "aras_visual_servo_sim/errors.hpp"
#include "aras_visual_servo_sim/mesh_loader.hpp"

namespace aras_visual_servo_sim {
namespace {

using Eigen::Vector3f;

void requirePositive(double value, const char* what) {
  if (!std::isfinite(value) || !(value > 0.0)) {
    throw ModelError(std::string(what) + ": found " + std::to_string(value) + " m, allowed finite and > 0");
  }
}

std::uint32_t addPoint(TriangleMesh& mesh, const Vector3f& point, const Vector3f& normal) {
  mesh.points.push_back(point);
  mesh.normals.push_back(normal);
  return static_cast<std::uint32_t>(mesh.points.size() - 1);
}

}  // namespace

void TriangleMesh::updateBox() {
  if (points.empty()) return;
  box_min = box_max = points.front();
  for (const Vector3f& point : points) {
    box_min = box_min.cwiseMin(point);
    box_max = box_max.cwiseMax(point);
  }
}

MeshPtr makeBox(const Eigen::Vector3d& size_m) {
  for (int i = 0; i < 3; ++i) requirePositive(size_m[i], "box size");
  auto mesh = std::make_shared<TriangleMesh>();
  const Vector3f half = 0.5f * size_m.cast<float>();
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const Vector3f normal = side * Vector3f::Unit(axis);
      const Vector3f e1 = Vector3f::Unit((axis + 1) % 3),
                     e2 = side * Vector3f::Unit((axis + 2) % 3);  // e1 x e2 = normal
      const auto corner = [&](float s1, float s2) {
        return addPoint(*mesh, (normal + s1 * e1 + s2 * e2).cwiseProduct(half), normal);
      };
      const std::uint32_t a = corner(-1, -1), b = corner(1, -1), c = corner(1, 1), d = corner(-1, 1);
      mesh->triangles.push_back({a, b, c});
      mesh->triangles.push_back({a, c, d});
    }
  }
  mesh->updateBox();
  return mesh;
}

MeshPtr makeCylinder(double radius_m, double length_m, int segments) {
  requirePositive(radius_m, "cylinder radius");
  requirePositive(length_m, "cylinder length");
  auto mesh = std::make_shared<TriangleMesh>();
  const float radius = static_cast<float>(radius_m), half = static_cast<float>(0.5 * length_m);
  const std::uint32_t bottom = addPoint(*mesh, {0, 0, -half}, {0, 0, -1});
  const std::uint32_t top = addPoint(*mesh, {0, 0, half}, {0, 0, 1});
  const std::uint32_t first = 2;
  for (int i = 0; i < segments; ++i) {
    const float angle = static_cast<float>(2.0 * M_PI * i / segments);
    const Vector3f out(std::cos(angle), std::sin(angle), 0.0f), low(0, 0, -half), high(0, 0, half);
    addPoint(*mesh, radius * out + low, out);
    addPoint(*mesh, radius * out + high, out);
    addPoint(*mesh, radius * out + low, {0, 0, -1});
    addPoint(*mesh, radius * out + high, {0, 0, 1});
    const std::uint32_t here = first + 4 * i, next = first + 4 * ((i + 1) % segments);
    mesh->triangles.push_back({here, next, next + 1});
    mesh->triangles.push_back({here, next + 1, here + 1});
    mesh->triangles.push_back({bottom, next + 2, here + 2});
    mesh->triangles.push_back({top, here + 3, next + 3});
  }
  mesh->updateBox();
  return mesh;
}

MeshPtr makeSphere(double radius_m, int segments) {
  requirePositive(radius_m, "sphere radius");
  auto mesh = std::make_shared<TriangleMesh>();
  const float radius = static_cast<float>(radius_m);
  const int rings = segments / 2;
  for (int ring = 0; ring <= rings; ++ring) {
    const double polar = M_PI * ring / rings;
    for (int i = 0; i < segments; ++i) {
      const double angle = 2.0 * M_PI * i / segments;
      const Eigen::Vector3d out(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar));
      addPoint(*mesh, radius * out.cast<float>(), out.cast<float>());
    }
  }
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < segments; ++i) {
      const std::uint32_t a = ring * segments + i, b = ring * segments + (i + 1) % segments;
      const std::uint32_t c = a + segments, d = b + segments;
      if (ring > 0) mesh->triangles.push_back({a, c, b});
      if (ring < rings - 1) mesh->triangles.push_back({b, c, d});
    }
  }
  mesh->updateBox();
  return mesh;
}

}  // namespace aras_visual_servo_sim
