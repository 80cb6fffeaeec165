#include "triangle_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/view/pixel_box.hpp"
#include "render/view/shading.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kChord = 0.5;   // [px] an edge may stray from straight where only the tiles it touches matter
constexpr double kMargin = 1.5;  // [px] by which tiles are taken to be larger: for that, and for inflexions
constexpr double kShort = 4.0, kShortMargin = 0.25;  // [px] an edge so short bends by less, of any lens that can be had
constexpr double kBias = 1e-6;  // in units of near_m / Z, 250 roundings of a float: 17 um at 0.6 m, near plane 0.02 m

Eigen::Vector3f colorOf(const Rgb& color) { return {float(color.r), float(color.g), float(color.b)}; }

/** A point of the image from its upper left corner, where floor() gives the pixel, however far outside [px]. */
Eigen::Array2d placed(const Eigen::Vector2d& px) {
  constexpr double kFar = 1e9;
  return {held(px.x() + 0.5, -kFar, kFar), held(px.y() + 0.5, -kFar, kFar)};
}

/** How far the image of the middle of an edge lies beside its chord [px]. */
double bow(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& middle) {
  const Eigen::Vector2d chord = to - from, off = middle - from;
  const double length = chord.norm();
  return length > 0.0 ? std::abs(chord.x() * off.y() - chord.y() * off.x()) / length : 0.0;
}

}  // namespace

void TriangleList::begin(const CameraModel& camera, const ViewVolume& volume, bool lit) {
  lit_ = lit;
  camera_ = &camera;
  volume_ = &volume;
  vertices_.clear();
  bodies_.clear();
  facets_.clear();
  planes_.clear();
  facet_of_.clear();
  spans_.clear();
  extents_.clear();
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
    bodies_.emplace_back(size(), &body - scene.bodies.data());
  }
  return size() > 0;
}

