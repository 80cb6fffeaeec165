// The homography of matches, some of them wrong, and which ones no camera before the plane could see.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <random>

#include "matching/goal_motion.hpp"

namespace aras_visual_servo_camera::plane_homography_test {
namespace {

constexpr double kFocal_px = 200.0;
constexpr double kSingle = 1e-5;  // OpenCV fits in single precision: 2^-24 of 200 px, and as much again of the solution

MatchingConfig usual() { return readMatchingConfig(YAML::Node()); }

/** Points of a goal and where H puts them, every `wrong`-th of them somewhere else. */
void makeMatches(const cv::Matx33d& H, int count, int wrong, std::vector<cv::Point2d>* goal,
                 std::vector<cv::Point2d>* image) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  for (int i = 0; i < count; ++i) {
    goal->push_back({within(random), within(random)});
    image->push_back(PlaneHomography{H, {}, 0.0}.apply(goal->back()));
    if (i % wrong == 0) image->back() = {within(random), within(random)};
  }
}

TEST(PlaneHomography, IsFoundAmongWrongMatches) {
  const cv::Matx33d H(0.9, -0.3, 0.05, 0.25, 0.8, -0.1, 0.1, -0.2, 1.0);
  std::vector<cv::Point2d> goal, image;
  makeMatches(H, 120, 2, &goal, &image);
  const auto found = findHomography(goal, image, kFocal_px, usual());
  ASSERT_TRUE(found);
  EXPECT_GE(found->inliers.size(), 60u);
  for (const cv::Point2d& p : goal)
    EXPECT_LT(cv::norm(found->apply(p) - PlaneHomography{H, {}, 0.0}.apply(p)),
              10 * kSingle + found->rms_px / kFocal_px);
  cv::Vec3d sigmas;
  cv::SVD::compute(found->H, sigmas, cv::noArray(), cv::noArray());
  EXPECT_NEAR(sigmas[1], 1.0, 1e-12);
}

TEST(PlaneHomography, IsNotFoundWhereThePlaneWouldBeSeenFromBehindOrTooFewAgree) {
  std::vector<cv::Point2d> goal, image;
  makeMatches(cv::Matx33d(-1, 0, 0, 0, 1, 0, 0, 0, 1), 60, 100, &goal, &image);
  EXPECT_FALSE(findHomography(goal, image, kFocal_px, usual()));
  goal.clear();
  image.clear();
  makeMatches(cv::Matx33d::eye(), 11, 100, &goal, &image);
  EXPECT_FALSE(findHomography(goal, image, kFocal_px, usual()));
}

/** Whether the homography of matches without a wrong one is taken. */
bool taken(const cv::Matx33d& H) {
  std::vector<cv::Point2d> goal, image;
  makeMatches(H, 60, 100, &goal, &image);
  MatchingConfig config = usual();
  config.inlier_px = 0.1;  // of an image that may be some ten pixels wide
  return findHomography(goal, image, kFocal_px, config).has_value();
}

TEST(PlaneHomography, IsTakenUpToTwentyTimesAsLargeOrAsSmall) {
  EXPECT_TRUE(taken(cv::Matx33d::diag({19.0, 19.0, 1.0})));
  EXPECT_FALSE(taken(cv::Matx33d::diag({21.0, 21.0, 1.0})));
  EXPECT_TRUE(taken(cv::Matx33d::diag({1.0 / 19.0, 1.0 / 19.0, 1.0})));
  EXPECT_FALSE(taken(cv::Matx33d::diag({1.0 / 21.0, 1.0 / 21.0, 1.0})));
}

TEST(PlaneHomography, IsTakenUpToATwelfthOfTheWidth) {
  EXPECT_TRUE(taken(cv::Matx33d::diag({1.0 / 11.0, 1.0, 1.0})));
  EXPECT_FALSE(taken(cv::Matx33d::diag({1.0 / 13.0, 1.0, 1.0})));
  EXPECT_TRUE(taken(cv::Matx33d::diag({1.0, 1.0 / 11.0, 1.0})));
  EXPECT_FALSE(taken(cv::Matx33d::diag({1.0, 1.0 / 13.0, 1.0})));
}

TEST(PlaneHomography, IsNotTakenWhereAPartOfThePlaneLiesBehindTheCamera) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_TRUE(taken({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, sign, 0.0, 1.0}));
    EXPECT_FALSE(taken({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 3.0 * sign, 0.0, 1.0}));
    EXPECT_TRUE(taken({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, sign, 1.0}));
    EXPECT_FALSE(taken({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 3.0 * sign, 1.0}));
  }
}

TEST(PlaneHomography, IsNotFoundFromPointsOnALineOrInOnePlace) {
  const std::vector<cv::Point2d> place(40, {0.1, 0.2});
  EXPECT_FALSE(findHomography(place, place, kFocal_px, usual()));
  std::vector<cv::Point2d> line;
  for (int k = 0; k < 40; ++k) line.emplace_back(0.01 * k, 0.02 * k);
  EXPECT_FALSE(findHomography(line, line, kFocal_px, usual()));
}

}  // namespace
}  // namespace aras_visual_servo_camera::plane_homography_test
