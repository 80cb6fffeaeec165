#include "gl_store.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <tuple>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "scene/mesh/simplified.hpp"

namespace aras_visual_servo_sim {
namespace {

struct GlVertex {
  Eigen::Vector3f position, normal;
  Eigen::Vector2f coordinates;
  std::uint8_t color[4];
};

/** Of the triangles of a mesh those that are left when all points in one cell of a grid become one of them. */
std::vector<std::uint32_t> clustered(const TriangleMesh& mesh, float cell) {
  std::map<std::array<std::int32_t, 3>, std::uint32_t> first_in;
  std::vector<std::uint32_t> stands_for(mesh.points.size());
  for (std::uint32_t i = 0; i < stands_for.size(); ++i) {
    const Eigen::Vector3i at = ((mesh.points[i] - mesh.box_min) / cell).array().floor().cast<int>();
    stands_for[i] = first_in.emplace(std::array<std::int32_t, 3>{at.x(), at.y(), at.z()}, i).first->second;
  }
  std::vector<std::uint32_t> indices;
  for (const auto& triangle : mesh.triangles) {
    const std::uint32_t a = stands_for[triangle[0]], b = stands_for[triangle[1]], c = stands_for[triangle[2]];
    if (a != b && b != c && c != a) indices.insert(indices.end(), {a, b, c});
  }
  return indices;
}

/** Whether the triangles enclose a space: along each edge as many run one way as the other. */
bool isClosed(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.points.size()), place(order.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto at = [&](std::uint32_t i) {
    const Eigen::Vector3f& p = mesh.points[i];
    return std::make_tuple(p.x(), p.y(), p.z());
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t k) { return at(i) < at(k); });
  for (std::size_t k = 0; k < order.size(); ++k) {
    place[order[k]] = k > 0 && at(order[k]) == at(order[k - 1]) ? place[order[k - 1]] : order[k];
  }
  std::vector<std::uint64_t> there, back;  // an edge: the point that it leaves, and the one that it comes to
  const auto edge = [](std::uint64_t from, std::uint64_t to) { return from << 32 | to; };
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      there.push_back(edge(place[t[k]], place[t[(k + 1) % 3]]));
      back.push_back(edge(place[t[(k + 1) % 3]], place[t[k]]));
    }
  }
  std::sort(there.begin(), there.end());
  std::sort(back.begin(), back.end());
  return there == back;
}

/** Sets normal and stretch of the triangles of a mesh that have one picture. */
void findPlane(const TriangleMesh& mesh, const std::vector<std::uint32_t>& indices, MeshPart& part) {
  constexpr float kSame = 1e-5f;  // rounding
  const std::uint32_t* const first = indices.data() + part.first;
  const Eigen::Vector3f a = mesh.points[first[1]] - mesh.points[first[0]];
  const Eigen::Vector3f b = mesh.points[first[2]] - mesh.points[first[0]];
  const Eigen::Vector3f normal = a.cross(b).normalized();
  // Columns: how the picture's coordinates change along two directions of the plane, in the triangle's own terms.
  Eigen::Matrix2d J;
  const auto changeOf = [&](const std::uint32_t* t) {
    Eigen::Matrix2d of_edges, edges;
    const Eigen::Vector3f along = a.normalized(), across = normal.cross(along);
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3f edge = mesh.points[t[k + 1]] - mesh.points[t[0]];
      edges.col(k) = Eigen::Vector2f(edge.dot(along), edge.dot(across)).cast<double>();
      of_edges.col(k) = (mesh.texture_coordinates[t[k + 1]] - mesh.texture_coordinates[t[0]]).cast<double>();
    }
    return Eigen::Matrix2d(of_edges * edges.inverse());
  };
  J = changeOf(first);
  for (GLsizei k = 0; k < part.count; k += 3) {
    const std::uint32_t* t = first + k;
    const Eigen::Vector3f own = (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
    if (!(own.normalized().dot(normal) > 1.0f - kSame)) return;
    if (!((changeOf(t) - J).norm() <= 1e-3 * J.norm())) return;
  }
  const Texture& texture = *part.picture->texture;
  J = Eigen::Vector2d(texture.width(), texture.height()).asDiagonal() * J;
  // Largest over smallest singular value.
  const double trace = J.squaredNorm(), determinant = J.determinant();
  const double root = std::sqrt(std::max(0.0, trace * trace - 4.0 * determinant * determinant));
  if (!(trace > root)) return;
  part.normal = normal;
  part.stretch = std::sqrt((trace + root) / (trace - root));
}

/** The round body that a mesh stands for, with another number of sides. */
MeshPtr withSides(const TriangleMesh& mesh, int sides) {
  const RoundShape& shape = *mesh.round;
  const MeshPtr made = shape.kind == RoundShape::Kind::kSphere     ? makeSphere(shape.radius_m, sides)
                       : shape.kind == RoundShape::Kind::kCylinder ? makeCylinder(shape.radius_m, shape.length_m, sides)
                                                                   : makeCone(shape.radius_m, shape.length_m, sides);
  return mesh.pictures.empty() ? made : withPicture(*made, mesh.pictures.front().texture);
}