void TriangleList::addShape(const Shape& shape, const Pose& X_CS, const Eigen::Vector3d& light_C) {
  const TriangleMesh& mesh = *shape.mesh;
  const Eigen::Vector3d center = X_CS * mesh.center();
  const double radius = mesh.radius();
  cells_.clear();
  for (const ViewCell& cell : *volume_) {
    if (cell.excludes(center, radius) || cell.depth(center) - radius > camera_->farM()) continue;
    cells_.emplace_back(&cell, cell.contains(center, radius));
  }
  if (cells_.empty()) return;
  const Eigen::Matrix3d R = X_CS.q.toRotationMatrix();
  std::array<Eigen::Vector3d, 8> box;
  for (int k = 0; k < 8; ++k) box[k] = X_CS.p + R * mesh.corner(k);
  cells_.erase(std::remove_if(cells_.begin(), cells_.end(),
                              [&box](const auto& each) { return each.first->excludes(box.data(), box.size()); }),
               cells_.end());
  if (cells_.empty()) return;
  points_.clear();
  colors_.clear();
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    points_.push_back(X_CS.p + R * mesh.points[i].cast<double>());
    if (!lit_) continue;
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
    if (!hasFacets()) {
      addPlane({points_[i], points_[j], points_[k]});
      continue;
    }
    if (lit_) {
      facet.rgb = {colors_[i], colors_[j], colors_[k]};
      facet.one_color = colors_[i] == colors_[j] && colors_[i] == colors_[k];
    }
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
    addTriangle(points, seams, facet);
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
    for (const ViewCell& cell : *volume_) {
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
      addTriangle(points, seams, facet);
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

void TriangleList::addTriangle(const Points& points_C, const Seams& seams, const Facet& of) {
  facets_.push_back(of);
  Facet& facet = facets_.back();
  facet.seams = seams;
  const bool placed = isFlat() ? facet.place(points_C) : facet.placeWithEdges(points_C);
  const std::size_t count = placed ? addSeen(points_C, facet) : 0;
  if (count == 0) {
    facets_.pop_back();
    return;
  }
  if (!isFlat()) extents_.push_back(extent_);
  facet_of_.insert(facet_of_.end(), count, static_cast<std::uint32_t>(facets_.size() - 1));
}

/** Adds a triangle of which only the place is wanted. */
void TriangleList::addPlane(const Points& points_C) {
  const Eigen::Vector3d normal = (points_C[1] - points_C[0]).cross(points_C[2] - points_C[0]);
  const double offset = normal.dot(points_C[0]);
  constexpr double kLeast = 1e-100;  // its inverse, and products with it, stay finite
  if (!(std::abs(offset) > kLeast)) return;
  static const Facet plain;
  planes_.insert(planes_.end(), addSeen(points_C, plain), normal / offset);
}

/** Adds the vertices or spans of a triangle as it is seen in cells_. @return number of triangles */
std::size_t TriangleList::addSeen(const Points& points_C, const Facet& facet) {
  const std::size_t first_vertex = vertices_.size(), first_span = spans_.size();
  constexpr int kMost = std::numeric_limits<int>::max(), kLeast = std::numeric_limits<int>::min();
  extent_ = {kMost, kMost, kLeast, kLeast};
  for (const auto& [cell, inside] : cells_) {
    const bool seen =
        facet.planar ? inside || !cell->excludes(points_C.data(), points_C.size()) : isSeen(points_C, *cell, inside);
    if (!seen) continue;
    cell_ = cell;
    polygon_.assign(points_C.begin(), points_C.end());
    polygon_seams_.assign(facet.seams.begin(), facet.seams.end());
    if (!inside) cell->clip(polygon_, &polygon_seams_);
    if (polygon_.size() < 3) continue;
    corners_.clear();
    for (const Eigen::Vector3d& p : polygon_) corners_.push_back(corner(p));
    if (!isFlat()) {
      addSpans();
    } else if (inside) {
      addVertices({corners_[0], corners_[1], corners_[2]}, facet.seams);
    } else {
      const auto seam = [this](std::size_t k) { return polygon_seams_[k] != 0; };
      for (std::size_t i = 2; i < corners_.size(); ++i) {
        addVertices({corners_[0], corners_[i - 1], corners_[i]},
                    {i > 2 || seam(0), seam(i - 1), i + 1 < corners_.size() || seam(i)});
      }
    }
  }
  return isFlat() ? (vertices_.size() - first_vertex) / 3 : spans_.size() > first_span ? 1 : 0;
}

TriangleList::Corner TriangleList::corner(const Eigen::Vector3d& p_C) const {
  const Eigen::Vector2d xy = cell_->across(p_C) / cell_->depth(p_C);
  return {xy, cell_->toPixel(*camera_, xy)};
}

void TriangleList::addVertices(const std::array<Corner, 3>& corners, const Seams& seams) {
  for (int k = 0; k < 3; ++k) {
    vertices_.push_back(
        {static_cast<float>(corners[k].px.x() + 0.5), static_cast<float>(corners[k].px.y() + 0.5), seams[k]});
  }
}

/** Of the triangle to come, row by row: what lies between the leftmost and the rightmost point of its outline. */
void TriangleList::addSpans() {
  constexpr int kTile = CameraModel::kBlock;
  const int rows = (camera_->height() + kTile - 1) / kTile, columns = (camera_->width() + kTile - 1) / kTile;
  const double infinity = std::numeric_limits<double>::infinity();
  low_.setConstant(infinity);
  high_.setConstant(-infinity);
  bool is_short = true;
  for (std::size_t i = 0, j = corners_.size() - 1; i < corners_.size(); j = i++) {
    is_short = is_short && (corners_[i].px - corners_[j].px).squaredNorm() < kShort * kShort;
  }
  margin_ = is_short ? kShortMargin : kMargin;
  if (is_short && addSpanOfOneRow(rows, columns)) return;
  rows_.assign(static_cast<std::size_t>(rows), {infinity, -infinity});
  first_row_ = rows;
  last_row_ = 0;
  for (std::size_t i = 0, j = corners_.size() - 1; i < corners_.size(); j = i++) {
    if (is_short) {
      widenRows(corners_[j].px, corners_[i].px);
    } else {
      bendEdge(corners_[j], corners_[i], 0);
    }
  }
  widenExtent(margin_);
  const auto triangle = static_cast<std::uint32_t>(size());
  for (int row = first_row_; row < last_row_; ++row) {
    const auto& [low, high] = rows_[row];
    const int first = static_cast<int>(held(std::floor((low - margin_) / kTile), 0.0, double(columns)));
    const int last = static_cast<int>(held(std::floor((high + margin_) / kTile) + 1.0, 0.0, double(columns)));
    if (first < last) spans_.emplace_back() = {triangle, row, first, last};
  }
}

/** As addSpans, of an outline of short edges that lies in one row of tiles, as most of a mesh's triangles do: no need
 * to follow its edges. @return false if it lies in several */
bool TriangleList::addSpanOfOneRow(int rows, int columns) {
  constexpr double kTile = CameraModel::kBlock;
  for (const Corner& corner : corners_) {
    const Eigen::Array2d place = placed(corner.px);
    low_ = low_.min(place);
    high_ = high_.max(place);
  }
  const double row = std::floor((low_.y() - margin_) / kTile);
  if (row != std::floor((high_.y() + margin_) / kTile)) return false;
  widenExtent(margin_);
  if (row < 0.0 || row >= rows) return true;
  const int first = static_cast<int>(held(std::floor((low_.x() - margin_) / kTile), 0.0, double(columns)));
  const int last = static_cast<int>(held(std::floor((high_.x() + margin_) / kTile) + 1.0, 0.0, double(columns)));
  const auto triangle = static_cast<std::uint32_t>(size());
  if (first < last) spans_.emplace_back() = {triangle, static_cast<int>(row), first, last};
  return true;
}

void TriangleList::widenExtent(double margin) {
  const Eigen::Array2i first = (low_ - margin).floor().cast<int>(), last = (high_ + margin).floor().cast<int>() + 1;
  extent_ = {std::min(extent_.u0, first.x()), std::min(extent_.v0, first.y()), std::max(extent_.u1, last.x()),
             std::max(extent_.v1, last.y())};
}

/** Halves an edge until its image is about straight. */
void TriangleList::bendEdge(const Corner& from, const Corner& to, int depth) {
  constexpr int kDeepest = 10;
  const Eigen::Vector2d xy = 0.5 * (from.xy + to.xy);
  const Corner middle{xy, cell_->toPixel(*camera_, xy)};
  const bool lengthy =
      camera_->lens() == CameraModel::Lens::kEquidistant && (to.xy - from.xy).norm() > ViewCell::kLongest;
  if (depth >= kDeepest || (!lengthy && !(bow(from.px, to.px, middle.px) > kChord))) {
    widenRows(from.px, middle.px);
    widenRows(middle.px, to.px);
    return;
  }
  bendEdge(from, middle, depth + 1);
  bendEdge(middle, to, depth + 1);
}

/** Notes the columns of a piece of an outline in the rows of tiles that it may touch. */
void TriangleList::widenRows(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  constexpr double kTile = CameraModel::kBlock;
  const Eigen::Array2d a_px = placed(from), b_px = placed(to);
  low_ = low_.min(a_px.min(b_px));
  high_ = high_.max(a_px.max(b_px));
  double x0 = a_px.x(), y0 = a_px.y(), x1 = b_px.x(), y1 = b_px.y();
  if (y0 > y1) {
    std::swap(x0, x1);
    std::swap(y0, y1);
  }
  const auto rows = static_cast<double>(rows_.size());
  const int first = static_cast<int>(held(std::floor((y0 - margin_) / kTile), 0.0, rows));
  const int last = static_cast<int>(held(std::floor((y1 + margin_) / kTile) + 1.0, 0.0, rows));
  first_row_ = std::min(first_row_, first);
  last_row_ = std::max(last_row_, last);
  for (int row = first; row < last; ++row) {
    const double top = held(row * kTile - margin_, y0, y1), bottom = held((row + 1) * kTile + margin_, y0, y1);
    const double slope = y1 > y0 ? (x1 - x0) / (y1 - y0) : 0.0;
    const double a = y1 > y0 ? x0 + (top - y0) * slope : x0, b = y1 > y0 ? x0 + (bottom - y0) * slope : x1;
    auto& [low, high] = rows_[row];
    low = std::min({low, a, b});
    high = std::max({high, a, b});
  }
}

}  // namespace aras_visual_servo_sim
