#include "moments/shape.hpp"

#include <cmath>

#include "aras_visual_servo_camera/moments/moments.hpp"

namespace aras_visual_servo_camera {
namespace {

constexpr double kPixelVariance = 1.0 / 12.0;  // a coverage image is the object smeared by one pixel
constexpr double kThinnest = 1e-9;             // of mu20 mu02 - mu11^2 against mu20 mu02: below, a line

}  // namespace

std::optional<ShapeSignature> shapeOf(double m00, const std::vector<double>& mu) {
  if (!(m00 > 0.0) || static_cast<int>(mu.size()) < momentCount(3)) return std::nullopt;
  const double xx = mu[momentIndex(2, 0)] / m00, xy = mu[momentIndex(1, 1)] / m00, yy = mu[momentIndex(0, 2)] / m00;
  const double determinant = xx * yy - xy * xy;
  if (!(xx > 0.0) || !(determinant > kThinnest * xx * yy)) return std::nullopt;
  // x' = a x, y' = b x + c y have second-order moments 1, 0, 1: the inverse of a Cholesky factor.
  const double a = 1.0 / std::sqrt(xx), c = std::sqrt(xx / determinant), b = -c * xy / xx;
  const double m30 = mu[momentIndex(3, 0)] / m00, m21 = mu[momentIndex(2, 1)] / m00, m12 = mu[momentIndex(1, 2)] / m00,
               m03 = mu[momentIndex(0, 3)] / m00;
  const double w30 = a * a * a * m30, w21 = a * a * (b * m30 + c * m21),
               w12 = a * (b * b * m30 + 2.0 * b * c * m21 + c * c * m12),
               w03 = b * b * b * m30 + 3.0 * b * b * c * m21 + 3.0 * b * c * c * m12 + c * c * c * m03;
  return ShapeSignature{4.0 * M_PI * std::sqrt(determinant) / m00, std::hypot(w30 + w12, w21 + w03),
                        std::hypot(w30 - 3.0 * w12, 3.0 * w21 - w03)};
}

std::optional<ShapeSignature> shapeOf(const ObjectMask& mask) {
  double m00 = 0.0;
  std::vector<double> mu(momentCount(3), 0.0);
  const auto add = [&](int u, int v, double weight) {
    const double x = u - mask.u_px, y = v - mask.v_px;
    const double x_powers[] = {1.0, x, x * x, x * x * x}, y_powers[] = {1.0, y, y * y, y * y * y};
    m00 += weight;
    for (int n = 1; n <= 3; ++n)
      for (int j = 0; j <= n; ++j) mu[momentIndex(n - j, j)] += weight * x_powers[n - j] * y_powers[j];
  };
  for (const Span& s : mask.spans)
    for (int u = s.u_begin; u < s.u_end; ++u) add(u, s.v, 1.0);
  for (const EdgePixel& e : mask.edge) add(e.u, e.v, e.weight);
  if (!(m00 > 0.0)) return std::nullopt;
  // The mask's mean is that of whole pixels: on to the centroid of the weights.
  const double x = mu[momentIndex(1, 0)] / m00, y = mu[momentIndex(0, 1)] / m00;
  const double xx = mu[momentIndex(2, 0)], xy = mu[momentIndex(1, 1)], yy = mu[momentIndex(0, 2)];
  mu[momentIndex(3, 0)] += -3.0 * x * xx + 2.0 * x * x * x * m00;
  mu[momentIndex(2, 1)] += -2.0 * x * xy - y * xx + 2.0 * x * x * y * m00;
  mu[momentIndex(1, 2)] += -2.0 * y * xy - x * yy + 2.0 * x * y * y * m00;
  mu[momentIndex(0, 3)] += -3.0 * y * yy + 2.0 * y * y * y * m00;
  const double pixel = mask.soft_edges ? kPixelVariance : 0.0;
  mu[momentIndex(2, 0)] -= (x * x + pixel) * m00;
  mu[momentIndex(1, 1)] -= x * y * m00;
  mu[momentIndex(0, 2)] -= (y * y + pixel) * m00;
  return shapeOf(m00, mu);
}

double dissimilarity(const ShapeSignature& a, const ShapeSignature& b) {
  const double spread = a.spread - b.spread, c21 = a.c21 - b.c21, c30 = a.c30 - b.c30;
  return std::sqrt(spread * spread + c21 * c21 + c30 * c30);
}

}  // namespace aras_visual_servo_camera
