#include "matching/plane_homography.hpp"

#include <cmath>
#include <opencv2/calib3d.hpp>

namespace aras_visual_servo_camera {
namespace {

constexpr double kLargestScale = 20.0;    // of lengths in the image against those in the goal
constexpr double kLargestSqueeze = 12.0;  // a plane seen at 85 deg from its normal
constexpr double kPlaneConfidence = 0.999;
constexpr int kPlaneRounds = 2;  // of least squares and new choice of the inliers

std::vector<cv::Point2d> scaled(const std::vector<cv::Point2d>& points, double focal_px) {
  std::vector<cv::Point2d> result(points);
  for (cv::Point2d& p : result) p *= focal_px;
  return result;
}

/** Whether a homography in front of the camera can show the plane so, near the middle of these points. */
bool possible(const cv::Matx33d& H, const std::vector<cv::Point2d>& goal) {
  cv::Point2d middle;
  for (const cv::Point2d& p : goal) middle += p / static_cast<double>(goal.size());
  for (const cv::Point2d& p : goal)
    if (!(H(2, 0) * p.x + H(2, 1) * p.y + H(2, 2) > 0.0)) return false;
  const double w = H(2, 0) * middle.x + H(2, 1) * middle.y + H(2, 2);
  const double u = (H(0, 0) * middle.x + H(0, 1) * middle.y + H(0, 2)) / w;
  const double v = (H(1, 0) * middle.x + H(1, 1) * middle.y + H(1, 2)) / w;
  const cv::Matx22d A((H(0, 0) - u * H(2, 0)) / w, (H(0, 1) - u * H(2, 1)) / w, (H(1, 0) - v * H(2, 0)) / w,
                      (H(1, 1) - v * H(2, 1)) / w);
  cv::Matx21d sigmas;
  cv::SVD::compute(A, sigmas, cv::noArray(), cv::noArray());
  return cv::determinant(A) > 0.0 && sigmas(0) < kLargestScale && sigmas(1) > 1.0 / kLargestScale &&
         sigmas(0) < kLargestSqueeze * sigmas(1);
}

}  // namespace

cv::Point2d PlaneHomography::apply(const cv::Point2d& p) const {
  const cv::Vec3d q = H * cv::Vec3d(p.x, p.y, 1.0);
  return {q[0] / q[2], q[1] / q[2]};
}

std::optional<PlaneHomography> findHomography(const std::vector<cv::Point2d>& goal,
                                              const std::vector<cv::Point2d>& image, double focal_px,
                                              const MatchingConfig& config) {
  const auto least = static_cast<std::size_t>(config.min_matches);
  if (goal.size() < least) return std::nullopt;
  const std::vector<cv::Point2d> from = scaled(goal, focal_px), to = scaled(image, focal_px);
  cv::UsacParams ransac;
  ransac.confidence = kPlaneConfidence;
  ransac.isParallel = false;
  ransac.maxIterations = config.iterations;
  ransac.randomGeneratorState = config.seed;
  ransac.sampler = cv::SAMPLING_UNIFORM;
  ransac.score = cv::SCORE_METHOD_MSAC;
  ransac.loMethod = cv::LOCAL_OPTIM_INNER_LO;
  ransac.threshold = config.inlier_px;
  cv::Mat ignored, H = cv::findHomography(from, to, ignored, ransac);
  PlaneHomography found;
  for (int round = 0; round <= kPlaneRounds; ++round) {
    if (H.empty() || !cv::checkRange(H)) return std::nullopt;
    found.H = cv::Matx33d(H);
    found.inliers.clear();
    std::vector<cv::Point2d> a, b;
    double squares = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const cv::Point2d off = found.apply(from[i]) - to[i];
      const double square = off.dot(off);
      if (!(square <= config.inlier_px * config.inlier_px)) continue;
      found.inliers.push_back(static_cast<int>(i));
      a.push_back(from[i]);
      b.push_back(to[i]);
      squares += square;
    }
    if (a.size() < least) return std::nullopt;
    found.rms_px = std::sqrt(squares / static_cast<double>(a.size()));
    if (round < kPlaneRounds) H = cv::findHomography(a, b, 0);
  }
  const cv::Matx33d to_px = cv::Matx33d::diag({focal_px, focal_px, 1.0});
  const cv::Matx33d from_px = cv::Matx33d::diag({1.0 / focal_px, 1.0 / focal_px, 1.0});
  found.H = from_px * found.H * to_px;
  cv::Vec3d sigmas;
  cv::SVD::compute(found.H, sigmas, cv::noArray(), cv::noArray());
  found.H = found.H * ((cv::determinant(found.H) > 0.0 ? 1.0 : -1.0) / sigmas[1]);
  std::vector<cv::Point2d> agreeing;
  for (int i : found.inliers) agreeing.push_back(goal[static_cast<std::size_t>(i)]);
  if (!possible(found.H, agreeing)) return std::nullopt;
  return found;
}

}  // namespace aras_visual_servo_camera
