// The motion of points in space that are matched, some of them wrongly.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <random>

#include "matching/goal_motion.hpp"

namespace aras_visual_servo_camera::rigid_motion_test {
namespace {

constexpr double kFocal_px = 400.0;

struct Cloud {
  explicit Cloud(bool flat, double noise_px = 0.0, int wrong = 0) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::normal_distribution<double> off(0.0, noise_px / kFocal_px);
    cv::Rodrigues(cv::Vec3d(0.2, -0.3, 0.9), R);
    for (int k = 0; k < 80; ++k) {
      goal.emplace_back(0.3 * any(random), 0.3 * any(random), flat ? 0.8 : 0.8 + 0.3 * any(random));
      cv::Vec3d P = R * goal.back() + t;
      P[0] += P[2] * off(random);
      P[1] += P[2] * off(random);
      if (k < wrong) P = cv::Vec3d(0.3 * any(random), 0.3 * any(random), 0.9);
      here.push_back(P);
    }
  }

  double off(const RigidMotion& m) const { return cv::norm(m.R - R) + cv::norm(m.t - t); }

  cv::Matx33d R;
  cv::Vec3d t{0.1, -0.05, 0.2};
  std::vector<cv::Vec3d> goal, here;
};

MatchingConfig usual() {
  MatchingConfig config{};
  config.inlier_px = 3.0;
  config.min_matches = 12;
  config.iterations = 2000;
  config.seed = 1;
  return config;
}

TEST(RigidMotion, IsFoundToRoundingInAPlaneAndInAScene) {
  for (bool flat : {false, true}) {
    const Cloud cloud(flat);
    const auto motion = findRigidMotion(cloud.goal, cloud.here, kFocal_px, usual());
    ASSERT_TRUE(motion);
    EXPECT_LT(cloud.off(*motion), 1e-12);
    EXPECT_EQ(motion->inliers.size(), cloud.goal.size());
  }
}

TEST(RigidMotion, LeavesOutWrongMatchesAndIsTheSameAgain) {
  const Cloud cloud(false, 0.3, 40);
  const auto motion = findRigidMotion(cloud.goal, cloud.here, kFocal_px, usual());
  ASSERT_TRUE(motion);
  // 0.3 px of 400 over the root of 40 points is 1.2e-4 rad, over 0.3 of 0.8 m of depth a few times that
  EXPECT_LT(cloud.off(*motion), 2e-3);
  EXPECT_GE(motion->inliers.size(), 38u);
  EXPECT_LE(motion->inliers.size(), 42u);
  EXPECT_NEAR(motion->rms_px, 0.3 * std::sqrt(2.0), 0.1);
  const auto again = findRigidMotion(cloud.goal, cloud.here, kFocal_px, usual());
  EXPECT_EQ(cv::norm(again->R - motion->R, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(again->t - motion->t, cv::NORM_INF), 0.0);
}

TEST(RigidMotion, GoesOnWhileNoSampleHasFoundAnythingYet) {
  const Cloud cloud(false, 0.0, 55);  // of samples of three, every thirtieth is of right matches alone
  const auto motion = findRigidMotion(cloud.goal, cloud.here, kFocal_px, usual());
  ASSERT_TRUE(motion);
  EXPECT_LT(cloud.off(*motion), 1e-12);
}

TEST(RigidMotion, IsNoneForFewPointsWrongOnesAndALine) {
  const Cloud wrong(false, 0.0, 70);
  EXPECT_FALSE(findRigidMotion(wrong.goal, wrong.here, kFocal_px, usual()));
  const std::vector<cv::Vec3d> few(wrong.goal.begin(), wrong.goal.begin() + 5);
  EXPECT_FALSE(findRigidMotion(few, few, kFocal_px, usual()));
  std::vector<cv::Vec3d> line;
  for (int k = 0; k < 20; ++k) line.emplace_back(0.01 * k, 0.0, 0.8);
  EXPECT_FALSE(findRigidMotion(line, line, kFocal_px, usual()));
}

}  // namespace
}  // namespace aras_visual_servo_camera::rigid_motion_test
