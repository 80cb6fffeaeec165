#include "triangle_list.hpp"

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kChord = 1e-2;  // [px] an edge seen through the lens may stray from straight
constexpr double kBias =
    1e-6;  // in units of Vertex::z, 16 steps of the depth buffer: 17 um at 0.6 m, near plane 0.02 m

// Objects are told apart by numbers of one byte: 0 the background, 1 .. 64 pictures, 65 .. 128 other faces of planar
// models, 129 .. 255 bodies' shapes, over again when there are more.
std::uint8_t faceNumber(std::size_t index) { return static_cast<std::uint8_t>(65 + index % 64); }
std::uint8_t shapeNumber(std::size_t index) { return static_cast<std::uint8_t>(129 + index % 127); }

Eigen::Vector3f colorOf(const Rgb& color) { return {float(color.r), float(color.g), float(color.b)}; }

/** Lambert's law for a light from afar and a weak one at the camera, over an ambient term. */
float shade(const Eigen::Vector3d& normal_C, const Eigen::Vector3d& light_C, const Eigen::Vector3d& p_C) {
  constexpr double kAmbient = 0.38, kLight = 0.50, kHeadlight = 0.22;
  const double lit = std::max(0.0, -normal_C.dot(light_C));
  const double head = std::max(0.0, -normal_C.dot(p_C) / (p_C.norm() + 1e-12));
  return static_cast<float>(std::min(1.0, kAmbient + kLight * lit + kHeadlight * head));
}

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
  planes_.clear();
  plane_of_.clear();
}

bool TriangleList::addBodies(const Scene& scene, const Pose& X_CW) {
  const Eigen::Vector3d light_C = X_CW.q * scene.light_direction_W.normalized();
  std::size_t index = 0;
  for (const Body& body : scene.bodies) {
    if (!body.visible) continue;
    const Pose X_CB = X_CW * body.X_WB;
    for (const Shape& shape : body.shapes) addShape(shape, X_CB * shape.X_BS, light_C, shapeNumber(index++));
    bodies_.emplace_back(vertices_.size(), &body - scene.bodies.data());
  }
  return !vertices_.empty();
}

void TriangleList::addShape(const Shape& shape, const Pose& X_CS, const Eigen::Vector3d& light_C, std::uint8_t number) {
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
    const float light = shade(R * mesh.normals[i].cast<double>(), light_C, points_.back());
    colors_.push_back(light * colorOf(mesh.colors.empty() ? shape.color : mesh.colors[i]));
  }
  for (const auto& [i, j, k] : mesh.triangles) {
    const Points points{points_[i], points_[j], points_[k]};
    const bool faces_away = (points[1] - points[0]).cross(points[2] - points[0]).dot(points[0]) >= 0.0;
    if (faces_away) continue;
    const std::size_t before = vertices_.size();
    for (const auto& [cell, inside] : cells_) {
      if (std::min({cell->depth(points[0]), cell->depth(points[1]), cell->depth(points[2])}) > camera_->farM())
        continue;
      if (!inside && cell->excludes(points.data(), points.size())) continue;
      addTriangle(points, {colors_[i], colors_[j], colors_[k]}, *cell, inside, number, 0.0);
    }
    if (vertices_.size() == before) continue;
    const Eigen::Vector3d normal = (points[1] - points[0]).cross(points[2] - points[0]);
    planes_.push_back(normal / normal.dot(points[0]));
    plane_of_.resize(vertices_.size() / 3, static_cast<std::uint32_t>(planes_.size() - 1));
  }
}

void TriangleList::addPlanar(const PlanarLayer& planar, const Pose& X_CW) {
  if (planar.pictures().size() > std::size_t(kMostPictures)) {
    throw RenderError("planar models with images in view: found " + std::to_string(planar.pictures().size()) +
                      ", allowed " + std::to_string(kMostPictures) + " where bodies are in view too");
  }
  std::size_t index = 0;
  for (const PlanarLayer::Face& face : planar.faces()) {
    const Pose X_CM = X_CW * face.model->X_WM;
    const double bias = kBias * static_cast<double>(index + 1) + slack(X_CM) * static_cast<double>(face.rank);
    const bool is_picture = face.kind == PlanarLayer::Face::Kind::kPicture;
    const std::uint8_t number = is_picture ? pictureNumber(face.picture) : faceNumber(index);
    ++index;
    const Eigen::Vector3f rgb = is_picture ? Eigen::Vector3f::Zero() : colorOf(face.color);
    cells_.clear();
    for (const ViewCell& cell : volume_->cells()) {
      cells_.emplace_back(&cell, cell.contains(X_CM.p, face.model->radius()));
    }
    const auto add = [&](const Polygon& polygon, const std::array<std::uint32_t, 3>& triangle) {
      Points points;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector2d& p = polygon[triangle[k]];
        points[k] = X_CM * Eigen::Vector3d(p.x(), p.y(), 0.0);
      }
      for (const auto& [cell, inside] : cells_) {
        if (!inside && cell->excludes(points.data(), points.size())) continue;
        addTriangle(points, {rgb, rgb, rgb}, *cell, inside, number, bias);
      }
    };
    if (face.kind != PlanarLayer::Face::Kind::kOutlines) {
      const Polygon corners = is_picture ? face.model->pictureCorners() : face.model->boardCorners();
      add(corners, {0, 1, 2});
      add(corners, {0, 2, 3});
      continue;
    }
    for (std::size_t k = 0; k < face.model->outlines().size(); ++k) {
      for (const auto& triangle : face.model->triangles(k)) add(face.model->outlines()[k], triangle);
    }
  }
}

