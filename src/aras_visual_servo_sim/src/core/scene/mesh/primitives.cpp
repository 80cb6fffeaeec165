#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim {
namespace {

using Eigen::Vector3f;

void requirePositive(double value, const std::string& what) {
  if (!std::isfinite(value) || !(value > 0.0)) {
    throw ModelError(what + ": found " + std::to_string(value) + " m, allowed finite and > 0");
  }
}

std::uint32_t addPoint(TriangleMesh& mesh, const Vector3f& point, const Vector3f& normal) {
  mesh.points.push_back(point);
  mesh.normals.push_back(normal);
  return static_cast<std::uint32_t>(mesh.points.size() - 1);
}

void mendNormals(TriangleMesh& mesh) {
  std::vector<Vector3f>& normals = mesh.normals;
  normals.resize(mesh.points.size(), Vector3f::Zero());
  const auto good = [](const Vector3f& n) { return n.allFinite() && n.squaredNorm() > 0.25f; };
  if (std::all_of(normals.begin(), normals.end(), good)) return;
  std::vector<Vector3f> sums(normals.size(), Vector3f::Zero());
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vector3f area = (mesh.points[j] - mesh.points[i]).cross(mesh.points[k] - mesh.points[i]);
    for (const std::uint32_t corner : {i, j, k}) sums[corner] += area;
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (good(normals[i])) continue;
    normals[i] = sums[i].norm() > 0.0f ? Vector3f(sums[i].normalized()) : Vector3f(Vector3f::UnitZ());
  }
}

/** A side of a triangle. */
struct Edge {
  std::uint32_t low, high, triangle, corner;
  bool operator<(const Edge& other) const {
    return std::tie(low, high, triangle, corner) < std::tie(other.low, other.high, other.triangle, other.corner);
  }
  bool joins(const Edge& other) const { return low == other.low && high == other.high; }
};

/** The sides of the triangles, in an order that puts those that join the same points one after the other. Counting how
 *  many sides have each lower point gives them their places, and only the few that share one are sorted. */
std::vector<Edge> sortedEdges(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> end(mesh.points.size() + 1, 0u);
  const auto visit = [&mesh](const auto& see) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
        see(Edge{low, high, t, k});
      }
    }
  };
  visit([&end](const Edge& edge) { ++end[edge.low + 1]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<Edge> edges(3 * mesh.triangles.size());
  visit([&](const Edge& edge) { edges[end[edge.low]++] = edge; });
  std::size_t first = 0;
  for (std::size_t point = 0; point < mesh.points.size(); first = end[point++]) {
    std::sort(edges.begin() + first, edges.begin() + end[point]);
  }
  return edges;
}

void findNeighbours(TriangleMesh& mesh) {
  const std::vector<Edge> edges = sortedEdges(mesh);
  mesh.neighbours.assign(mesh.triangles.size(), {TriangleMesh::kNone, TriangleMesh::kNone, TriangleMesh::kNone});
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    if (!edges[i].joins(edges[i + 1])) continue;
    const bool first = i == 0 || !edges[i].joins(edges[i - 1]);
    const bool last = i + 2 >= edges.size() || !edges[i].joins(edges[i + 2]);
    if (!first || !last) continue;  // more than two triangles meet
    mesh.neighbours[edges[i].triangle][edges[i].corner] = edges[i + 1].triangle;
    mesh.neighbours[edges[i + 1].triangle][edges[i + 1].corner] = edges[i].triangle;
  }
}

/** A cylinder or a cone. The picture goes once round the side, clockwise seen from +z, from +y on, its top at the
 *  bottom: Gazebo's. The ends show the disc in the middle of it, as seen from outside with the picture's top at +y. */
MeshPtr makeRoundBar(RoundShape::Kind kind, const std::string& name, double radius_m, double length_m, int segments) {
  requirePositive(radius_m, name + " radius");
  requirePositive(length_m, name + " length");
  const bool cone = kind == RoundShape::Kind::kCone;
  auto mesh = std::make_shared<TriangleMesh>();
  const float radius = static_cast<float>(radius_m), half = static_cast<float>(0.5 * length_m);
  const Vector3f low(0, 0, -half), high(0, 0, half);
  const auto add = [&mesh](const Vector3f& point, const Vector3f& normal, float s, float t) {
    mesh->texture_coordinates.emplace_back(s, t);
    return addPoint(*mesh, point, normal);
  };
  const std::uint32_t bottom = add(low, {0, 0, -1}, 0.5f, 0.5f);
  const std::uint32_t top = cone ? 0 : add(high, {0, 0, 1}, 0.5f, 0.5f);
  for (int i = 0; i <= segments; ++i) {  // the last ones lie on the first, at the picture's other edge
    const float turn = static_cast<float>(i) / static_cast<float>(segments);
    const float angle = static_cast<float>(2.0 * M_PI * (i % segments) / segments);
    const Vector3f out(std::cos(angle), std::sin(angle), 0.0f);
    const Vector3f normal = cone ? Vector3f((2.0f * half * out + radius * Vector3f::UnitZ()).normalized()) : out;
    const Vector3f end = cone ? high : Vector3f(radius * out + high);
    const std::uint32_t here = add(radius * out + low, normal, 0.25f - turn, 0.0f);
    add(end, normal, 0.25f - turn, 1.0f);
    add(radius * out + low, {0, 0, -1}, 0.5f - 0.5f * out.x(), 0.5f - 0.5f * out.y());
    if (!cone) add(end, {0, 0, 1}, 0.5f + 0.5f * out.x(), 0.5f - 0.5f * out.y());
    if (i == segments) break;
    const std::uint32_t next = here + (cone ? 3 : 4);
    mesh->triangles.push_back({here, next, cone ? here + 1 : next + 1});
    if (!cone) mesh->triangles.push_back({here, next + 1, here + 1});
    mesh->triangles.push_back({bottom, next + 2, here + 2});
    if (!cone) mesh->triangles.push_back({top, here + 3, next + 3});
  }
  mesh->round = {kind, radius_m, length_m};
  mesh->finish();
  return mesh;
}

}  // namespace

