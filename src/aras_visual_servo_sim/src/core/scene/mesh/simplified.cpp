#include "simplified.hpp"

#include <meshoptimizer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <vector>

namespace aras_visual_servo_sim {
namespace {

/** Along the normal of a triangle, as long as twice its area. */
Eigen::Vector3f crossOf(const TriangleMesh& mesh, const std::uint32_t* t) {
  return (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
}

/** Gives each triangle points of its own, with its own normal. */
void facet(const TriangleMesh& mesh, const std::vector<std::uint32_t>& indices, TriangleMesh& made) {
  for (std::size_t k = 0; k < indices.size(); k += 3) {
    const std::uint32_t* t = indices.data() + k;
    const Eigen::Vector3f normal = crossOf(mesh, t).normalized();
    if (normal.isZero()) continue;
    const auto first = static_cast<std::uint32_t>(made.points.size());
    for (int corner = 0; corner < 3; ++corner) {
      made.points.push_back(mesh.points[t[corner]]);
      made.normals.push_back(normal);
      if (!mesh.colors.empty()) made.colors.push_back(mesh.colors[t[0]]);
    }
    made.triangles.push_back({first, first + 1, first + 2});
  }
}

/** Of each point the first one at its place and of its colour, whatever their normals: else no crease could be
 *  straightened. @param grain_m  places closer than that are one */
std::vector<std::uint32_t> placesOf(const TriangleMesh& mesh, double grain_m) {
  std::vector<std::uint32_t> order(mesh.points.size()), place(order.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<std::array<long long, 4>> at;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Rgb color = mesh.colors.empty() ? Rgb{} : mesh.colors[i];
    const Eigen::Vector3d p = mesh.points[i].cast<double>() / grain_m;
    at.push_back(
        {std::llround(p.x()), std::llround(p.y()), std::llround(p.z()), color.r << 16 | color.g << 8 | color.b});
  }
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t k) { return at[i] < at[k]; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    place[order[k]] = k > 0 && at[order[k]] == at[order[k - 1]] ? place[order[k - 1]] : order[k];
  }
  return place;
}

/** Gives the corners of triangles points that have their normals. */
class Dresser {
 public:
  /** @param place  of each point the one that stands for all at its place */
  Dresser(const TriangleMesh& mesh, const std::vector<std::uint32_t>& place, TriangleMesh& made)
      : mesh_(mesh),
        made_(made),
        next_(mesh.points.size(), TriangleMesh::kNone),
        number_(mesh.points.size(), TriangleMesh::kNone) {
    for (std::uint32_t i = 0; i < next_.size(); ++i) {
      if (place[i] == i) continue;
      next_[i] = next_[place[i]];
      next_[place[i]] = i;
    }
  }

  /** A crease stays one: a corner gets, of the points at its place, that whose normal is nearest to the triangle's. Its
   *  own normal becomes the mean of those of its triangles, the larger counting more: that of the point, beside a
   *  rounded edge, would bend the light over all of a flat face that has few triangles left.
   *  @param narrow  the triangle may look anywhere: of the points those that others have are preferred */
  void add(const std::uint32_t* t, bool narrow) {
    const Eigen::Vector3f normal = crossOf(mesh_, t);
    std::array<std::uint32_t, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = cornerOf(t[k], normal, narrow);
    made_.triangles.push_back(corners);
  }

  /** To be called when all triangles are there. A point of narrow triangles alone keeps its own normal. */
  void finish() {
    for (std::size_t i = 0; i < number_.size(); ++i) {
      if (number_[i] == TriangleMesh::kNone) continue;
      Eigen::Vector3f& normal = made_.normals[number_[i]];
      normal.normalize();
      if (!(normal.dot(mesh_.normals[i]) > 0.0f)) normal = mesh_.normals[i];
    }
  }

