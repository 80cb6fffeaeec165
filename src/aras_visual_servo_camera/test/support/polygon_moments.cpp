#include "polygon_moments.hpp"

#include <cmath>

#include "aras_visual_servo_camera/moments/moments.hpp"

namespace aras_visual_servo_camera::testing {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Abramowitz and Stegun, table 25.4, n = 8, on [-1, 1].
constexpr std::array<double, 4> kNodes{0.183434642495649805, 0.525532409916328986, 0.796666477413626740,
                                       0.960289856497536232};
constexpr std::array<double, 4> kWeights{0.362683783378361983, 0.313706645877887287, 0.222381034453374471,
                                         0.101228536290376259};

double edgeIntegral(const Point2& a, const Point2& b, int i, int j) {
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    for (double side : {-1.0, 1.0}) {
      const double t = 0.5 + 0.5 * side * kNodes[k];
      sum += kWeights[k] * std::pow(a.x + t * (b.x - a.x), i + 1) * std::pow(a.y + t * (b.y - a.y), j);
    }
  }
  return 0.5 * sum * (b.y - a.y) / (i + 1);
}

Polygon centred(Polygon polygon) {
  const std::vector<double> m = polygonMoments(polygon, 1);
  for (Point2& p : polygon) p = {p.x - m[1] / m[0], p.y - m[2] / m[0]};
  return polygon;
}

}  // namespace

std::vector<double> polygonMoments(const Polygon& polygon, int order) {
  std::vector<double> m;
  for (int n = 0; n <= order; ++n) {
    for (int j = 0; j <= n; ++j) {
      double sum = 0.0;
      for (std::size_t k = 0; k < polygon.size(); ++k)
        sum += edgeIntegral(polygon[k], polygon[(k + 1) % polygon.size()], n - j, j);
      m.push_back(sum);
    }
  }
  if (m[0] < 0.0)
    for (double& value : m) value = -value;
  return m;
}

std::vector<double> polygonCentredMoments(const Polygon& polygon, int order) {
  return polygonMoments(centred(polygon), order);
}

Polygon project(const Polygon& outline_m, const View& w) {
  const double cz = std::cos(w.yaw_rad), sz = std::sin(w.yaw_rad), cx = std::cos(w.tilt_x_rad),
               sx = std::sin(w.tilt_x_rad), cy = std::cos(w.tilt_y_rad), sy = std::sin(w.tilt_y_rad);
  Polygon image;
  for (const Point2& p : outline_m) {
    const double x1 = cz * p.x - sz * p.y, y1 = sz * p.x + cz * p.y;       // about z
    const double y2 = cx * y1, z2 = sx * y1;                               // about x
    const double x3 = cy * x1 + sy * z2, z3 = -sy * x1 + cy * z2 + w.z_m;  // about y
    image.push_back({(x3 + w.x_m) / z3, (y2 + w.y_m) / z3});
  }
  return image;
}

Polygon blob(double size_m) {
  Polygon p;
  for (int k = 0; k < 48; ++k) {
    const double t = 2.0 * kPi * k / 48;
    const double r = 1.0 + 0.25 * std::cos(t) + 0.22 * std::cos(2.0 * t) + 0.12 * std::cos(3.0 * t + 0.7);
    p.push_back({0.42 * size_m * r * std::cos(t), 0.36 * size_m * r * std::sin(t)});
  }
  return centred(p);
}

Polygon rectangle(double w, double h) { return {{-w / 2, -h / 2}, {w / 2, -h / 2}, {w / 2, h / 2}, {-w / 2, h / 2}}; }

Polygon triangle(double size_m) { return centred({{0.0, 0.0}, {size_m, 0.0}, {0.15 * size_m, 0.6 * size_m}}); }

Polygon ellipse(double a, double b, double angle, Point2 centre, int corners) {
  Polygon p;
  const double c = std::cos(angle), s = std::sin(angle);
  for (int k = 0; k < corners; ++k) {
    const double t = 2.0 * kPi * k / corners, x = a * std::cos(t), y = b * std::sin(t);
    p.push_back({centre.x + c * x - s * y, centre.y + s * x + c * y});
  }
  return p;
}

}  // namespace aras_visual_servo_camera::testing
