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

// Row by row: s_i = sum of w x^i, then m_ij += y^j s_i. Spans cost one subtraction of prefix sums. Edge pixels have a y
// of their own.
void MomentAccumulator::sumSeparable(const ObjectMask& mask) {
  const int n = order_ + 1;
  for (auto span = mask.spans.begin(); span != mask.spans.end();) {
    const int v = span->v;
    std::fill(row_.begin(), row_.end(), 0.0);
    for (; span != mask.spans.end() && span->v == v; ++span)
      for (int i = 0; i < n; ++i) row_[i] += prefix_[span->u_end * n + i] - prefix_[span->u_begin * n + i];
    double y_power = map_.area();
    for (int j = 0; j < n; ++j, y_power *= map_.yOfV(v))
      for (int i = 0; i + j < n; ++i) m_[momentIndex(i, j)] += y_power * row_[i];
  }
  for (const EdgePixel& e : mask.edge) addPixel(map_.at(e.u, e.v, e.du, e.dv), e.weight);
}

namespace {

// x^(n - j) y^j of order n from those of order n - 1: multiply all by x, the last also by y. The loops of a known order
// are unrolled.
template <int kOrder>
void addPowers(const PixelMap::Pixel& p, double weight, int order, double* m) {
  const int last = kOrder > 0 ? kOrder : order;
  double terms[16] = {weight * p.area};
  m[0] += terms[0];
  for (int n = 1, k = 1; n <= last; ++n) {
    terms[n] = terms[n - 1] * p.y;
    for (int j = 0; j < n; ++j) terms[j] *= p.x;
    for (int j = 0; j <= n; ++j, ++k) m[k] += terms[j];
  }
}

}  // namespace

void MomentAccumulator::addPixel(const PixelMap::Pixel& p, double weight) {
  if (p.area == 0.0) {
    left_the_lens_ = true;
  } else if (order_ == 4) {
    addPowers<4>(p, weight, order_, m_.data());
  } else if (order_ == 3) {
    addPowers<3>(p, weight, order_, m_.data());
  } else {
    addPowers<0>(p, weight, order_, m_.data());
  }
}

void MomentAccumulator::sumPixels(const ObjectMask& mask) {
  for (const Span& s : mask.spans)
    for (int u = s.u_begin; u < s.u_end; ++u) addPixel(map_.at(u, s.v), 1.0);
  for (const EdgePixel& e : mask.edge) addPixel(map_.at(e.u, e.v, e.du, e.dv), e.weight);
}

// To second order in the size of a pixel, m_ij of the object is larger than the sum over centroids by
// (cxx i (i-1) m_{i-2,j} + 2 cxy i j m_{i-1,j-1} + cyy j (j-1) m_{i,j-2}) / 2, c the second moments of the parts about
// their centroids over the area, variance J J^T with J = d(x, y)/d(u, v). J is taken at the centroid of the object:
// over the object it changes by less than the next order. Lower moments are made use of before they are changed.
void MomentAccumulator::addPixelExtent(const ObjectMask& mask) {
  if (order_ < 2 || !(m_[0] > 0.0)) return;
  double whole = 0.0, parts = 0.0;
  for (const Span& span : mask.spans) whole += span.u_end - span.u_begin;
  for (const EdgePixel& pixel : mask.edge) parts += pixel.weight;
  const double variance = (whole / 12.0 + parts / 16.0) / (whole + parts);
  const std::array<double, 2> centre =
      map_.intrinsics().project(m_[momentIndex(1, 0)] / m_[0], m_[momentIndex(0, 1)] / m_[0]);
  const CameraIntrinsics::Undistorted ray = map_.intrinsics().undistort(centre[0], centre[1]);
  if (!ray.valid) return;
  const auto& J = ray.jacobian;
  const double cxx = variance * (J[0] * J[0] + J[1] * J[1]), cyy = variance * (J[2] * J[2] + J[3] * J[3]);
  const double cxy = variance * (J[0] * J[2] + J[1] * J[3]);
  for (int n = order_; n >= 2; --n) {
    for (int j = 0; j <= n; ++j) {
      const int i = n - j;
      double excess = 0.0;
      if (i >= 2) excess += 0.5 * cxx * i * (i - 1) * m_[momentIndex(i - 2, j)];
      if (i >= 1 && j >= 1) excess += cxy * i * j * m_[momentIndex(i - 1, j - 1)];
      if (j >= 2) excess += 0.5 * cyy * j * (j - 1) * m_[momentIndex(i, j - 2)];
      m_[momentIndex(i, j)] += excess;
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
  if (mask.soft_edges) addPixelExtent(mask);
  return m_;
}

}  // namespace aras_visual_servo_camera