/** How many sides a round body needs so that its outline is right to 0.02 px. */
int sidesOf(double radius_m, double px_per_m) {
  // A side of a circle lies radius (1 - cos(pi / sides)) inside it; on a sphere sides and rings add up.
  constexpr double kInside_px = 0.02;
  constexpr int kFewest = 32, kMost = 512;
  int sides = kFewest;
  while (sides < kMost && px_per_m * radius_m * (1.0 - std::cos(M_PI / sides)) > kInside_px) sides *= 2;
  return sides;
}

/** How far a mesh may be simplified where this many pixels are a metre: by 2^level of its size, 0: not at all. */
int levelOf(const TriangleMesh& mesh, double px_per_m) {
  constexpr double kError_px = 0.4;
  constexpr std::size_t kHeavy = 500;  // triangles: fewer are drawn as they are
  constexpr int kFinest = -16;
  if (mesh.triangles.size() < kHeavy || !mesh.pictures.empty()) return 0;
  const double level = std::floor(std::log2(kError_px / (px_per_m * 2.0 * mesh.radius())));
  return level < kFinest ? 0 : static_cast<int>(std::min(level, -3.0));
}

GLint wrapOf(Wrap wrap) {
  return wrap == Wrap::kMirror ? GL_MIRRORED_REPEAT : wrap == Wrap::kClamp ? GL_CLAMP_TO_EDGE : GL_REPEAT;
}

}  // namespace

GlStore::~GlStore() {
  for (const auto& [key, mesh] : meshes_) remove(mesh);
  for (const auto& [key, picture] : pictures_) gl_.DeleteTextures(1, &picture.name);
}

void GlStore::remove(const GlMesh& mesh) {
  gl_.DeleteBuffers(1, &mesh.vertices);
  gl_.DeleteBuffers(1, &mesh.indices);
  gl_.DeleteVertexArrays(1, &mesh.array);
  for (const auto& [level, coarse] : mesh.coarse) {
    if (!coarse.indices) continue;
    gl_.DeleteBuffers(1, &coarse.indices);
    gl_.DeleteVertexArrays(1, &coarse.array);
  }
}

void GlStore::clean() {
  std::map<const TriangleMesh*, long> kept;  // how often a mesh is here, with each number of sides
  for (const auto& [key, mesh] : meshes_) ++kept[mesh.mesh.get()];
  for (auto mesh = meshes_.begin(); mesh != meshes_.end();) {
    const TriangleMesh* key = mesh->second.mesh.get();
    if (mesh->second.mesh.use_count() > kept[key]) {
      ++mesh;
      continue;
    }
    --kept[key];
    remove(mesh->second);
    mesh = meshes_.erase(mesh);
  }
  for (auto picture = pictures_.begin(); picture != pictures_.end();) {
    if (picture->second.texture.use_count() > 1) {
      ++picture;
      continue;
    }
    gl_.DeleteTextures(1, &picture->second.name);
    picture = pictures_.erase(picture);
  }
}

const GlMesh& GlStore::meshSeen(const MeshPtr& mesh, double px_per_m) {
  if (mesh->round) return meshWith(mesh, sidesOf(mesh->radius(), px_per_m));
  const int level = levelOf(*mesh, px_per_m);
  if (level == 0) return this->mesh(mesh);
  const GlMesh& seen = meshWith(mesh, level);
  return seen.array ? seen : this->mesh(mesh);
}

GlMesh& GlStore::meshWith(const MeshPtr& mesh, int detail) {
  GlMesh& stored = meshes_[{mesh.get(), detail}];
  if (!stored.mesh) {
    stored.mesh = mesh;
    stored.serial = ++serial_;
    if (detail > 0) stored.drawn = withSides(*mesh, detail);
    if (detail < 0) {
      const Simplified fewer = simplified(*mesh, 2.0 * mesh->radius() * std::exp2(detail));
      stored.drawn = fewer.mesh;
      stored.error_m = fewer.error_m;
    }
    if (detail >= 0 || stored.drawn) upload(stored);
  }
  return stored;
}