void TriangleMesh::finish() {
  mendNormals(*this);
  findNeighbours(*this);
  if (points.empty()) return;
  box_min = box_max = points.front();
  for (const Vector3f& point : points) {
    box_min = box_min.cwiseMin(point);
    box_max = box_max.cwiseMax(point);
  }
}

/** Faces carry the picture upright, +z up; the top face has its top at +x, the bottom face at -x, as in Gazebo. */
MeshPtr makeBox(const Eigen::Vector3d& size_m) {
  for (int i = 0; i < 3; ++i) requirePositive(size_m[i], "box size");
  auto mesh = std::make_shared<TriangleMesh>();
  const Vector3f half = 0.5f * size_m.cast<float>();
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const Vector3f normal = side * Vector3f::Unit(axis);
      const Vector3f e1 = Vector3f::Unit((axis + 1) % 3),
                     e2 = side * Vector3f::Unit((axis + 2) % 3);  // e1 x e2 = normal
      const Vector3f up = axis == 2 ? Vector3f(side * Vector3f::UnitX()) : Vector3f::UnitZ(), right = up.cross(normal);
      const auto corner = [&](float s1, float s2) {
        const Vector3f p = normal + s1 * e1 + s2 * e2;
        mesh->texture_coordinates.emplace_back(0.5f * (1.0f + p.dot(right)), 0.5f * (1.0f - p.dot(up)));
        return addPoint(*mesh, p.cwiseProduct(half), normal);
      };
      const std::uint32_t a = corner(-1, -1), b = corner(1, -1), c = corner(1, 1), d = corner(-1, 1);
      mesh->triangles.push_back({a, b, c});
      mesh->triangles.push_back({a, c, d});
    }
  }
  mesh->finish();
  return mesh;
}

MeshPtr makeCylinder(double radius_m, double length_m, int segments) {
  return makeRoundBar(RoundShape::Kind::kCylinder, "cylinder", radius_m, length_m, segments);
}

MeshPtr makeCone(double radius_m, double length_m, int segments) {
  return makeRoundBar(RoundShape::Kind::kCone, "cone", radius_m, length_m, segments);
}

/** The picture goes once round, counter-clockwise seen from +z, from +x on, its top at +z. */
MeshPtr makeSphere(double radius_m, int segments) {
  requirePositive(radius_m, "sphere radius");
  auto mesh = std::make_shared<TriangleMesh>();
  const float radius = static_cast<float>(radius_m);
  const int rings = segments / 2, columns = segments + 1;
  for (int ring = 0; ring <= rings; ++ring) {
    const double polar = M_PI * ring / rings;
    for (int i = 0; i < columns; ++i) {
      const double angle = 2.0 * M_PI * (i % segments) / segments;
      const Eigen::Vector3d out(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar));
      addPoint(*mesh, radius * out.cast<float>(), out.cast<float>());
      mesh->texture_coordinates.emplace_back(float(i) / float(segments), float(ring) / float(rings));
    }
  }
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < segments; ++i) {
      const std::uint32_t a = ring * columns + i, b = a + 1, c = a + columns, d = b + columns;
      if (ring > 0) mesh->triangles.push_back({a, c, b});
      if (ring < rings - 1) mesh->triangles.push_back({b, c, d});
    }
  }
  mesh->round = {RoundShape::Kind::kSphere, radius_m, 0.0};
  mesh->finish();
  return mesh;
}

MeshPtr withPicture(const TriangleMesh& mesh, const TexturePtr& texture,
                    const std::optional<TextureTransform>& transform) {
  if (mesh.texture_coordinates.size() != mesh.points.size()) {
    throw ModelError("picture '" + texture->name() + "': its mesh has no texture coordinates");
  }
  auto pictured = std::make_shared<TriangleMesh>(mesh);
  pictured->colors.clear();
  pictured->pictures = {{texture, Wrap::kRepeat, Wrap::kRepeat}};
  pictured->picture_of.assign(mesh.triangles.size(), 0);
  if (transform) {
    const Eigen::Matrix<float, 2, 3> A = transform->cast<float>();
    for (Eigen::Vector2f& point : pictured->texture_coordinates) point = A * point.homogeneous();
    pictured->round.reset();  // what is drawn from an equation has the coordinates of its kind
  }
  return pictured;
}

}  // namespace aras_visual_servo_sim
