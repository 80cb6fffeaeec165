#include "planar_layer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/image/pixel_color.hpp"
#include "render/view/pixel_box.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kChord = 1e-3;     // [px] a curve may stray from its chord; its area by two thirds of that
constexpr double kCoplanar = 1e-9;  // [m] rounding of points that lie in a plane, k eps times metres

PixelBox boxOf(const std::vector<Eigen::Vector2d>& points, std::size_t begin, const CameraModel& camera) {
  const double infinity = std::numeric_limits<double>::infinity();
  Eigen::Vector2d low(infinity, infinity), high(-infinity, -infinity);
  for (std::size_t i = begin; i < points.size(); ++i) {
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
  }
  const auto pixel = [](double x, int size) { return static_cast<int>(held(std::floor(x), 0.0, double(size))); };
  if (begin == points.size()) return {};
  return {pixel(low.x() + 0.5, camera.width()), pixel(low.y() + 0.5, camera.height()),
          pixel(high.x() + 1.5, camera.width()), pixel(high.y() + 1.5, camera.height())};
}

}  // namespace

void PlanarLayer::project(const CameraModel& camera, const ViewVolume& volume, const Pose& X_CW, const Scene& scene) {
  for (auto view = views_.rbegin(); view != views_.rend(); ++view) giveBack(std::move(*view));
  views_.clear();
  faces_.clear();
  conflicts_.clear();
  points_.clear();
  for (const PlanarModel& model : scene.models) {
    if (model.visible) addModel(camera, volume, X_CW * model.X_WM, model);
  }
  sort();
  std::size_t pictures = 0;
  for (const std::size_t index : order_) {
    for (Part& part : views_[index].parts) {
      if (part.face.kind == Face::Kind::kPicture) part.face.picture = static_cast<int>(pictures++);
      faces_.push_back(part.face);
    }
  }
  std::get<0>(pictures_).resize(pictures);
  std::get<1>(pictures_).resize(pictures);
}

PlanarLayer::View PlanarLayer::takeView() {
  if (spare_views_.empty()) return {};
  View view = std::move(spare_views_.back());
  spare_views_.pop_back();
  return view;
}

PlanarLayer::Part PlanarLayer::takePart(const Face& face, const Pose& X_CM) {
  Part part;
  if (!spare_parts_.empty()) {
    part = std::move(spare_parts_.back());
    spare_parts_.pop_back();
  }
  part.face = face;
  part.X_CM = X_CM;
  return part;
}

void PlanarLayer::giveBack(View&& view) {
  for (auto part = view.parts.rbegin(); part != view.parts.rend(); ++part) {
    part->loops.clear();
    spare_parts_.push_back(std::move(*part));
  }
  view.parts.clear();
  view.corners_C.clear();
  spare_views_.push_back(std::move(view));
}

bool PlanarLayer::addModel(const CameraModel& camera, const ViewVolume& volume, const Pose& X_CM,
                           const PlanarModel& model) {
  cells_.clear();
  for (const ViewCell& cell : volume) {
    if (!cell.excludes(X_CM.p, model.radius())) cells_.emplace_back(&cell, cell.contains(X_CM.p, model.radius()));
  }
  if (cells_.empty()) return false;
  const std::size_t begin = points_.size();
  View view = takeView();
  view.normal_C = X_CM.q * Eigen::Vector3d::UnitZ();
  view.offset = view.normal_C.dot(X_CM.p);
  const bool from_front = view.offset < 0.0;
  if (!from_front) {
    view.normal_C = -view.normal_C;
    view.offset = -view.offset;
  }
  const auto addPart = [&](Face::Kind kind, const Rgb& color, const Polygon* outlines, std::size_t count) {
    Part part = takePart({&model, kind, color}, X_CM);
    for (std::size_t k = 0; k < count; ++k) {
      for (const auto& [cell, inside] : cells_) addLoop(camera, *cell, X_CM, inside, outlines[k], view, part);
    }
    (part.loops.empty() ? spare_parts_ : view.parts).push_back(std::move(part));
  };
  if (!model.outlines().empty()) {
    addPart(Face::Kind::kOutlines, model.color(), model.outlines().data(), model.outlines().size());
  }
  if (model.picture()) addPart(Face::Kind::kPicture, {}, &model.pictureCorners(), 1);
  if (model.board()) addPart(Face::Kind::kBoard, model.board()->color, &model.boardCorners(), 1);
  if (from_front) std::reverse(view.parts.begin(), view.parts.end());
  view.box = boxOf(points_, begin, camera);
  if (view.box.empty()) {
    giveBack(std::move(view));
    return false;
  }
  views_.push_back(std::move(view));
  return true;
}

