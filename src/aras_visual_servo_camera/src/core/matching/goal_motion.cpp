#include "matching/goal_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <random>

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

namespace {

using Points = std::vector<cv::Vec3d>;

constexpr double kMotionConfidence = 0.999;
constexpr int kMotionRounds = 3;         // of least squares and new choice of the inliers
constexpr int kSteps = 5;                // of Gauss and Newton in a round
constexpr double kLeastSpread = 1e-3;    // second singular value of the points over the first: below, a line
constexpr double kDepthWeight = 0.1;     // a relative error of depth counts as this times it in the image
constexpr double kDepthTolerance = 0.1;  // relative error of depth of an inlier

/** Absolute orientation of the points of these indices; none if they lie on a line. */
std::optional<RigidMotion> orientation(const Points& goal, const Points& here, const std::vector<int>& of) {
  cv::Vec3d a, b;
  const double n = static_cast<double>(of.size());
  for (int k : of) {
    a += goal[static_cast<std::size_t>(k)] / n;
    b += here[static_cast<std::size_t>(k)] / n;
  }
  cv::Matx33d M = cv::Matx33d::zeros();
  for (int k : of) {
    M += (here[static_cast<std::size_t>(k)] - b) * (goal[static_cast<std::size_t>(k)] - a).t();
  }
  cv::Matx31d sigmas;
  cv::Matx33d U, Vt;
  cv::SVD::compute(M, sigmas, U, Vt);
  if (!(sigmas(1) > kLeastSpread * kLeastSpread * sigmas(0))) return std::nullopt;
  const double sign = cv::determinant(U) * cv::determinant(Vt) > 0.0 ? 1.0 : -1.0;
  RigidMotion motion;
  motion.R = U * cv::Matx33d::diag({1.0, 1.0, sign}) * Vt;
  motion.t = b - motion.R * a;
  return motion;
}

/** Square of the distance in the image [px^2] from where the motion puts a point; infinite if its depth disagrees. */
double off2(const RigidMotion& motion, const cv::Vec3d& goal, const cv::Vec3d& here, double focal_px) {
  const cv::Vec3d P = motion.apply(goal);
  if (!(P[2] > 0.0) || std::abs(P[2] - here[2]) > kDepthTolerance * here[2]) return INFINITY;
  const double du = focal_px * (P[0] / P[2] - here[0] / here[2]), dv = focal_px * (P[1] / P[2] - here[1] / here[2]);
  return du * du + dv * dv;
}

/** Takes the inliers of the motion. @return their cost: squares, and the square of the bound for each other point */
double choose(RigidMotion* motion, const Points& goal, const Points& here, double focal_px, double bound_px) {
  const double bound2 = bound_px * bound_px;
  double cost = 0.0, squares = 0.0;
  motion->inliers.clear();
  for (std::size_t k = 0; k < goal.size(); ++k) {
    const double square = off2(*motion, goal[k], here[k], focal_px);
    cost += std::min(square, bound2);
    if (!(square <= bound2)) continue;
    squares += square;
    motion->inliers.push_back(static_cast<int>(k));
  }
  motion->rms_px = std::sqrt(squares / std::max<double>(1.0, static_cast<double>(motion->inliers.size())));
  return cost;
}

/** One step of Gauss and Newton on x, y and ln Z of the inliers. @return whether there is one */
bool refine(RigidMotion* motion, const Points& goal, const Points& here) {
  cv::Matx66d H = cv::Matx66d::zeros();
  cv::Vec6d g;
  for (int k : motion->inliers) {
    const cv::Vec3d P = motion->apply(goal[static_cast<std::size_t>(k)]), &Q = here[static_cast<std::size_t>(k)];
    if (!(P[2] > 0.0)) return false;
    const double x = P[0] / P[2], y = P[1] / P[2], w = 1.0 / P[2], d = kDepthWeight;
    // of the point as the things move with [v; w] in the camera frame: P' = v + w x P
    const std::array<cv::Vec6d, 3> rows{cv::Vec6d(w, 0.0, -x * w, -x * y, 1.0 + x * x, -y),
                                        cv::Vec6d(0.0, w, -y * w, -1.0 - y * y, x * y, x),
                                        cv::Vec6d(0.0, 0.0, d * w, d * y, -d * x, 0.0)};
    const std::array<double, 3> left{Q[0] / Q[2] - x, Q[1] / Q[2] - y, d * std::log(Q[2] * w)};
    for (std::size_t r = 0; r < rows.size(); ++r) {
      H += rows[r] * rows[r].t();
      g += rows[r] * left[r];
    }
  }
  cv::Vec6d step;
  if (!cv::solve(H, g, step, cv::DECOMP_CHOLESKY)) return false;
  cv::Matx33d turn;
  cv::Rodrigues(cv::Vec3d(step[3], step[4], step[5]), turn);
  motion->R = turn * motion->R;
  motion->t = turn * motion->t + cv::Vec3d(step[0], step[1], step[2]);
  return true;
}

}  // namespace

std::optional<RigidMotion> findRigidMotion(const Points& goal, const Points& here, double focal_px,
                                           const MatchingConfig& config) {
  const auto least = static_cast<std::size_t>(config.min_matches);
  if (goal.size() < least) return std::nullopt;
  std::mt19937 random(static_cast<std::uint32_t>(config.seed));
  const auto any = [&] { return static_cast<int>(random() % goal.size()); };
  std::optional<RigidMotion> best;
  double best_cost = INFINITY;
  double needed = config.iterations;
  for (int trial = 0; trial < config.iterations && trial < needed; ++trial) {
    const std::vector<int> sample{any(), any(), any()};
    if (sample[0] == sample[1] || sample[0] == sample[2] || sample[1] == sample[2]) continue;
    std::optional<RigidMotion> motion = orientation(goal, here, sample);
    if (!motion) continue;
    const double cost = choose(&*motion, goal, here, focal_px, config.inlier_px);
    if (!(cost < best_cost)) continue;
    best_cost = cost;
    const double part = static_cast<double>(motion->inliers.size()) / static_cast<double>(goal.size());
    const double whole = part * part * part;  // of samples without a wrong match
    if (whole > 0.0) needed = whole < 1.0 ? std::log(1.0 - kMotionConfidence) / std::log1p(-whole) : 0.0;
    best = std::move(motion);
  }
  if (!best) return std::nullopt;
  for (int round = 0; round < kMotionRounds; ++round) {
    if (best->inliers.size() < least) return std::nullopt;
    for (int step = 0; step < kSteps; ++step)
      if (!refine(&*best, goal, here)) return std::nullopt;
    choose(&*best, goal, here, focal_px, config.inlier_px);
  }
  if (best->inliers.size() < least) return std::nullopt;
  return best;
}

}  // namespace aras_visual_servo_camera
