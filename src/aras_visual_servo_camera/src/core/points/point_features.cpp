#include "points/point_features.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {
namespace {

/** A point of the plane for each ray, for the tracker: as far from the origin as the ray is from the optical axis
 * [rad], in its direction. Near the axis these are the normalised coordinates; a turn about the axis is one there, too.
 */
ImagePoint chartOf(const CameraIntrinsics::Ray& ray) {
  const double aside = std::hypot(ray.x, ray.y);
  const double scale = aside > 0.0 ? std::atan2(aside, ray.z) / aside : 1.0;
  return {scale * ray.x, scale * ray.y};
}

// Before there is a reference: with more objects than wanted, the largest are taken if they are larger than the others
// by this factor.
constexpr double kClearlyLarger = 1.5;

template <class Pixels>
void append(const std::vector<Pixels>& from, std::vector<Pixels>* to) {
  to->insert(to->end(), from.begin(), from.end());
}

template <class Value, class Index>
std::vector<Value> picked(const std::vector<Value>& from, const std::vector<Index>& indices) {
  std::vector<Value> values;
  for (const Index k : indices) values.push_back(from[k]);
  return values;
}

template <class Pixels>
void sortByRow(std::vector<Pixels>* pixels) {
  std::stable_sort(pixels->begin(), pixels->end(), [](const Pixels& a, const Pixels& b) { return a.v < b.v; });
}

}  // namespace

PointFeatures::PointFeatures(const VisionConfig& config, const PixelMap& map)
    : map_(map),
      with_rays_(config.rays),
      source_(config.points),
      count_(static_cast<std::size_t>(config.point_count.value_or(0))),
      corners_(map, config.point_count.value_or(0)),
      centroids_(map, 1),
      tracker_(config.point_count.value_or(0), config.points == PointSource::kCorners) {}

const ObjectMask& PointFeatures::find(const ObjectMask& chosen, const std::vector<ObjectMask>& objects) {
  if (source_ == PointSource::kCorners) {
    found_ = corners_.find(chosen);
    return chosen;
  }
  findBlobs(objects);
  unite(chosen, objects);
  return together_;
}

/** The middle of the rays of its pixels, weighed by the solid angle of what the object covers of each. */
std::optional<CameraIntrinsics::Ray> PointFeatures::middleRay(const ObjectMask& object) const {
  double x = 0.0, y = 0.0, z = 0.0;
  bool whole = true;
  const auto add = [&](const CameraIntrinsics::Ray& ray, double weight) {
    whole = whole && ray.solid_angle > 0.0;
    x += weight * ray.solid_angle * ray.x;
    y += weight * ray.solid_angle * ray.y;
    z += weight * ray.solid_angle * ray.z;
  };
  for (const Span& span : object.spans)
    for (int u = span.u_begin; u < span.u_end; ++u) add(map_.ray(u, span.v), 1.0);
  for (const EdgePixel& e : object.edge) add(map_.intrinsics().rayOf(e.u + e.du, e.v + e.dv), e.weight);
  const double length = std::sqrt(x * x + y * y + z * z);
  if (!whole || !(length > 0.0)) return std::nullopt;
  return CameraIntrinsics::Ray{x / length, y / length, z / length, 0.0};
}

// The centroid of an object that is cut by the border is not the object's, so such an object is not used.
void PointFeatures::findBlobs(const std::vector<ObjectMask>& objects) {
  found_.clear();
  rays_.clear();
  object_of_.clear();
  for (std::size_t k = 0; k < objects.size(); ++k) {
    if (objects[k].touches_border) continue;
    if (with_rays_) {
      if (const auto ray = middleRay(objects[k])) {
        rays_.push_back(*ray);
        found_.push_back(chartOf(*ray));
        object_of_.push_back(k);
      }
      continue;
    }
    const std::vector<double>& m = centroids_.process(objects[k]);
    if (!(m[0] > 0.0) || centroids_.leftTheLens()) continue;
    found_.push_back({m[momentIndex(1, 0)] / m[0], m[momentIndex(0, 1)] / m[0]});
    object_of_.push_back(k);
  }
  if (tracker_.hasReference() || found_.size() <= count_) return;
  std::vector<std::size_t> by_area(found_.size());
  std::iota(by_area.begin(), by_area.end(), std::size_t{0});
  const auto area = [&](std::size_t k) { return static_cast<double>(objects[object_of_[k]].area_px); };
  std::stable_sort(by_area.begin(), by_area.end(), [&](std::size_t a, std::size_t b) { return area(a) > area(b); });
  if (area(by_area[count_ - 1]) < kClearlyLarger * area(by_area[count_])) return;
  by_area.resize(count_);
  std::sort(by_area.begin(), by_area.end());
  found_ = picked(found_, by_area);
  if (with_rays_) rays_ = picked(rays_, by_area);
  object_of_ = picked(object_of_, by_area);
}

