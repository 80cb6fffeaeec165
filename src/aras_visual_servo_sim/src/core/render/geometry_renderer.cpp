#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/wide.hpp"
#include "aras_visual_servo_sim/render/geometry_image.hpp"
#include "render/coverage/coverage_rasterizer.hpp"
#include "render/curved/curved_list.hpp"
#include "render/planar/planar_layer.hpp"
#include "render/tiles/tile_curved.hpp"
#include "render/triangles/triangle_list.hpp"
#include "render/view/pixel_box.hpp"
#include "render/view/view_volume.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Nearness of two faces in one plane differs by rounding only; of these the later face is taken to lie on top. */
constexpr double kSamePlane = 1e-9;

/** Pixels side by side, without a lens, that see one plane: what is nearest so far, and whose it is. */
struct Run {
  const double* x;   ///< of the pixels' rays (x, y, 1)
  double* nearness;  ///< 1 / Z
  std::uint16_t* ids;
  int count;
};

/** Sees a plane where it is the nearest: of which slope x + across is `divisor` times the nearness. */
ARAS_WIDE void seePlane(const Run& run, double slope, double across, double ahead, double divisor, double far_m,
                        std::uint16_t id) {
  for (int k = 0; k < run.count; ++k) {
    const double nearness = (slope * run.x[k] + across + ahead) / divisor;
    const bool seen = nearness * far_m >= 1.0 && nearness >= run.nearness[k] * (1.0 - kSamePlane);
    run.nearness[k] = seen ? nearness : run.nearness[k];
    run.ids[k] = seen ? id : run.ids[k];
  }
}

/** Distances from nearness. @param y  of the rays; 0 and x null: along the optical axis */
ARAS_WIDE void toDistance(const double* nearness, const double* x, double y, int count, float* distance_m) {
  for (int k = 0; k < count; ++k) {
    const double ray = x ? std::sqrt(x[k] * x[k] + y * y + 1.0) : 1.0;
    distance_m[k] = nearness[k] > 0.0 ? static_cast<float>(ray / nearness[k]) : GeometryImage::kNothing;
  }
}

}  // namespace

std::map<std::string, std::uint16_t> segmentationIds(const Scene& scene) {
  std::map<std::string, std::uint16_t> ids;
  std::uint16_t next = 1;
  for (const PlanarModel& model : scene.models) ids[model.name()] = next++;
  for (const Body& body : scene.bodies) ids[body.name] = next++;
  return ids;
}

class GeometryRenderer::Implementation {
 public:
  void render(const CameraModel& camera, const Pose& X_WC, const Scene& scene, GeometryImage& out, Distance distance) {
    out.width = camera.width();
    out.height = camera.height();
    out.depth_m.assign(std::size_t(out.width) * out.height, GeometryImage::kNothing);
    out.ids.assign(out.depth_m.size(), 0);
    nearness_.assign(out.depth_m.size(), 0.0);
    ray_x_.clear();
    for (int u = 0; u < out.width; ++u) ray_x_.push_back(camera.pixelRay(u, 0).x());
    const ViewVolume volume(camera);
    const Pose X_CW = X_WC.inverse();
    planar_.project(camera, volume, X_CW, scene);
    paintModels(camera, scene, out);
    triangles_.begin(camera, volume, /*lit=*/false);
    triangles_.addBodies(scene, X_CW);
    paintBodies(camera, scene, out);
    curved_.begin(camera, volume);
    if (curved_.addBodies(scene, X_CW)) paintCurved(camera, scene, out);
    for (int v = 0; v < out.height; ++v) {
      if (triangles_.isFlat()) {
        toDistance(&nearness_[out.at(0, v)], distance == Distance::kRange ? ray_x_.data() : nullptr,
                   camera.pixelRay(0, v).y(), out.width, &out.depth_m[out.at(0, v)]);
        continue;
      }
      for (int u = 0; u < out.width; ++u) finish(camera, u, v, distance, out);
    }
  }

 private:
  /** @param nearness  1 / s of what is seen at s times the pixel's ray: 1 / Z, of unit rays 1 / range */
  void see(std::size_t at, double nearness, std::uint16_t id, GeometryImage& out) {
    if (!(nearness > 0.0) || nearness < nearness_[at] * (1.0 - kSamePlane)) return;
    nearness_[at] = nearness;
    out.ids[at] = id;
  }