 private:
  std::uint32_t cornerOf(std::uint32_t at, const Eigen::Vector3f& normal, bool narrow) {
    std::uint32_t best = TriangleMesh::kNone;
    for (const bool used : {narrow, false}) {
      for (std::uint32_t i = at; i != TriangleMesh::kNone; i = next_[i]) {
        if (used && number_[i] == TriangleMesh::kNone) continue;
        if (best == TriangleMesh::kNone || mesh_.normals[i].dot(normal) > mesh_.normals[best].dot(normal)) best = i;
      }
      if (best != TriangleMesh::kNone) break;
    }
    if (number_[best] == TriangleMesh::kNone) {
      number_[best] = static_cast<std::uint32_t>(made_.points.size());
      made_.points.push_back(mesh_.points[best]);
      made_.normals.push_back(Eigen::Vector3f::Zero());
      if (!mesh_.colors.empty()) made_.colors.push_back(mesh_.colors[best]);
    }
    if (!narrow) made_.normals[number_[best]] += normal;
    return number_[best];
  }

  const TriangleMesh& mesh_;
  TriangleMesh& made_;
  std::vector<std::uint32_t> next_;    // of the points at one place
  std::vector<std::uint32_t> number_;  // of those that the new mesh has
};

/** @param place  as of a Dresser @param width_m  of a triangle that is narrow */
void dress(const TriangleMesh& mesh, const std::vector<std::uint32_t>& indices, const std::vector<std::uint32_t>& place,
           float width_m, TriangleMesh& made) {
  const auto isNarrow = [&](const std::uint32_t* t) {
    const Eigen::Vector3f &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    const float longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    return crossOf(mesh, t).norm() < width_m * longest;
  };
  Dresser dresser(mesh, place, made);
  for (const bool narrow : {false, true}) {
    for (std::size_t k = 0; k < indices.size(); k += 3) {
      if (isNarrow(&indices[k]) == narrow) dresser.add(&indices[k], narrow);
    }
  }
  dresser.finish();
}

}  // namespace

bool isFaceted(const TriangleMesh& mesh) {
  constexpr float kSame = 1e-6f;  // of the normals: rounding
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    const auto as_first = [&](std::uint32_t i) {
      return (mesh.normals[i] - mesh.normals[t[0]]).cwiseAbs().maxCoeff() < kSame &&
             (mesh.colors.empty() || mesh.colors[i] == mesh.colors[t[0]]);
    };
    return as_first(t[1]) && as_first(t[2]);
  });
}

Simplified simplified(const TriangleMesh& mesh, double error_m) {
  constexpr double kGrain = 0.01;  // errors: what lies closer together is one place
  constexpr float kNarrow = 3.0f;  // errors wide: which way such a triangle looks is chance
  const std::vector<std::uint32_t> place = placesOf(mesh, kGrain * error_m);
  std::vector<std::uint32_t> number(place.size()), stands_for, indices;  // of the places, each of which counts once
  std::vector<Eigen::Vector3f> points;
  for (std::uint32_t i = 0; i < place.size(); ++i) {
    if (place[i] != i) continue;
    number[i] = static_cast<std::uint32_t>(points.size());
    points.push_back(mesh.points[i]);
    stands_for.push_back(i);
  }
  for (const auto& t : mesh.triangles) {
    const std::uint32_t a = number[place[t[0]]], b = number[place[t[1]]], c = number[place[t[2]]];
    if (a != b && b != c && c != a) indices.insert(indices.end(), {a, b, c});
  }
  if (indices.empty()) return {};
  const float* const positions = points.front().data();
  const float scale = meshopt_simplifyScale(positions, points.size(), sizeof(Eigen::Vector3f));
  float error = 0.0f;
  std::vector<std::uint32_t> left(indices.size());
  left.resize(meshopt_simplify(left.data(), indices.data(), indices.size(), positions, points.size(),
                               sizeof(Eigen::Vector3f), 0, static_cast<float>(error_m) / scale, 0, &error));
  if (left.empty() || left.size() > 2 * mesh.triangles.size()) return {};
  meshopt_optimizeVertexCache(left.data(), left.data(), left.size(), points.size());
  for (std::uint32_t& i : left) i = stands_for[i];
  const auto made = std::make_shared<TriangleMesh>();
  isFaceted(mesh) ? facet(mesh, left, *made) : dress(mesh, left, place, kNarrow * static_cast<float>(error_m), *made);
  made->finish();
  return {made, static_cast<double>(error) * scale};
}

}  // namespace aras_visual_servo_sim
