#include "points/point_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>

namespace aras_visual_servo_camera {
namespace {

using Complex = std::complex<double>;

// Root of the part of the points' spread that rotation, scale and shift do not explain. A plane tilted by 50 degrees
// leaves 0.25; a rectangle of 3 : 2 laid across itself 0.4.
constexpr double kMaxResidual = 0.5;
constexpr double kEqualResidual = 0.05;               // fits that differ by less are equally good
constexpr double kEqualTurn_rad = 10.0 * M_PI / 180;  // rotations that differ by less are equally near
constexpr double kMaxMove = 0.5;                      // part of the smallest distance between two points

double distance(const ImagePoint& a, const ImagePoint& b) { return std::hypot(a.x - b.x, a.y - b.y); }

double smallestDistance(const std::vector<ImagePoint>& points) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = i + 1; k < points.size(); ++k) least = std::min(least, distance(points[i], points[k]));
  return least;
}

/** Nearest of `found` that is not taken yet and closer than `reach`; -1: none. */
int nearest(const std::vector<ImagePoint>& found, const ImagePoint& to, double reach, const std::vector<bool>& taken) {
  int best = -1;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const double d = distance(found[k], to);
    if (taken[k] || !(d < reach)) continue;
    reach = d;
    best = static_cast<int>(k);
  }
  return best;
}

}  // namespace

void PointTracker::setReference(const std::vector<ImagePoint>& points) {
  reference_ = previous_ = points.size() == count_ ? points : std::vector<ImagePoint>();
}

std::vector<int> PointTracker::match(const std::vector<ImagePoint>& found, double expected_turn_rad) {
  if (found.size() < count_ || ((cyclic_ || reference_.empty()) && found.size() != count_)) return {};
  if (reference_.empty()) return firstOrder(found);
  std::vector<int> indices = nearestToPrevious(found);
  if (indices.empty() && count_ == 1 && found.size() == 1) indices = {0};
  if (indices.empty()) indices = best(cyclic_ ? cyclicFits(found) : patternFits(found), expected_turn_rad);
  if (indices.empty()) return indices;
  previous_.clear();
  for (const int k : indices) previous_.push_back(found[k]);
  return indices;
}

std::vector<int> PointTracker::firstOrder(const std::vector<ImagePoint>& found) const {
  ImagePoint centre{0.0, 0.0};
  for (const ImagePoint& p : found) {
    centre.x += p.x / static_cast<double>(found.size());
    centre.y += p.y / static_cast<double>(found.size());
  }
  std::vector<int> order(found.size());
  std::iota(order.begin(), order.end(), 0);
  if (!cyclic_) {
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return std::atan2(found[a].y - centre.y, found[a].x - centre.x) <
             std::atan2(found[b].y - centre.y, found[b].x - centre.x);
    });
  }
  const auto first = std::min_element(order.begin(), order.end(),
                                      [&](int a, int b) { return found[a].x + found[a].y < found[b].x + found[b].y; });
  std::rotate(order.begin(), first, order.end());
  return order;
}

std::vector<int> PointTracker::nearestToPrevious(const std::vector<ImagePoint>& found) const {
  if (previous_.empty()) return {};
  const double reach = count_ > 1 ? kMaxMove * smallestDistance(previous_) : std::numeric_limits<double>::infinity();
  std::vector<bool> taken(found.size(), false);
  std::vector<int> indices;
  for (const ImagePoint& p : previous_) {
    const int k = nearest(found, p, reach, taken);
    if (k < 0) return {};
    taken[k] = true;
    indices.push_back(k);
  }
  return indices;
}

// Least squares of found = a reference + b in complex numbers: |a| the scale, arg a the rotation.
PointTracker::Fit PointTracker::fit(const std::vector<ImagePoint>& found, std::vector<int> indices) const {
  const double n = static_cast<double>(count_);
  Complex mean_r = 0.0, mean_f = 0.0, product = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    mean_r += Complex(reference_[i].x, reference_[i].y) / n;
    mean_f += Complex(found[indices[i]].x, found[indices[i]].y) / n;
  }
  double square_r = 0.0, square_f = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Complex r = Complex(reference_[i].x, reference_[i].y) - mean_r;
    const Complex f = Complex(found[indices[i]].x, found[indices[i]].y) - mean_f;
    product += f * std::conj(r);
    square_r += std::norm(r);
    square_f += std::norm(f);
  }
  const double scale = square_r * square_f;
  const double residual = scale > 0.0 ? std::sqrt(std::max(0.0, 1.0 - std::norm(product) / scale)) : 0.0;
  return {std::move(indices), residual, std::arg(product)};
}

std::vector<PointTracker::Fit> PointTracker::cyclicFits(const std::vector<ImagePoint>& found) const {
  std::vector<Fit> fits;
  for (std::size_t shift = 0; shift < count_; ++shift) {
    std::vector<int> indices;
    for (std::size_t k = 0; k < count_; ++k) indices.push_back(static_cast<int>((k + shift) % count_));
    fits.push_back(fit(found, std::move(indices)));
  }
  return fits;
}

// The two reference points that are furthest apart are laid on each pair of found points in turn; that fixes where the
// others should be.
std::vector<PointTracker::Fit> PointTracker::patternFits(const std::vector<ImagePoint>& found) const {
  std::size_t a = 0, b = 0;
  for (std::size_t i = 0; i < count_; ++i)
    for (std::size_t k = i + 1; k < count_; ++k)
      if (distance(reference_[i], reference_[k]) > distance(reference_[a], reference_[b])) {
        a = i;
        b = k;
      }
  if (a == b) return {};  // one point among several: nothing tells which
  const Complex ra(reference_[a].x, reference_[a].y), rb(reference_[b].x, reference_[b].y);
  std::vector<Fit> fits;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (i == k) continue;
      const Complex fa(found[i].x, found[i].y), fb(found[k].x, found[k].y), scale = (fb - fa) / (rb - ra);
      const double reach = kMaxMove * std::abs(scale) * smallestDistance(reference_);
      std::vector<bool> taken(found.size(), false);
      std::vector<int> indices;
      for (std::size_t n = 0; n < count_; ++n) {
        const Complex expected = fa + scale * (Complex(reference_[n].x, reference_[n].y) - ra);
        const int at = nearest(found, {expected.real(), expected.imag()}, reach, taken);
        if (at < 0) break;
        taken[at] = true;
        indices.push_back(at);
      }
      if (indices.size() == count_) fits.push_back(fit(found, std::move(indices)));
    }
  }
  return fits;
}

std::vector<int> PointTracker::best(const std::vector<Fit>& fits, double expected_turn_rad) const {
  double least = kMaxResidual;
  for (const Fit& f : fits) least = std::min(least, f.residual);
  const Fit* nearest_fit = nullptr;
  double nearest_turn = 0.0, next_turn = std::numeric_limits<double>::infinity();
  for (const Fit& f : fits) {
    if (f.residual > least + kEqualResidual || f.residual > kMaxResidual) continue;
    const double turn = std::abs(std::remainder(f.turn_rad - expected_turn_rad, 2.0 * M_PI));
    if (nearest_fit == nullptr || turn < nearest_turn) {
      if (nearest_fit != nullptr && nearest_fit->indices != f.indices) next_turn = nearest_turn;
      nearest_fit = &f;
      nearest_turn = turn;
    } else if (f.indices != nearest_fit->indices) {
      next_turn = std::min(next_turn, turn);
    }
  }
  if (nearest_fit == nullptr || next_turn - nearest_turn < kEqualTurn_rad) return {};
  return nearest_fit->indices;
}

}  // namespace aras_visual_servo_camera
