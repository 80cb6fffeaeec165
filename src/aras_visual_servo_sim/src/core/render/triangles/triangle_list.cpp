#include "triangle_list.hpp"

#include <algorithm>
#include <cmath>

#include "render/view/shading.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kChord = 1e-2;  // [px] an edge seen through the lens may stray from straight
constexpr double kBias = 1e-6;   // in units of near_m / Z, 250 roundings of a float: 17 um at 0.6 m, near plane 0.02 m

Eigen::Vector3f colorOf(const Rgb& color) { return {float(color.r), float(color.g), float(color.b)}; }

/** How far the image of the middle of an edge lies beside its chord [px]. */
double bow(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& middle) {
  const Eigen::Vector2d chord = to - from, off = middle - from;
  const double length = chord.norm();
  return length > 0.0 ? std::abs(chord.x() * off.y() - chord.y() * off.x()) / length : 0.0;
}

}  // namespace

void TriangleList::begin(const CameraModel& camera, const ViewVolume& volume) {
  camera_ = &camera;
  volume_ = &volume;
  vertices_.clear();
  bodies_.clear();
  facets_.clear();
  facet_of_.clear();
  surfaces_ = 0;
}

bool TriangleList::addBodies(const Scene& scene, const Pose& X_CW) {
  const Eigen::Vector3d light_C = X_CW.q * scene.light_direction_W.normalized();
  for (const Body& body : scene.bodies) {
    if (!body.visible) continue;
    const Pose X_CB = X_CW * body.X_WB;
    for (const Shape& shape : body.shapes) {
      if (!shape.mesh->round) addShape(shape, X_CB * shape.X_BS, light_C);
    }
    bodies_.emplace_back(vertices_.size(), &body - scene.bodies.data());
  }
  return !vertices_.empty();
}

void TriangleList::addShape(const Shape& shape, const Pose& X_CS, const Eigen::Vector3d& light_C) {
  const TriangleMesh& mesh = *shape.mesh;
  const Eigen::Vector3d center = X_CS * (0.5f * (mesh.box_min + mesh.box_max)).cast<double>().eval();
  const double radius = 0.5 * (mesh.box_max - mesh.box_min).cast<double>().norm();
  cells_.clear();
  for (const ViewCell& cell : volume_->cells()) {
    if (cell.excludes(center, radius) || cell.depth(center) - radius > camera_->farM()) continue;
    cells_.emplace_back(&cell, cell.contains(center, radius));
  }
  if (cells_.empty()) return;
  const Eigen::Matrix3d R = X_CS.q.toRotationMatrix();
  std::array<Eigen::Vector3d, 8> box;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3f corner(k & 1 ? mesh.box_max.x() : mesh.box_min.x(),
                                 k & 2 ? mesh.box_max.y() : mesh.box_min.y(),
                                 k & 4 ? mesh.box_max.z() : mesh.box_min.z());
    box[k] = X_CS.p + R * corner.cast<double>();
  }
  cells_.erase(std::remove_if(cells_.begin(), cells_.end(),
                              [&box](const auto& each) { return each.first->excludes(box.data(), box.size()); }),
               cells_.end());
  if (cells_.empty()) return;
  points_.clear();
  colors_.clear();
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    points_.push_back(X_CS.p + R * mesh.points[i].cast<double>());
    const auto light = static_cast<float>(litShare(R * mesh.normals[i].cast<double>(), light_C, points_.back()));
    colors_.push_back(light * colorOf(mesh.colors.empty() ? shape.color : mesh.colors[i]));
  }
  drawn_.assign(mesh.triangles.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [i, j, k] = mesh.triangles[t];
    const Points points{points_[i], points_[j], points_[k]};
    const bool faces_away = (points[1] - points[0]).cross(points[2] - points[0]).dot(points[0]) >= 0.0;
    drawn_[t] = !faces_away && std::any_of(cells_.begin(), cells_.end(),
                                           [&](const auto& each) { return isSeen(points, *each.first, each.second); });
  }
  Facet facet;
  facet.surface = surfaces_++;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!drawn_[t]) continue;
    const auto& [i, j, k] = mesh.triangles[t];
    facet.rgb = {colors_[i], colors_[j], colors_[k]};
    facet.one_color = colors_[i] == colors_[j] && colors_[i] == colors_[k];
    const std::int32_t picture = mesh.picture_of.empty() ? -1 : mesh.picture_of[t];
    facet.texture = picture < 0 ? nullptr : &mesh.pictures[picture];
    if (facet.texture) {
      const Eigen::Vector2d size(facet.texture->texture->width(), facet.texture->texture->height());
      const std::array<std::uint32_t, 3> corners{i, j, k};
      for (int e = 0; e < 3; ++e) {
        facet.texels[e] = mesh.texture_coordinates[corners[e]].cast<double>().cwiseProduct(size);
      }
    }
    Seams seams;
    for (int e = 0; e < 3; ++e) {
      const std::uint32_t beyond = mesh.neighbours[t][e];
      seams[e] = beyond != TriangleMesh::kNone && drawn_[beyond];
    }
    const Points points{points_[i], points_[j], points_[k]};
    for (const auto& [cell, inside] : cells_) {
      if (isSeen(points, *cell, inside)) addTriangle(points, seams, *cell, inside, facet);
    }
  }
}