void PointFeatures::unite(const ObjectMask& chosen, const std::vector<ObjectMask>& objects) {
  const std::vector<int> matched = tracker_.match(found_, 0.0);
  together_.width_px = chosen.width_px;
  together_.height_px = chosen.height_px;
  together_.soft_edges = chosen.soft_edges;
  together_.grey_step = 0.0;
  together_.components = chosen.components;
  together_.visible = !matched.empty();
  together_.area_px = 0;
  together_.u_px = together_.v_px = 0.0;
  together_.spans.clear();
  together_.edge.clear();
  for (const int k : matched) {
    const ObjectMask& object = objects[object_of_[k]];
    append(object.spans, &together_.spans);
    append(object.edge, &together_.edge);
    together_.u_px += object.area_px * object.u_px;
    together_.v_px += object.area_px * object.v_px;
    together_.area_px += object.area_px;
    together_.grey_step = std::max(together_.grey_step, object.grey_step);
  }
  found_ = picked(found_, matched);
  if (with_rays_) rays_ = picked(rays_, matched);
  if (!together_.visible) return;
  together_.u_px /= together_.area_px;
  together_.v_px /= together_.area_px;
  sortByRow(&together_.spans);
  sortByRow(&together_.edge);
}

void PointFeatures::write(const std::optional<Reference>& reference, MomentFeatures* features) {
  double turn = 0.0;
  if (reference && std::isfinite(features->alpha)) turn = features->alpha - reference->alpha_star;
  features->point_x.clear();
  features->point_y.clear();
  for (const int k : tracker_.match(found_, turn)) {
    if (!with_rays_) {
      features->point_x.push_back(found_[k].x);
      features->point_y.push_back(found_[k].y);
      continue;
    }
    features->ray_x.push_back(rays_[k].x);
    features->ray_y.push_back(rays_[k].y);
    features->ray_z.push_back(rays_[k].z);
  }
  const double least = std::cos(CameraIntrinsics::kWidestAngle);
  const std::vector<double>& z = features->ray_z;
  if (std::all_of(z.begin(), z.end(), [least](double one) { return one > least; })) {
    for (std::size_t k = 0; k < z.size(); ++k) {
      features->point_x.push_back(features->ray_x[k] / z[k]);
      features->point_y.push_back(features->ray_y[k] / z[k]);
    }
  }
  const bool found = with_rays_ ? !z.empty() : !features->point_x.empty();
  features->valid = features->target_visible && !features->touches_border && found;
}

void PointFeatures::check(const MomentFeatures& features) const {
  const auto& [x, y] =
      with_rays_ ? std::tie(features.ray_x, features.ray_y) : std::tie(features.point_x, features.point_y);
  const std::size_t n = std::min(x.size(), y.size());
  if (n != count_ || x.size() != y.size() || (with_rays_ && features.ray_z.size() != n))
    throw ShapeError("reference.points: found " + std::to_string(n) + ", allowed " + std::to_string(count_) +
                     ", vision.point_count");
  for (std::size_t k = 0; k < n; ++k)
    if (!std::isfinite(x[k]) || !std::isfinite(y[k]))
      throw ParameterError("reference.points: found a coordinate that is not finite, allowed finite numbers");
}

void PointFeatures::setReference(const MomentFeatures& features) {
  std::vector<ImagePoint> points;
  const std::size_t count = with_rays_ ? features.ray_x.size() : features.point_x.size();
  for (std::size_t k = 0; k < count; ++k)
    points.push_back(with_rays_ ? chartOf({features.ray_x[k], features.ray_y[k], features.ray_z[k], 0.0})
                                : ImagePoint{features.point_x[k], features.point_y[k]});
  tracker_.setReference(points);
}

}  // namespace aras_visual_servo_camera