void GlStore::upload(GlMesh& stored) {
  const TriangleMesh& mesh = stored.drawn ? *stored.drawn : *stored.mesh;
  std::vector<GlVertex> vertices(mesh.points.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Rgb color = mesh.colors.empty() ? Rgb{255, 255, 255} : mesh.colors[i];
    vertices[i] = {mesh.points[i], mesh.normals[i], Eigen::Vector2f::Zero(), {color.r, color.g, color.b, 255}};
    if (!mesh.texture_coordinates.empty()) vertices[i].coordinates = mesh.texture_coordinates[i];
  }
  const auto pictureOf = [&](std::size_t t) { return mesh.picture_of.empty() ? -1 : mesh.picture_of[t]; };
  std::vector<std::uint32_t> indices;
  for (int picture = -1; picture < static_cast<int>(mesh.pictures.size()); ++picture) {
    MeshPart part{picture < 0 ? nullptr : &mesh.pictures[picture], static_cast<GLsizei>(indices.size()), 0};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (pictureOf(t) == picture) indices.insert(indices.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
    }
    part.count = static_cast<GLsizei>(indices.size()) - part.first;
    if (part.count > 0 && part.picture) findPlane(mesh, indices, part);
    part.blocks = blocksOf(mesh, indices, part.first, part.count);
    if (part.count > 0) stored.parts.push_back(part);
  }
  stored.index_count = static_cast<GLsizei>(indices.size());
  stored.faceted = isFaceted(mesh);
  stored.closed = mesh.round || isClosed(mesh);  // all round bodies are
  gl_.GenBuffers(1, &stored.vertices);
  gl_.BindBuffer(GL_ARRAY_BUFFER, stored.vertices);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(GlVertex)), vertices.data(),
                 GL_STATIC_DRAW);
  makeArray(stored.vertices, indices, stored.array, stored.indices);
}

void GlStore::makeArray(GLuint vertices, const std::vector<std::uint32_t>& indices, GLuint& array, GLuint& buffer) {
  gl_.GenVertexArrays(1, &array);
  gl_.GenBuffers(1, &buffer);
  gl_.BindVertexArray(array);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertices);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)),
                 indices.data(), GL_STATIC_DRAW);
  const auto attribute = [&](GLuint place, GLint size, GLenum type, GLboolean normalized, std::size_t offset) {
    gl_.EnableVertexAttribArray(place);
    gl_.VertexAttribPointer(place, size, type, normalized, sizeof(GlVertex), reinterpret_cast<const void*>(offset));
  };
  attribute(0, 3, GL_FLOAT, GL_FALSE, offsetof(GlVertex, position));
  attribute(1, 3, GL_FLOAT, GL_FALSE, offsetof(GlVertex, normal));
  attribute(2, 2, GL_FLOAT, GL_FALSE, offsetof(GlVertex, coordinates));
  attribute(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(GlVertex, color));
}

GlOutline GlStore::outline(const MeshPtr& mesh, double error_m) {
  GlMesh& stored = meshWith(mesh, 0);
  const GlOutline whole{stored.array, 0, stored.index_count, stored.closed};
  constexpr int kMostLevels = 12;
  constexpr GLsizei kFew = 3 * 64;  // indices: drawn as they are
  const double diagonal = (mesh->box_max - mesh->box_min).cast<double>().norm();
  // A point moves by a cell's diagonal at most.
  const int level = static_cast<int>(std::ceil(std::log2(std::max(1.0, std::sqrt(3.0) * diagonal / error_m))));
  if (level > kMostLevels || stored.index_count < kFew) return whole;
  const auto [found, is_new] = stored.coarse.try_emplace(level);
  GlOutline& coarse = found->second;
  if (is_new) {
    const auto indices = clustered(*mesh, static_cast<float>(diagonal / std::exp2(level)));
    coarse.index_count = static_cast<GLsizei>(indices.size());
    coarse.closed = stored.closed;
    if (coarse.index_count < stored.index_count) makeArray(stored.vertices, indices, coarse.array, coarse.indices);
  }
  return coarse.indices ? coarse : whole;
}

void GlStore::bindPicture(const TexturePtr& texture, Wrap wrap_s, Wrap wrap_t, bool askew, int unit) {
  GlPicture& picture = pictures_[texture.get()];
  gl_.ActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
  if (!picture.name) {
    picture.texture = texture;
    picture.name = upload(*texture);
  } else {
    gl_.BindTexture(GL_TEXTURE_2D, picture.name);
  }
  constexpr float kAnisotropy = 16.0f;
  if (wrap_s != picture.wrap_s) gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrapOf(wrap_s));
  if (wrap_t != picture.wrap_t) gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrapOf(wrap_t));
  if (askew != picture.askew) {
    gl_.TexParameterf(GL_TEXTURE_2D, GL_TEXTURE_MAX_ANISOTROPY_EXT, askew ? kAnisotropy : 1.0f);
  }
  picture.wrap_s = wrap_s;
  picture.wrap_t = wrap_t;
  picture.askew = askew;
}

GLuint GlStore::upload(const Texture& texture) {
  GLint most = 0;
  gl_.GetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  if (texture.width() > most || texture.height() > most) {
    pictures_.erase(&texture);
    throw RenderError("renderer 'opengl': picture '" + texture.name() + "' has " + std::to_string(texture.width()) +
                      " x " + std::to_string(texture.height()) + " px, allowed up to " + std::to_string(most) +
                      " px a side");
  }
  GLuint name = 0;
  gl_.GenTextures(1, &name);
  gl_.BindTexture(GL_TEXTURE_2D, name);
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, texture.width(), texture.height(), 0, GL_RGB, GL_UNSIGNED_BYTE,
                 texture.texel(0, 0));
  gl_.GenerateMipmap(GL_TEXTURE_2D);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return name;
}

}  // namespace aras_visual_servo_sim