void PlanarLayer::addLoop(const CameraModel& camera, const ViewCell& cell, const Pose& X_CM, bool inside,
                          const Polygon& outline, View& view, Part& part) {
  polygon_.clear();
  const Eigen::Matrix3d R = X_CM.q.toRotationMatrix();
  for (const Eigen::Vector2d& corner : outline) {
    polygon_.push_back(X_CM.p + R.col(0) * corner.x() + R.col(1) * corner.y());
  }
  if (!inside) cell.clip(polygon_);
  if (polygon_.size() < 3) return;
  view.corners_C.insert(view.corners_C.end(), polygon_.begin(), polygon_.end());
  const std::size_t begin = points_.size();
  Eigen::Vector2d before = cell.across(polygon_.back()) / cell.depth(polygon_.back());
  Eigen::Vector2d before_px = cell.toPixel(camera, before);
  for (const Eigen::Vector3d& corner : polygon_) {
    const Eigen::Vector2d xy = cell.across(corner) / cell.depth(corner);
    const Eigen::Vector2d px = cell.toPixel(camera, xy);
    if (camera.lens() != CameraModel::Lens::kNone) addCurve(camera, cell, before, xy, before_px, px, 0);
    points_.push_back(px);
    before = xy;
    before_px = px;
  }
  part.loops.push_back({begin, points_.size()});
}

/** Halves a straight line of the scene until its image through the lens is straight, ends excluded. */
void PlanarLayer::addCurve(const CameraModel& camera, const ViewCell& cell, const Eigen::Vector2d& from,
                           const Eigen::Vector2d& to, const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px,
                           int depth) {
  constexpr int kAlways = 1, kDeepest = 10;  // halve once whatever the middle says: it may lie on an inflexion
  const Eigen::Vector2d middle = 0.5 * (from + to);
  const Eigen::Vector2d middle_px = cell.toPixel(camera, middle);
  const Eigen::Vector2d chord = to_px - from_px, bow = middle_px - from_px;
  const bool lengthy = camera.lens() == CameraModel::Lens::kEquidistant && (to - from).norm() > ViewCell::kLongest;
  const bool straight = !lengthy && std::abs(chord.x() * bow.y() - chord.y() * bow.x()) <= kChord * chord.norm();
  if (depth >= kDeepest || (depth >= kAlways && straight)) return;
  addCurve(camera, cell, from, middle, from_px, middle_px, depth + 1);
  points_.push_back(middle_px);
  addCurve(camera, cell, middle, to, middle_px, to_px, depth + 1);
}

/** Puts views back to front by trying planes: a is behind b if a lies wholly on the far side of b's plane, or b wholly
 *  on the near side of a's. Only views that overlap in the image matter. */