  void finish(const CameraModel& camera, int u, int v, Distance distance, GeometryImage& out) {
    const std::size_t at = out.at(u, v);
    if (camera.showsLensCircle() && !camera.isWithinLens(u, v)) out.ids[at] = 0;
    if (out.ids[at] == 0) return;
    const Eigen::Vector3d ray = camera.pixelRay(u, v);
    if (distance == Distance::kRange) {
      out.depth_m[at] = static_cast<float>(ray.norm() / nearness_[at]);
    } else if (ray.z() > 0.0) {
      out.depth_m[at] = static_cast<float>(ray.z() / nearness_[at]);
    }
  }

  void paintModels(const CameraModel& camera, const Scene& scene, GeometryImage& out) {
    planar_.forEachFace([&](const PlanarLayer::Face& face, const Eigen::Vector3d& normal_C, double offset) {
      if (std::abs(offset) < kSamePlane) return;  // seen from its own plane
      const auto id = static_cast<std::uint16_t>(1 + (face.model - scene.models.data()));
      rasterizer_.begin(out.width, out.height, CoverageRasterizer::Rule::kCenter);
      planar_.addEdges(face, rasterizer_);
      rasterizer_.forEachRun([&](int u0, int u1, int v) {
        // On the plane normal . (s ray) = offset, so 1 / s is linear in the ray.
        if (camera.lens() == CameraModel::Lens::kNone) {
          seePlane(runOf(u0, u1, v, out), normal_C.x(), normal_C.y() * camera.pixelRay(0, v).y(), normal_C.z(), offset,
                   std::numeric_limits<double>::infinity(), id);
          return;
        }
        for (int u = u0; u < u1; ++u) see(out.at(u, v), normal_C.dot(camera.pixelRay(u, v)) / offset, id, out);
      });
    });
  }

  void paintBodies(const CameraModel& camera, const Scene& scene, GeometryImage& out) {
    std::size_t k = 0;
    auto span = triangles_.spans().begin();
    for (const auto& [end, body] : triangles_.bodies()) {
      const auto id = static_cast<std::uint16_t>(1 + scene.models.size() + body);
      if (triangles_.isFlat()) {
        for (; k < end; ++k) paintTriangle(&triangles_.vertices()[3 * k], triangles_.plane(k), camera, id, out);
      }
      for (; span != triangles_.spans().end() && span->triangle < end; ++span) paintSpan(*span, camera, id, out);
    }
  }

  /** Through a lens. */
  void paintSpan(const TriangleList::Span& span, const CameraModel& camera, std::uint16_t id, GeometryImage& out) {
    const Facet& facet = triangles_.facet(span.triangle);
    const auto end = [](int tile, int size) { return std::min(tile * CameraModel::kBlock, size); };
    for (int v = end(span.row, out.height); v < end(span.row + 1, out.height); ++v) {
      for (int u = end(span.first, out.width); u < end(span.last, out.width); ++u) {
        const Eigen::Vector3d ray = camera.pixelRay(u, v);
        constexpr double kOnEdge = 1e-12;  // rounding: a centre on an edge belongs to both triangles, not to none
        if (std::any_of(facet.edges.begin(), facet.edges.end(),
                        [&](const Eigen::Vector3d& edge) { return edge.dot(ray) < -kOnEdge; })) {
          continue;
        }
        const double nearness = facet.plane.dot(ray);
        const double ahead = aheadOf(camera, ray);
        if (nearness * camera.farM() >= ahead && nearness * camera.nearM() <= ahead)
          see(out.at(u, v), nearness, id, out);
      }
    }
  }

