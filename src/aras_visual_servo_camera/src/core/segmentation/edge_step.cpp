#include "segmentation/edge_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aras_visual_servo_camera {
namespace {

constexpr double kOfUniform = 0.28867513459481287;  // standard deviation of an error of up to half a step
constexpr double kMost = 0.5;         // of a step: the most that a side errs by where all pixels err alike
constexpr double kPartly = 1.0 / 32;  // weights nearer to 0 or 1 than this may be noise
constexpr int kSides = 4;             // of an object, each of which errs by itself
constexpr std::size_t kPerBin = 10;   // runs that a bin needs on the average
constexpr double kHardlyAny = 0.1;    // part of the average below which a bin counts as empty
constexpr int kEmptyBins = 3;         // fewer in a row are chance
constexpr double kMoved = 0.05;       // what the object must have moved by for new weights [px]

bool isPartly(double weight) { return weight > kPartly && weight < 1.0 - kPartly; }

/** Calls with the weight of each partly covered pixel, of which there is a whole run where neighbours on the right or
 * below differ by less than this. */
template <typename F>
void forEachRun(const std::vector<EdgePixel>& edge, double less_than, F take) {
  std::size_t below = 0;
  const auto alike = [&](const EdgePixel& a, const EdgePixel& b) { return std::abs(a.weight - b.weight) < less_than; };
  for (std::size_t k = 0; k < edge.size(); ++k) {
    const EdgePixel& pixel = edge[k];
    if (!isPartly(pixel.weight)) continue;
    const auto before = [&](const EdgePixel& other) {
      return other.v < pixel.v + 1 || (other.v == pixel.v + 1 && other.u < pixel.u);
    };
    while (below < edge.size() && before(edge[below])) ++below;
    const bool right = k + 1 < edge.size() && edge[k + 1].v == pixel.v && edge[k + 1].u == pixel.u + 1;
    const bool under = below < edge.size() && edge[below].v == pixel.v + 1 && edge[below].u == pixel.u;
    if (!(right && alike(pixel, edge[k + 1])) && !(under && alike(pixel, edge[below]))) take(pixel.weight);
  }
}

}  // namespace

void EdgeStep::forget() { *this = EdgeStep(); }

double EdgeStep::process(const ObjectMask& mask, int objects) {
  if (!mask.visible) return std::numeric_limits<double>::quiet_NaN();
  if (!mask.soft_edges) return kMost;
  take(mask);
  const double step = std::max(gap(), mask.grey_step), sides = kSides * std::max(objects, 1);
  double runs = 0.0;
  forEachRun(mask.edge, 0.5 * step, [&](double) { runs += 1.0; });
  const double alike = std::sqrt(std::min(1.0, sides / std::max(runs, 1.0)));
  return step * alike * (kOfUniform + (kMost - kOfUniform) * alike);
}

// A camera at rest shows the same few weights again and again; they are counted once.
void EdgeStep::take(const ObjectMask& mask) {
  double area = 0.0, u = 0.0, v = 0.0;
  const auto add = [&](double weight, double at_u, double at_v) {
    area += weight;
    u += weight * at_u;
    v += weight * at_v;
  };
  for (const Span& span : mask.spans) add(span.u_end - span.u_begin, 0.5 * (span.u_begin + span.u_end - 1), span.v);
  for (const EdgePixel& pixel : mask.edge) add(pixel.weight, pixel.u, pixel.v);
  if (!(area > 0.0)) return;
  const std::array<double, 3> place{u / area, v / area, std::sqrt(area)};
  double way = 0.0;
  for (std::size_t i = 0; i < 3; ++i) way = std::max(way, std::abs(place[i] - last_[i]));
  if (way < kMoved) return;
  last_ = place;
  forEachRun(mask.edge, 0.5 / kBins, [&](double weight) {
    ++seen_[std::min(static_cast<int>(weight * kBins), kBins - 1)];
    ++count_;
  });
}

double EdgeStep::gap() const {
  if (count_ < kPerBin * kBins) return 0.0;
  const double few = kHardlyAny * static_cast<double>(count_) / kBins;
  int widest = 0, empty = 0;
  for (int bin = 1; bin < kBins - 1; ++bin) {  // the first and the last hold what may be noise
    empty = static_cast<double>(seen_[bin]) < few ? empty + 1 : 0;
    widest = std::max(widest, empty);
  }
  return widest < kEmptyBins ? 0.0 : static_cast<double>(widest + 1) / kBins;
}

}  // namespace aras_visual_servo_camera
