#include "tags/tag_sides.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

namespace aras_visual_servo_camera {
namespace {

constexpr int kPoints = 17, kLeastPoints = 6;        // along a side
constexpr double kFirst = 0.1, kLast = 0.9;          // parts of a side between which they lie: its ends show corners
constexpr double kStep_px = 0.25, kContrast = 20.0;  // across it; an edge rises by this many grey levels
constexpr double kParallel = 1e-6;

/** Bilinear; NaN outside the image. */
double greyAt(const cv::Mat& grey, double u, double v) {
  const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
  if (i < 0 || j < 0 || i + 1 >= grey.cols || j + 1 >= grey.rows) return std::nan("");
  const double a = u - i, b = v - j;
  const auto *upper = grey.ptr<unsigned char>(j), *lower = grey.ptr<unsigned char>(j + 1);
  return (1 - b) * ((1 - a) * upper[i] + a * upper[i + 1]) + b * ((1 - a) * lower[i] + a * lower[i + 1]);
}

/** Where along the way out of the square, from `middle`, grey rises: the mean place of its increase. */
std::optional<double> edgeAcross(const cv::Mat& grey, const cv::Point2d& middle, const cv::Point2d& out,
                                 double reach_px) {
  double rise = 0.0, moment = 0.0, last = greyAt(grey, middle.x - reach_px * out.x, middle.y - reach_px * out.y);
  const int steps = static_cast<int>(std::lround(2.0 * reach_px / kStep_px));
  for (int k = 1; k <= steps; ++k) {
    const double at = -reach_px + k * kStep_px;
    const double here = greyAt(grey, middle.x + at * out.x, middle.y + at * out.y);
    const double more = std::max(here - last, 0.0);
    rise += more;
    moment += more * (at - 0.5 * kStep_px);
    last = here;
    if (!std::isfinite(here)) return std::nullopt;
  }
  if (!(rise >= kContrast)) return std::nullopt;
  return moment / rise;
}

/** Line (a, b, c), a x + b y + c = 0, through points, by least squares of the distances. */
cv::Vec3d lineThrough(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) middle += p / static_cast<double>(points.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& p : points) spread += (p - middle) * (p - middle).transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(spread);
  const Eigen::Vector2d normal = solver.eigenvectors().col(0);
  return {normal.x(), normal.y(), -normal.dot(middle)};
}

}  // namespace

std::optional<std::array<cv::Point2d, 4>> cornersOfSides(const cv::Mat& grey,
                                                         const std::array<cv::Point2d, 4>& corners_px, double reach_px,
                                                         const CameraIntrinsics& intrinsics) {
  std::array<cv::Vec3d, 4> lines;
  for (std::size_t k = 0; k < 4; ++k) {
    const cv::Point2d a = corners_px[k], way = corners_px[(k + 1) % 4] - a;
    const cv::Point2d out = cv::Point2d(way.y, -way.x) / cv::norm(way);  // the corners go clockwise
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < kPoints; ++i) {
      const cv::Point2d middle = a + (kFirst + (kLast - kFirst) * i / (kPoints - 1)) * way;
      const std::optional<double> at = edgeAcross(grey, middle, out, reach_px);
      if (!at) continue;
      const auto ray = intrinsics.undistort(middle.x + *at * out.x, middle.y + *at * out.y);
      if (ray.valid) points.emplace_back(ray.x, ray.y);
    }
    if (static_cast<int>(points.size()) < kLeastPoints) return std::nullopt;
    lines[k] = lineThrough(points);
  }
  std::array<cv::Point2d, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) {
    const cv::Vec3d meet = lines[(k + 3) % 4].cross(lines[k]);
    if (!(std::abs(meet[2]) > kParallel)) return std::nullopt;
    corners[k] = {meet[0] / meet[2], meet[1] / meet[2]};
  }
  return corners;
}

}  // namespace aras_visual_servo_camera