  /** Without a lens. */
  void paintTriangle(const Vertex* t, const Eigen::Vector3d& plane_C, const CameraModel& camera, std::uint16_t id,
                     GeometryImage& out) {
    const double dx1 = t[1].x - t[0].x, dy1 = t[1].y - t[0].y, dx2 = t[2].x - t[0].x, dy2 = t[2].y - t[0].y;
    const double area = dx1 * dy2 - dx2 * dy1;
    if (area == 0.0) return;
    const auto first = [](float low, int size) {
      return static_cast<int>(held(std::ceil(double(low) - 0.5), 0.0, double(size)));
    };
    const auto last = [](float high, int size) {
      return static_cast<int>(held(std::floor(double(high) - 0.5) + 1.0, 0.0, double(size)));
    };
    const int u0 = first(std::min({t[0].x, t[1].x, t[2].x}), out.width);
    const int u1 = last(std::max({t[0].x, t[1].x, t[2].x}), out.width);
    const int v0 = first(std::min({t[0].y, t[1].y, t[2].y}), out.height);
    const int v1 = last(std::max({t[0].y, t[1].y, t[2].y}), out.height);
    for (int v = v0; v < v1; ++v) {
      const double dy = v + 0.5 - t[0].y;
      const auto isInside = [&](int u) {
        const double dx = u + 0.5 - t[0].x, b = (dx * dy2 - dx2 * dy) / area, c = (dx1 * dy - dx * dy1) / area;
        constexpr double kOnEdge = 1e-6;  // rounding: a centre on an edge belongs to both triangles, not to none
        return b >= -kOnEdge && c >= -kOnEdge && b + c <= 1.0 + kOnEdge;
      };
      int first = u0, last = u1;
      if (u1 - u0 > kFew) narrow(t, v + 0.5, first, last);
      while (first < last && !isInside(first)) ++first;
      while (first < last && !isInside(last - 1)) --last;
      if (first == last) continue;
      seePlane(runOf(first, last, v, out), plane_C.x(), plane_C.y() * camera.pixelRay(0, v).y(), plane_C.z(), 1.0,
               camera.farM(), id);
    }
  }

  static constexpr int kFew = 8;           // pixels of a row: looked at one after another
  static constexpr double kBeside = 0.01;  // [px] far more than what isInside takes for rounding

  /** Narrows a row of pixels to those between the edges of a triangle, and at most two beside each. */
  static void narrow(const Vertex* t, double y, int& first, int& last) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int k = 0; k < 3; ++k) {
      const Vertex &a = t[k], &b = t[(k + 1) % 3];
      if (std::min(a.y, b.y) > y + kBeside || std::max(a.y, b.y) < y - kBeside) continue;
      const double slope = a.y != b.y ? (double(b.x) - a.x) / (double(b.y) - a.y) : 0.0;
      for (const double at : {y - kBeside, y + kBeside}) {
        const double held_y = held(at, double(std::min(a.y, b.y)), double(std::max(a.y, b.y)));
        const double x = a.x + slope * (held_y - a.y);
        low = std::min({low, x, a.y == b.y ? double(b.x) : x});
        high = std::max({high, x, a.y == b.y ? double(b.x) : x});
      }
    }
    const double least = first, most = last;
    first = static_cast<int>(held(std::floor(low - 0.5) - 1.0, least, most));
    last = static_cast<int>(held(std::ceil(high - 0.5) + 2.0, least, most));
  }

  Run runOf(int u0, int u1, int v, GeometryImage& out) {
    const std::size_t at = out.at(u0, v);
    return {ray_x_.data() + u0, nearness_.data() + at, out.ids.data() + at, u1 - u0};
  }

  void paintCurved(const CameraModel& camera, const Scene& scene, GeometryImage& out) {
    const int tiles_u = (out.width + TileBins::kTile - 1) / TileBins::kTile;
    for (int tile = 0; tile < curved_.tiles(); ++tile) {
      const int u0 = tile % tiles_u * TileBins::kTile, v0 = tile / tiles_u * TileBins::kTile;
      for (const std::uint32_t* entry = curved_.begin(tile); entry != curved_.end(tile); ++entry) {
        const auto& [patch, body] = curved_.entries()[*entry];
        const auto id = static_cast<std::uint16_t>(1 + scene.models.size() + body);
        for (int v = v0; v < std::min(v0 + TileBins::kTile, out.height); ++v) {
          for (int u = u0; u < std::min(u0 + TileBins::kTile, out.width); ++u) {
            see(out.at(u, v), nearnessAt(camera, patch, camera.pixelRay(u, v)), id, out);
          }
        }
      }
    }
  }

  PlanarLayer planar_;
  CoverageRasterizer rasterizer_;
  TriangleList triangles_;
  CurvedList curved_;
  std::vector<double> nearness_;  // 0 where there is nothing
  std::vector<double> ray_x_;     // of the columns, without a lens
};

GeometryRenderer::GeometryRenderer() : implementation_(std::make_unique<Implementation>()) {}
GeometryRenderer::~GeometryRenderer() = default;

void GeometryRenderer::render(const CameraModel& camera, const Pose& X_WC, const Scene& scene, GeometryImage& out,
                              Distance distance) {
  if (!X_WC.p.allFinite() || !X_WC.q.coeffs().allFinite()) {
    throw NotFiniteError("render: pose of camera '" + camera.config().name + "' is not finite");
  }
  implementation_->render(camera, X_WC, scene, out, distance);
}

}  // namespace aras_visual_servo_sim
