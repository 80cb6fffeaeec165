#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/render/coverage_renderer.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"

namespace aras_visual_servo_sim::testing {

inline CameraConfig cameraConfig() {
  CameraConfig config;
  config.width = 320;
  config.height = 240;
  config.horizontal_fov_rad = 1.41;
  config.encoding = "mono8";
  return config;
}

/** The published camera's lens. */
inline CameraConfig distortedConfig() {
  CameraConfig config = cameraConfig();
  config.distortion_model = "plumb_bob";
  config.distortion = {-0.3306, 0.117, 0.001, -0.0015, 0.0};
  return config;
}

/** Camera at p_W, looking down the world's -z after a tilt about its own x and y axes: u along world x. */
inline Pose lookingDown(const Eigen::Vector3d& p_W, double tilt_x = 0.0, double tilt_y = 0.0, double roll = 0.0) {
  const Eigen::Quaterniond down(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  return {p_W, down * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(tilt_x, Eigen::Vector3d::UnitX()) *
                   Eigen::AngleAxisd(tilt_y, Eigen::Vector3d::UnitY())};
}

/** An L: not symmetric about anything. */
inline Polygon lShape() {
  return {{-0.06, -0.05}, {0.07, -0.05}, {0.07, -0.02}, {-0.02, -0.02}, {-0.02, 0.05}, {-0.06, 0.05}};
}

inline Scene sceneWith(const Polygon& outline) {
  Scene scene;
  scene.background = {230, 230, 230};
  scene.models.emplace_back("target", std::vector<Polygon>{outline}, Rgb{20, 20, 20});
  return scene;
}

inline Image render(const CameraModel& camera, const Pose& X_WC, const Scene& scene,
                    CoverageRenderer::Path path = CoverageRenderer::Path::kAutomatic) {
  CoverageRenderer renderer(path);
  Image image;
  renderer.render(camera, X_WC, scene, image);
  return image;
}

/** Area [px^2] and centroid [px]. */
struct Blob {
  double area = 0.0;
  Eigen::Vector2d centroid{0.0, 0.0};
};

/** Of a mono8 image, each pixel weighted by where it lies between background (230) and object (20). */
inline Blob blobOf(const Image& image) {
  Blob blob;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const double weight = (230.0 - *image.pixel(u, v)) / 210.0;
      blob.area += weight;
      blob.centroid += weight * Eigen::Vector2d(u, v);
    }
  }
  blob.centroid /= blob.area;
  return blob;
}

/** The same of the model's first outline, projected point by point along its edges: no rendering involved.
 *  @param project  of a point in the camera's frame [m] to [px] */
template <typename Project>
Blob exactBlob(const Project& project, const Pose& X_CM, const PlanarModel& model) {
  constexpr int kPieces = 2000;  // an edge of 60 px bends by less than 1e-6 px between points
  const Polygon& outline = model.outlines().front();
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d from = outline[i], to = outline[(i + 1) % outline.size()];
    for (int k = 0; k < kPieces; ++k) {
      const Eigen::Vector2d p = from + double(k) / kPieces * (to - from);
      points.push_back(project(X_CM * Eigen::Vector3d(p.x(), p.y(), 0.0)));
    }
  }
  Blob blob;
  for (std::size_t i = 0, j = points.size() - 1; i < points.size(); j = i++) {
    const double cross = points[j].x() * points[i].y() - points[i].x() * points[j].y();
    blob.area += 0.5 * cross;
    blob.centroid += cross * (points[i] + points[j]) / 6.0;
  }
  blob.centroid /= blob.area;
  blob.area = std::abs(blob.area);
  return blob;
}

inline Blob exactBlob(const CameraModel& camera, const Pose& X_WC, const PlanarModel& model) {
  const auto project = [&camera](const Eigen::Vector3d& p_C) { return camera.project(p_C).value(); };
  return exactBlob(project, X_WC.inverse() * model.X_WM, model);
}

/** Rounding to 8 bits is an error of at most half a level on each pixel an edge crosses, of either sign. With n such
 *  pixels and 210 levels of contrast the area's standard deviation is sqrt(n / 12) / 210 px; n < 1000 here, four
 *  standard deviations are 0.17 px, and 0.2 px leaves room for lens chords of 1e-3 px. */
constexpr double kAreaTolerance = 0.2;
/** The same error times a lever of at most 40 px over an area of at least 500 px^2: 0.17 * 40 / 500 at the very worst,
 *  a third of it in the mean: 0.005 px is what images of 60 .. 80 px wide objects must reach. */
constexpr double kCentroidTolerance = 0.005;

}  // namespace aras_visual_servo_sim::testing
