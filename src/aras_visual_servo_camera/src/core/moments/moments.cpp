#include "aras_visual_servo_camera/moments/moments.hpp"

#include <algorithm>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {

std::vector<std::string> momentNames(int order) {
  std::vector<std::string> names;
  for (int n = 0; n <= order; ++n)
    for (int j = 0; j <= n; ++j) names.push_back(std::to_string(n - j) + std::to_string(j));
  return names;
}

MomentAccumulator::MomentAccumulator(const PixelMap& map, int order) : map_(map), order_(order) {
  m_.resize(momentCount(order));
  row_.resize(order + 1);
  if (!map.separable()) return;
  const int n = order + 1;
  prefix_.assign(static_cast<std::size_t>(map.width() + 1) * n, 0.0);
  for (int u = 0; u < map.width(); ++u) {
    double power = 1.0;
    for (int i = 0; i < n; ++i, power *= map.xOfU()[u]) prefix_[(u + 1) * n + i] = prefix_[u * n + i] + power;
  }
}

// Row by row: s_i = sum of w x^i, then m_ij += y^j s_i. Spans cost one subtraction of prefix sums.
void MomentAccumulator::sumSeparable(const ObjectMask& mask) {
  const int n = order_ + 1;
  auto span = mask.spans.begin();
  auto edge = mask.edge.begin();
  while (span != mask.spans.end() || edge != mask.edge.end()) {
    int v = map_.height();
    if (span != mask.spans.end()) v = span->v;
    if (edge != mask.edge.end()) v = std::min(v, edge->v);
    std::fill(row_.begin(), row_.end(), 0.0);
    for (; span != mask.spans.end() && span->v == v; ++span)
      for (int i = 0; i < n; ++i) row_[i] += prefix_[span->u_end * n + i] - prefix_[span->u_begin * n + i];
    for (; edge != mask.edge.end() && edge->v == v; ++edge) {
      double term = edge->weight;
      const double x = map_.xOfU()[edge->u];
      for (int i = 0; i < n; ++i, term *= x) row_[i] += term;
    }
    double y_power = map_.area();
    for (int j = 0; j < n; ++j, y_power *= map_.yOfV(v))
      for (int i = 0; i + j < n; ++i) m_[momentIndex(i, j)] += y_power * row_[i];
  }
}

void MomentAccumulator::addPixel(int u, int v, double weight) {
  const PixelMap::Pixel p = map_.at(u, v);
  if (p.area == 0.0) {
    left_the_lens_ = true;
    return;
  }
  double* m = m_.data();
  double x_power =
      weight * p.area;  // x^(n - j) y^j of order n from those of order n - 1: multiply all by x, last also by y
  double terms[16] = {x_power};
  m[0] += x_power;
  for (int n = 1, k = 1; n <= order_; ++n) {
    terms[n] = terms[n - 1] * p.y;
    for (int j = 0; j < n; ++j) terms[j] *= p.x;
    for (int j = 0; j <= n; ++j, ++k) m[k] += terms[j];
  }
}

void MomentAccumulator::sumPixels(const ObjectMask& mask) {
  for (const Span& s : mask.spans)
    for (int u = s.u_begin; u < s.u_end; ++u) addPixel(u, s.v, 1.0);
  for (const EdgePixel& e : mask.edge) addPixel(e.u, e.v, e.weight);
}

// To second order in the size of a pixel, m_ij of the smeared object is larger by
// (cxx i (i-1) m_{i-2,j} + 2 cxy i j m_{i-1,j-1} + cyy j (j-1) m_{i,j-2}) / 2, c the second moments of one pixel over
// its area, (1/12) J J^T with J = d(x, y)/d(u, v). J is taken at the centroid: over the object it changes by less than
// the next order. Lower moments must be undone first.
void MomentAccumulator::undoPixelExtent() {
  if (order_ < 2 || !(m_[0] > 0.0)) return;
  constexpr double kPixelVariance = 1.0 / 12.0;
  const std::array<double, 2> centre =
      map_.intrinsics().project(m_[momentIndex(1, 0)] / m_[0], m_[momentIndex(0, 1)] / m_[0]);
  const CameraIntrinsics::Undistorted ray = map_.intrinsics().undistort(centre[0], centre[1]);
  if (!ray.valid) return;
  const auto& J = ray.jacobian;
  const double cxx = kPixelVariance * (J[0] * J[0] + J[1] * J[1]), cyy = kPixelVariance * (J[2] * J[2] + J[3] * J[3]);
  const double cxy = kPixelVariance * (J[0] * J[2] + J[1] * J[3]);
  for (int n = 2; n <= order_; ++n) {
    for (int j = 0; j <= n; ++j) {
      const int i = n - j;
      double excess = 0.0;
      if (i >= 2) excess += 0.5 * cxx * i * (i - 1) * m_[momentIndex(i - 2, j)];
      if (i >= 1 && j >= 1) excess += cxy * i * j * m_[momentIndex(i - 1, j - 1)];
      if (j >= 2) excess += 0.5 * cyy * j * (j - 1) * m_[momentIndex(i, j - 2)];
      m_[momentIndex(i, j)] -= excess;
    }
  }
}

const std::vector<double>& MomentAccumulator::process(const ObjectMask& mask) {
  if (mask.width_px != map_.width() || mask.height_px != map_.height())
    throw ShapeError("mask: found " + std::to_string(mask.width_px) + " x " + std::to_string(mask.height_px) +
                     ", allowed " + std::to_string(map_.width()) + " x " + std::to_string(map_.height()));
  std::fill(m_.begin(), m_.end(), 0.0);
  left_the_lens_ = false;
  if (map_.separable()) {
    sumSeparable(mask);
  } else {
    sumPixels(mask);
  }
  if (mask.soft_edges) undoPixelExtent();
  return m_;
}

}  // namespace aras_visual_servo_camera
