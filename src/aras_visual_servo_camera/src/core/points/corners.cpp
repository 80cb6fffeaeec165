#include "points/corners.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace aras_visual_servo_camera {
namespace {

constexpr int kMargin = 5;  // of the box around the object [px]: what the windows below look at
// Coverage changes within one pixel of an edge, measured along a row or column that crosses it at 45 degrees or more,
// and the outline runs up to one pixel inside it: two pixels are the least, three leave room for the blur of a lens.
constexpr int kWideWindow = 3, kNarrowWindow = 2;
constexpr float kInside = 0.9f, kOutside = 0.1f;           // what the ends of a window must weigh
constexpr double kMinEpsilon_px = 1.0;                     // of the coarse polygon: the outline's own stairs
constexpr double kEpsilonStep = 1.25, kMaxEpsilon = 0.06;  // part of the outline's length
constexpr int kCornerTrim_px = 4, kMinTrim_px = 2;         // left out at either end of an edge
constexpr double kOutlier = 4.0, kMadToSigma = 1.4826, kMinOutlier_px = 0.05;
constexpr double kMaxRms_px = 0.5;           // of a straight edge; the stairs of a hard mask have 0.3
constexpr double kMinTurn = 0.17;            // sine of the angle of a corner, 10 degrees
constexpr double kMaxCornerOffset_px = 6.0;  // of a corner from the coarse one

}  // namespace

bool CornerFinder::paint(const ObjectMask& mask) {
  if (!mask.visible || mask.touches_border) return false;
  int u_min = mask.width_px, u_max = -1, v_min = mask.height_px, v_max = -1;
  const auto include = [&](int u_first, int u_last, int v) {
    u_min = std::min(u_min, u_first);
    u_max = std::max(u_max, u_last);
    v_min = std::min(v_min, v);
    v_max = std::max(v_max, v);
  };
  for (const Span& s : mask.spans) include(s.u_begin, s.u_end - 1, s.v);
  for (const EdgePixel& e : mask.edge) include(e.u, e.u, e.v);
  if (u_max < u_min) return false;
  u0_ = u_min - kMargin;
  v0_ = v_min - kMargin;
  width_ = u_max - u_min + 1 + 2 * kMargin;
  height_ = v_max - v_min + 1 + 2 * kMargin;
  weights_.assign(static_cast<std::size_t>(width_) * height_, 0.0f);
  for (const Span& s : mask.spans) {
    float* row = weights_.data() + static_cast<std::size_t>(s.v - v0_) * width_ - u0_;
    std::fill(row + s.u_begin, row + s.u_end, 1.0f);
  }
  for (const EdgePixel& e : mask.edge)
    weights_[static_cast<std::size_t>(e.v - v0_) * width_ + (e.u - u0_)] = static_cast<float>(e.weight);
  return true;
}

