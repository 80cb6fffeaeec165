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

}  // namespace

void EdgeStep::forget() { *this = EdgeStep(); }

double EdgeStep::process(const ObjectMask& mask, int objects) {
  if (!mask.visible) return std::numeric_limits<double>::quiet_NaN();
  if (!mask.soft_edges) return kMost;
  compare(mask.edge);
  if (hasMoved(mask)) take();
  const double step = std::max(gap(), mask.grey_step), sides = kSides * std::max(objects, 1);
  const auto ends = [step](const Partly& pixel) { return pixel.difference >= 0.5 * step; };
  const auto runs = static_cast<double>(std::count_if(pixels_.begin(), pixels_.end(), ends));
  const double alike = std::sqrt(std::min(1.0, sides / std::max(runs, 1.0)));
  return step * alike * (kOfUniform + (kMost - kOfUniform) * alike);
}

void EdgeStep::compare(const std::vector<EdgePixel>& edge) {
  pixels_.clear();
  std::size_t below = 0;
  for (std::size_t k = 0; k < edge.size(); ++k) {
    const EdgePixel& pixel = edge[k];
    if (!isPartly(pixel.weight)) continue;
    const auto before = [&](const EdgePixel& other) {
      return other.v < pixel.v + 1 || (other.v == pixel.v + 1 && other.u < pixel.u);
    };
    while (below < edge.size() && before(edge[below])) ++below;
    double difference = std::numeric_limits<double>::infinity();
    const auto compareWith = [&](std::size_t other, int v, int u) {
      if (other < edge.size() && edge[other].v == v && edge[other].u == u)
        difference = std::min(difference, std::abs(pixel.weight - edge[other].weight));
    };
    compareWith(k + 1, pixel.v, pixel.u + 1);
    compareWith(below, pixel.v + 1, pixel.u);
    pixels_.push_back({pixel.weight, difference});
  }
}

// A camera at rest shows the same few weights again and again; they are counted once.
bool EdgeStep::hasMoved(const ObjectMask& mask) {
  double area = 0.0, u = 0.0, v = 0.0;
  const auto add = [&](double weight, double at_u, double at_v) {
    area += weight;
    u += weight * at_u;
    v += weight * at_v;
  };
  for (const Span& span : mask.spans) add(span.u_end - span.u_begin, 0.5 * (span.u_begin + span.u_end - 1), span.v);
  for (const EdgePixel& pixel : mask.edge) add(pixel.weight, pixel.u, pixel.v);
  if (!(area > 0.0)) return false;
  const std::array<double, 3> place{u / area, v / area, std::sqrt(area)};
  double way = 0.0;
  for (std::size_t i = 0; i < 3; ++i) way = std::max(way, std::abs(place[i] - last_[i]));
  if (way < kMoved) return false;
  last_ = place;
  return true;
}

void EdgeStep::take() {
  for (const Partly& pixel : pixels_) {
    if (pixel.difference < 0.5 / kBins) continue;
    ++seen_[std::min(static_cast<int>(pixel.weight * kBins), kBins - 1)];
    ++count_;
  }
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