void PlanarLayer::sort() {
  const auto isBehind = [](const View& a, const View& b) {
    return std::all_of(a.corners_C.begin(), a.corners_C.end(),
                       [&](const Eigen::Vector3d& p) { return b.normal_C.dot(p) <= b.offset + kCoplanar; }) ||
           std::all_of(b.corners_C.begin(), b.corners_C.end(),
                       [&](const Eigen::Vector3d& p) { return a.normal_C.dot(p) >= a.offset - kCoplanar; });
  };
  const std::size_t n = views_.size();
  must_precede_.assign(n * n, 0);  // [i * n + j]: i is painted before j
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      if (!views_[i].box.overlaps(views_[j].box)) continue;
      if (isBehind(views_[i], views_[j])) {  // also when coplanar: later ones lie on top
        must_precede_[i * n + j] = 1;
      } else if (isBehind(views_[j], views_[i])) {
        must_precede_[j * n + i] = 1;
      } else {
        conflicts_.push_back(views_[i].box.within(views_[j].box));
      }
    }
  }
  order_.clear();
  done_.assign(n, 0);
  while (order_.size() < n) {
    std::size_t next = n, any = n;
    for (std::size_t j = 0; j < n && next == n; ++j) {
      if (done_[j]) continue;
      if (any == n) any = j;
      bool free = true;
      for (std::size_t i = 0; i < n; ++i) free = free && (done_[i] || !must_precede_[i * n + j]);
      if (free) next = j;
    }
    if (next == n) {  // a ring of three or more: no order is right
      next = any;
      conflicts_.push_back(views_[any].box);
    }
    done_[next] = 1;
    order_.push_back(next);
  }
}

void PlanarLayer::addEdges(const Part& part, CoverageRasterizer& rasterizer) const {
  for (const Loop& loop : part.loops) {
    for (std::size_t i = loop.begin, j = loop.end - 1; i < loop.end; j = i++) {
      rasterizer.addEdge(points_[j], points_[i]);
    }
  }
}

void PlanarLayer::addEdges(const Face& face, CoverageRasterizer& rasterizer) const {
  for (const View& view : views_) {
    for (const Part& part : view.parts) {
      if (&part.face == &face) addEdges(part, rasterizer);
    }
  }
}

void PlanarLayer::forEachFace(const std::function<void(const Face&, const Eigen::Vector3d&, double)>& visit) const {
  for (const std::size_t index : order_) {
    for (const Part& part : views_[index].parts) visit(part.face, views_[index].normal_C, views_[index].offset);
  }
}

template <typename Value>
void PlanarLayer::samplePictures(const CameraModel& camera, CoverageRasterizer& rasterizer) {
  auto& pictures = std::get<std::vector<ImageOf<Value>>>(pictures_);
  if (pictures.empty()) return;
  for (const View& view : views_) {
    for (const Part& part : view.parts) {
      if (part.face.kind != Face::Kind::kPicture) continue;
      ImageOf<Value>& picture = pictures[part.face.picture];
      picture.resize(camera.width(), camera.height(), camera.drawnEncoding());
      rasterizer.begin(camera.width(), camera.height(), CoverageRasterizer::Rule::kCoverage);
      addEdges(part, rasterizer);
      sampler_.sample(camera, part.X_CM, *part.face.model->picture(), rasterizer.bounds(), picture);
    }
  }
}

template <typename Value>
void PlanarLayer::paint(const CameraModel& camera, CoverageRasterizer& rasterizer, ImageOf<Value>& image) const {
  const CoverageRasterizer::Rule rule = ruleOf(camera);
  for (const std::size_t index : order_) {
    for (const Part& part : views_[index].parts) {
      rasterizer.begin(image.width, image.height, rule);
      addEdges(part, rasterizer);
      if (part.face.kind == Face::Kind::kPicture) {
        rasterizer.blend(pictures<Value>()[part.face.picture], image);
      } else {
        rasterizer.blend(pixelOf<Value>(part.face.color, image.encoding), image);
      }
    }
  }
}

template void PlanarLayer::samplePictures<std::uint8_t>(const CameraModel&, CoverageRasterizer&);
template void PlanarLayer::samplePictures<std::uint16_t>(const CameraModel&, CoverageRasterizer&);
template void PlanarLayer::paint(const CameraModel&, CoverageRasterizer&, Image&) const;
template void PlanarLayer::paint(const CameraModel&, CoverageRasterizer&, FineImage&) const;

}  // namespace aras_visual_servo_sim