void TriangleList::addPlanar(const PlanarLayer& planar, const Pose& X_CW) {
  std::size_t index = 0;
  for (const PlanarLayer::Face& face : planar.faces()) {
    const Pose X_CM = X_CW * face.model->X_WM;
    Facet facet;
    facet.planar = facet.one_color = true;
    facet.picture = face.picture;
    facet.surface = surfaces_++;
    facet.bias = kBias * static_cast<double>(++index);
    facet.rgb.fill(colorOf(face.color));
    cells_.clear();
    for (const ViewCell& cell : volume_->cells()) {
      cells_.emplace_back(&cell, cell.contains(X_CM.p, face.model->radius()));
    }
    const auto add = [&](const Polygon& polygon, const std::array<std::uint32_t, 3>& triangle) {
      Points points;
      Seams seams;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t here = triangle[k], next = triangle[(k + 1) % 3];
        points[k] = X_CM * Eigen::Vector3d(polygon[here].x(), polygon[here].y(), 0.0);
        seams[k] = (here + 1) % polygon.size() != next && (next + 1) % polygon.size() != here;
      }
      for (const auto& [cell, inside] : cells_) {
        if (inside || !cell->excludes(points.data(), points.size())) addTriangle(points, seams, *cell, inside, facet);
      }
    };
    if (face.kind != PlanarLayer::Face::Kind::kOutlines) {
      const Polygon corners = face.picture >= 0 ? face.model->pictureCorners() : face.model->boardCorners();
      add(corners, {0, 1, 2});
      add(corners, {0, 2, 3});
      continue;
    }
    for (std::size_t k = 0; k < face.model->outlines().size(); ++k) {
      for (const auto& triangle : face.model->triangles(k)) add(face.model->outlines()[k], triangle);
    }
  }
}

/** Whether some of a body's triangle may be seen in a cell. */
bool TriangleList::isSeen(const Points& points, const ViewCell& cell, bool inside) const {
  if (std::min({cell.depth(points[0]), cell.depth(points[1]), cell.depth(points[2])}) > camera_->farM()) return false;
  return inside || !cell.excludes(points.data(), points.size());
}

void TriangleList::addTriangle(const Points& points_C, const Seams& seams, const ViewCell& cell, bool inside,
                               Facet facet) {
  if (!facet.place(points_C)) return;
  cell_ = &cell;
  const std::size_t first = vertices_.size();
  if (inside) {
    cut({corner(points_C[0]), corner(points_C[1]), corner(points_C[2])}, seams, 0);
  } else {
    polygon_.assign(points_C.begin(), points_C.end());
    cell.clip(polygon_);
    if (polygon_.size() < 3) return;
    corners_.clear();
    for (const Eigen::Vector3d& p : polygon_) corners_.push_back(corner(p));
    for (std::size_t i = 2; i < corners_.size(); ++i) {
      // What became of the triangle's own edges is not known: none of them is a seam.
      cut({corners_[0], corners_[i - 1], corners_[i]}, {i > 2, false, i + 1 < corners_.size()}, 0);
    }
  }
  facets_.push_back(facet);
  facet_of_.insert(facet_of_.end(), (vertices_.size() - first) / 3, static_cast<std::uint32_t>(facets_.size() - 1));
}

TriangleList::Corner TriangleList::corner(const Eigen::Vector3d& p_C) const {
  const Eigen::Vector2d xy = cell_->across(p_C) / cell_->depth(p_C);
  return {xy, cell_->toPixel(*camera_, xy)};
}

/** How far the middle of an edge lies off its chord [px]; long edges through the fisheye are bent whatever that says.
 */
double TriangleList::bend(const Corner& from, const Corner& to, const Eigen::Vector2d& middle_px) const {
  if (camera_->lens() == CameraModel::Lens::kEquidistant && (to.xy - from.xy).norm() > ViewCell::kLongest) {
    return (to.px - from.px).norm();
  }
  return bow(from.px, to.px, middle_px);
}

/** Halves the most bent edge until none is bent. Each decision depends on that edge alone, so the triangles on both
 *  sides of an edge are cut alike and leave no gap. */
void TriangleList::cut(const std::array<Corner, 3>& corners, const Seams& seams, int depth) {
  const int deepest = camera_->lens() == CameraModel::Lens::kEquidistant ? 24 : 16;
  if (camera_->lens() != CameraModel::Lens::kNone && depth < deepest) {
    double worst = kChord;
    int split = -1;
    Corner middle;
    for (int k = 0; k < 3; ++k) {
      const Corner &from = corners[k], &to = corners[(k + 1) % 3];
      const Eigen::Vector2d xy = 0.5 * (from.xy + to.xy);
      const Eigen::Vector2d px = cell_->toPixel(*camera_, xy);
      const double bent = bend(from, to, px);
      if (bent <= worst) continue;
      worst = bent;
      split = k;
      middle = {xy, px};
    }
    if (split >= 0) {
      const int next = (split + 1) % 3, apex = (split + 2) % 3;
      cut({corners[split], middle, corners[apex]}, {seams[split], true, seams[apex]}, depth + 1);
      cut({middle, corners[next], corners[apex]}, {seams[split], seams[next], true}, depth + 1);
      return;
    }
  }
  for (int k = 0; k < 3; ++k) {
    vertices_.push_back(
        {static_cast<float>(corners[k].px.x() + 0.5), static_cast<float>(corners[k].px.y() + 0.5), seams[k]});
  }
}

}  // namespace aras_visual_servo_sim