void TriangleList::addTriangle(const Points& points_C, const Colors& colors, const ViewCell& cell, bool inside,
                               std::uint8_t number, double bias) {
  cell_ = &cell;
  if (inside) {
    cut(corner(points_C[0], colors[0]), corner(points_C[1], colors[1]), corner(points_C[2], colors[2]), number, bias,
        0);
    return;
  }
  polygon_.assign(points_C.begin(), points_C.end());
  cell.clip(polygon_);
  if (polygon_.size() < 3) return;
  // Colours of the new corners from their areal coordinates in the triangle.
  const Eigen::Vector3d e1 = points_C[1] - points_C[0], e2 = points_C[2] - points_C[0], normal = e1.cross(e2);
  const double scale = 1.0 / std::max(normal.squaredNorm(), 1e-300);
  std::vector<Corner> corners;
  for (const Eigen::Vector3d& p : polygon_) {
    const Eigen::Vector3d d = p - points_C[0];
    const float b = static_cast<float>(d.cross(e2).dot(normal) * scale);
    const float c = static_cast<float>(e1.cross(d).dot(normal) * scale);
    const Eigen::Vector3f rgb = colors[0] + b * (colors[1] - colors[0]) + c * (colors[2] - colors[0]);
    corners.push_back(corner(p, rgb.cwiseMax(0.0f).cwiseMin(255.0f)));
  }
  for (std::size_t i = 2; i < corners.size(); ++i) cut(corners[0], corners[i - 1], corners[i], number, bias, 0);
}

TriangleList::Corner TriangleList::corner(const Eigen::Vector3d& p_C, const Eigen::Vector3f& rgb) const {
  Corner corner;
  corner.inverse_z = 1.0 / cell_->depth(p_C);
  corner.xy = cell_->across(p_C) * corner.inverse_z;
  corner.rgb = rgb;
  corner.px = cell_->toPixel(*camera_, corner.xy);
  return corner;
}

/** Depths are interpolated over triangles that stray from the lens's image by up to kChord; two faces of one plane, cut
 *  otherwise, may differ by that much of the change of near plane / depth from pixel to pixel. On a plane at a distance
 *  h that is at most near / h for each unit of normalised coordinates, which the fisheye draws f / 3 wide or more. */
double TriangleList::slack(const Pose& X_CM) const {
  if (camera_->lens() != CameraModel::Lens::kEquidistant) return 0.0;
  const double h = std::abs((X_CM.q * Eigen::Vector3d::UnitZ()).dot(X_CM.p));
  const double change = camera_->nearM() / std::max(h, camera_->nearM()) * 3.0 / std::min(camera_->fx(), camera_->fy());
  return 2.0 * kChord * change;
}

/** How far the middle of an edge lies off its chord [px]; through the fisheye off the chord's middle, for that also
 *  compresses along straight edges, and depth and colour are interpolated between the ends. */
double TriangleList::bend(const Corner& from, const Corner& to, const Eigen::Vector2d& middle_px) const {
  if (camera_->lens() != CameraModel::Lens::kEquidistant) return bow(from.px, to.px, middle_px);
  if ((to.xy - from.xy).norm() > ViewCell::kLongest) return (to.px - from.px).norm();
  return (0.5 * (from.px + to.px) - middle_px).norm();
}

/** Halves the most bent edge until none is bent. Each decision depends on that edge alone, so the triangles on both
 *  sides of an edge are cut alike and leave no gap. */
void TriangleList::cut(const Corner& a, const Corner& b, const Corner& c, std::uint8_t number, double bias, int depth) {
  const int deepest = camera_->lens() == CameraModel::Lens::kEquidistant ? 24 : 16;
  if (camera_->lens() != CameraModel::Lens::kNone && depth < deepest) {
    const std::array<const Corner*, 3> corners{&a, &b, &c};
    double worst = kChord;
    int split = -1;
    Corner middle;
    for (int k = 0; k < 3; ++k) {
      const Corner &from = *corners[k], &to = *corners[(k + 1) % 3];
      const Eigen::Vector2d xy = 0.5 * (from.xy + to.xy);
      const Eigen::Vector2d px = cell_->toPixel(*camera_, xy);
      const double bent = bend(from, to, px);
      if (bent <= worst) continue;
      worst = bent;
      split = k;
      middle = {xy, 0.5 * (from.inverse_z + to.inverse_z), 0.5f * (from.rgb + to.rgb), px};
    }
    if (split >= 0) {
      const Corner &from = *corners[split], &to = *corners[(split + 1) % 3], &apex = *corners[(split + 2) % 3];
      cut(from, middle, apex, number, bias, depth + 1);
      cut(middle, to, apex, number, bias, depth + 1);
      return;
    }
  }
  for (const Corner* corner : {&a, &b, &c}) vertices_.push_back(vertex(*corner, number, bias));
}

Vertex TriangleList::vertex(const Corner& corner, std::uint8_t number, double bias) const {
  const auto byte = [](float value) { return static_cast<std::uint8_t>(value + 0.5f); };
  // At most 1: rounding must not push what was clipped at the near plane out of the depth range.
  const double z = std::min(1.0, camera_->nearM() * corner.inverse_z + bias);
  return {static_cast<float>(corner.px.x() + 0.5),
          static_cast<float>(corner.px.y() + 0.5),
          static_cast<float>(z),
          {byte(corner.rgb.x()), byte(corner.rgb.y()), byte(corner.rgb.z()), number}};
}

}  // namespace aras_visual_servo_sim