bool CornerFinder::traceOutline() {
  const cv::Mat weights(height_, width_, CV_32FC1, weights_.data());
  cv::Mat inside = weights >= 0.5f;
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(inside, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  const std::vector<cv::Point>* longest = nullptr;
  for (const auto& outline : outlines)
    if (longest == nullptr || outline.size() > longest->size()) longest = &outline;
  if (longest == nullptr || static_cast<int>(longest->size()) < 3 * count_) return false;
  outline_.clear();
  ideal_.clear();
  const CameraIntrinsics& camera = map_.intrinsics();
  for (const cv::Point& p : *longest) {
    const Pixel pixel{p.x + u0_, p.y + v0_};
    const PixelMap::Pixel ray = map_.at(pixel.u, pixel.v);
    if (ray.area == 0.0) return false;
    outline_.push_back(pixel);
    ideal_.push_back(static_cast<float>(ray.x * camera.fx()));
    ideal_.push_back(static_cast<float>(ray.y * camera.fy()));
  }
  return true;
}

// The finest polygon of at most `count_` corners must have exactly as many.
bool CornerFinder::coarseCorners() {
  const cv::Mat points(static_cast<int>(outline_.size()), 1, CV_32FC2, ideal_.data());
  std::vector<cv::Point2f> polygon;
  const double most = std::max(kMinEpsilon_px * kEpsilonStep, kMaxEpsilon * static_cast<double>(outline_.size()));
  for (double epsilon = kMinEpsilon_px; epsilon <= most; epsilon *= kEpsilonStep) {
    cv::approxPolyDP(points, polygon, epsilon, true);
    if (static_cast<int>(polygon.size()) <= count_) break;
  }
  if (static_cast<int>(polygon.size()) != count_) return false;
  corners_.clear();
  for (const cv::Point2f& corner : polygon) {
    std::size_t k = 0;
    while (k < outline_.size() && (ideal_[2 * k] != corner.x || ideal_[2 * k + 1] != corner.y)) ++k;
    corners_.push_back(k);
  }
  std::sort(corners_.begin(), corners_.end());
  return std::adjacent_find(corners_.begin(), corners_.end()) == corners_.end() && corners_.back() < outline_.size();
}

bool CornerFinder::crossing(const Pixel& at, bool along_v, ImagePoint* point) const {
  for (const int half : {kWideWindow, kNarrowWindow}) {
    double sum = 0.0;
    float first = 0.0f, last = 0.0f;
    for (int k = -half; k <= half; ++k) {
      const float w = along_v ? weight(at.u, at.v + k) : weight(at.u + k, at.v);
      if (k == -half) first = w;
      last = w;
      sum += static_cast<double>(w);
    }
    const bool begins_outside = first <= kOutside && last >= kInside;
    if (!begins_outside && !(first >= kInside && last <= kOutside)) continue;
    const double offset = begins_outside ? half + 0.5 - sum : sum - half - 0.5;
    const double u = at.u + (along_v ? 0.0 : offset), v = at.v + (along_v ? offset : 0.0);
    const CameraIntrinsics::Undistorted ray = map_.intrinsics().undistort(u, v);
    *point = {ray.x, ray.y};
    return ray.valid;
  }
  return false;
}

// Total least squares: the axis of the points' second moments.
bool CornerFinder::throughPoints(Line* line) {
  const double n = static_cast<double>(samples_.size());
  if (n < 2.0) return false;
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (const ImagePoint& p : samples_) {
    x += p.x / n;
    y += p.y / n;
  }
  for (const ImagePoint& p : samples_) {
    xx += (p.x - x) * (p.x - x);
    xy += (p.x - x) * (p.y - y);
    yy += (p.y - y) * (p.y - y);
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  *line = {x, y, std::cos(angle), std::sin(angle)};
  distances_.clear();
  for (const ImagePoint& p : samples_) distances_.push_back((p.y - y) * line->dx - (p.x - x) * line->dy);
  return true;
}

// From corner to corner along the outline; indices modulo its length.
bool CornerFinder::fitEdge(std::size_t first, std::size_t last, Line* line) {
  const std::size_t n = outline_.size();
  const Pixel a = outline_[first % n], b = outline_[last % n];
  const int du = std::abs(b.u - a.u), dv = std::abs(b.v - a.v);
  const bool along_v = du >= dv;
  const int trim = std::clamp(std::max(du, dv) / 4, kMinTrim_px, kCornerTrim_px);
  const auto near = [trim](const Pixel& p, const Pixel& corner) {
    return std::max(std::abs(p.u - corner.u), std::abs(p.v - corner.v)) < trim;
  };
  samples_.clear();
  int previous = -1;
  for (std::size_t k = first; k <= last; ++k) {
    const Pixel& p = outline_[k % n];
    const int position = along_v ? p.u : p.v;
    if (position == previous || near(p, a) || near(p, b)) continue;
    previous = position;
    ImagePoint point;
    if (crossing(p, along_v, &point)) samples_.push_back(point);
  }
  if (!throughPoints(line)) return false;

  std::vector<double> magnitudes;
  for (const double d : distances_) magnitudes.push_back(std::abs(d));
  std::nth_element(magnitudes.begin(), magnitudes.begin() + magnitudes.size() / 2, magnitudes.end());
  const double pixel = 1.0 / std::sqrt(map_.intrinsics().fx() * map_.intrinsics().fy());
  const double most = std::max(kOutlier * kMadToSigma * magnitudes[magnitudes.size() / 2], kMinOutlier_px * pixel);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < samples_.size(); ++k)
    if (std::abs(distances_[k]) <= most) samples_[kept++] = samples_[k];
  samples_.resize(kept);
  if (!throughPoints(line)) return false;
  double squares = 0.0;
  for (const double d : distances_) squares += d * d;
  return squares <= kMaxRms_px * kMaxRms_px * pixel * pixel * static_cast<double>(kept);
}

std::vector<ImagePoint> CornerFinder::find(const ObjectMask& mask) {
  if (!paint(mask) || !traceOutline() || !coarseCorners()) return {};
  const std::size_t count = corners_.size();
  std::vector<Line> lines(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t last = k + 1 < count ? corners_[k + 1] : corners_[0] + outline_.size();
    if (!fitEdge(corners_[k], last, &lines[k])) return {};
  }
  std::vector<ImagePoint> found;
  double twice_area = 0.0;
  const CameraIntrinsics& camera = map_.intrinsics();
  for (std::size_t k = 0; k < count; ++k) {  // corner k: where the edge before it meets the edge after it
    const Line &a = lines[(k + count - 1) % count], &b = lines[k];
    const double sine = a.dx * b.dy - a.dy * b.dx;
    if (std::abs(sine) < kMinTurn) return {};
    const double t = ((b.x - a.x) * b.dy - (b.y - a.y) * b.dx) / sine;
    found.push_back({a.x + t * a.dx, a.y + t * a.dy});
    const double off_u = found.back().x * camera.fx() - static_cast<double>(ideal_[2 * corners_[k]]);
    const double off_v = found.back().y * camera.fy() - static_cast<double>(ideal_[2 * corners_[k] + 1]);
    if (std::hypot(off_u, off_v) > kMaxCornerOffset_px) return {};
  }
  for (std::size_t k = 0; k < count; ++k) {
    const ImagePoint &p = found[k], &q = found[(k + 1) % count];
    twice_area += p.x * q.y - q.x * p.y;
  }
  if (twice_area < 0.0) std::reverse(found.begin(), found.end());
  return found;
}

}  // namespace aras_visual_servo_camera
