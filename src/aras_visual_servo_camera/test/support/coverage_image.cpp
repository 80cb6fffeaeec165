#include "coverage_image.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_camera::testing {
namespace {

Polygon toPixels(const Polygon& normalised, const CameraIntrinsics& camera) {
  const int parts = camera.distorted() ? 24 : 1;
  Polygon px;
  for (std::size_t k = 0; k < normalised.size(); ++k) {
    const Point2 a = normalised[k], b = normalised[(k + 1) % normalised.size()];
    for (int n = 0; n < parts; ++n) {
      const double t = static_cast<double>(n) / parts;
      const auto p = camera.project(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y));
      px.push_back({p[0], p[1]});
    }
  }
  return px;
}

// Sutherland and Hodgman: keep what lies on the positive side of sign (axis - bound). Areas are right for any polygon.
Polygon clipped(const Polygon& p, bool along_x, double bound, double sign) {
  const auto inside = [&](const Point2& q) { return sign * ((along_x ? q.x : q.y) - bound) >= 0.0; };
  Polygon out;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Point2 a = p[k], b = p[(k + 1) % p.size()];
    if (inside(a)) out.push_back(a);
    if (inside(a) != inside(b)) {
      const double t = along_x ? (bound - a.x) / (b.x - a.x) : (bound - a.y) / (b.y - a.y);
      out.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
  }
  return out;
}

double areaOf(const Polygon& p) {
  double twice = 0.0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Point2 a = p[k], b = p[(k + 1) % p.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return 0.5 * std::abs(twice);
}

bool contains(const Polygon& p, double x, double y) {
  bool in = false;
  for (std::size_t k = 0, l = p.size() - 1; k < p.size(); l = k++)
    if ((p[k].y > y) != (p[l].y > y) && x < (p[l].x - p[k].x) * (y - p[k].y) / (p[l].y - p[k].y) + p[k].x) in = !in;
  return in;
}

}  // namespace

void drawCoverage(const Polygon& normalised, const CameraIntrinsics& camera, std::uint8_t grey, GreyImage* image) {
  const Polygon px = toPixels(normalised, camera);
  for (int v = 0; v < image->height; ++v) {
    const Polygon row = clipped(clipped(px, false, v - 0.5, 1.0), false, v + 0.5, -1.0);
    if (row.empty()) continue;
    const auto [least, most] =
        std::minmax_element(row.begin(), row.end(), [](const Point2& a, const Point2& b) { return a.x < b.x; });
    const int first = std::max(0, static_cast<int>(std::floor(least->x))),
              last = std::min(image->width - 1, static_cast<int>(std::ceil(most->x)));
    for (int u = first; u <= last; ++u) {
      const double covered = areaOf(clipped(clipped(row, true, u - 0.5, 1.0), true, u + 0.5, -1.0));
      std::uint8_t& pixel = image->at(u, v);
      pixel = static_cast<std::uint8_t>(std::lround(pixel + covered * (grey - pixel)));
    }
  }
}

void drawBinary(const Polygon& normalised, const CameraIntrinsics& camera, std::uint8_t grey, GreyImage* image) {
  const Polygon px = toPixels(normalised, camera);
  for (int v = 0; v < image->height; ++v)
    for (int u = 0; u < image->width; ++u)
      if (contains(px, u, v)) image->at(u, v) = grey;
}

GreyImage coverageImage(const Polygon& normalised, const CameraIntrinsics& camera) {
  GreyImage image(camera.width(), camera.height(), kBackgroundGrey);
  drawCoverage(normalised, camera, kObjectGrey, &image);
  return image;
}

GreyImage binaryImage(const Polygon& normalised, const CameraIntrinsics& camera) {
  GreyImage image(camera.width(), camera.height(), kBackgroundGrey);
  drawBinary(normalised, camera, kObjectGrey, &image);
  return image;
}

void addNoise(double sigma, std::mt19937* random, GreyImage* image) {
  std::normal_distribution<double> noise(0.0, sigma);
  for (std::uint8_t& pixel : image->data)
    pixel = static_cast<std::uint8_t>(std::clamp<long>(std::lround(pixel + noise(*random)), 0, 255));
}

CameraIntrinsics testCamera(bool distorted) {
  const std::vector<double> lens{-0.3306, 0.117, 0.0, 0.0, 0.0};  // the published lens
  return CameraIntrinsics(320, 240, {195.05, 0, 159.5, 0, 195.05, 119.5, 0, 0, 1}, "plumb_bob",
                          distorted ? lens : std::vector<double>());
}

}  // namespace aras_visual_servo_camera::testing
