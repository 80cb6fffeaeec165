// Keypoints: which pairs match, how many are kept, their depths.
#include "matching/keypoints.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>

#include "board.hpp"

namespace aras_visual_servo_camera::keypoints_test {
namespace {

using Pairs = std::vector<std::array<int, 2>>;

MatchingConfig with(KeypointDetector detector) {
  MatchingConfig config = readMatchingConfig(YAML::Node());
  config.detector = detector;
  return config;
}

/** Keypoints whose descriptors have these numbers of leading ones: they differ by the difference of the numbers. */
Keypoints ofBits(const std::vector<int>& ones) {
  Keypoints keypoints;
  keypoints.descriptors = cv::Mat::zeros(static_cast<int>(ones.size()), 32, CV_8U);
  for (std::size_t i = 0; i < ones.size(); ++i) {
    keypoints.xy.emplace_back(0.1 * static_cast<double>(i), 0.2);
    for (int bit = 0; bit < ones[i]; ++bit)
      keypoints.descriptors.at<std::uint8_t>(static_cast<int>(i), bit / 8) |= static_cast<std::uint8_t>(1 << bit % 8);
  }
  return keypoints;
}

/** The same as numbers of one axis, as SIFT's are compared. */
Keypoints ofNumbers(const std::vector<int>& numbers) {
  Keypoints keypoints = ofBits(numbers);
  keypoints.descriptors = cv::Mat::zeros(static_cast<int>(numbers.size()), 128, CV_32F);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    keypoints.descriptors.at<float>(static_cast<int>(i), 0) = static_cast<float>(numbers[i]);
  return keypoints;
}

struct Kind {
  KeypointDetector detector;
  Keypoints (*of)(const std::vector<int>&);
};

class Matches : public ::testing::TestWithParam<Kind> {
 protected:
  Pairs pairs(const std::vector<int>& image, const std::vector<int>& goal) const {
    const auto of = GetParam().of;
    return KeypointFinder(with(GetParam().detector)).match(of(image), of(goal));
  }
};
INSTANTIATE_TEST_SUITE_P(Keypoints, Matches,
                         ::testing::Values(Kind{KeypointDetector::kOrb, ofBits},
                                           Kind{KeypointDetector::kSift, ofNumbers}));

TEST_P(Matches, AreTheNearestThatAreClearlyNearerThanTheNext) {
  EXPECT_EQ(pairs({100, 51, 7}, {10, 50, 90}), (Pairs{{2, 0}, {1, 1}, {0, 2}}));
  EXPECT_EQ(pairs({24}, {20, 30}), (Pairs{{0, 0}}));
  EXPECT_EQ(pairs({28}, {20, 30}), (Pairs{{0, 1}}));
  EXPECT_EQ(pairs({25}, {20, 30}), Pairs{});  // as near to either
}

TEST_P(Matches, NameEachKeypointOfTheGoalOnceByTheNearestOfTheImage) {
  EXPECT_EQ(pairs({23, 21}, {20, 90}), (Pairs{{1, 0}}));
  EXPECT_EQ(pairs({21, 23}, {20, 90}), (Pairs{{0, 0}}));
}

TEST_P(Matches, OfAGoalWithOneKeypointAreNotCompared) { EXPECT_EQ(pairs({200}, {20}), (Pairs{{0, 0}})); }

TEST_P(Matches, AreNoneWithoutKeypoints) {
  EXPECT_EQ(pairs({}, {20, 90}), Pairs{});
  EXPECT_EQ(pairs({20, 90}, {}), Pairs{});
}

TEST(Keypoints, AreTheSameIfPlacesAndDescriptorsAre) {
  const Keypoints keypoints = ofBits({5, 60});
  EXPECT_TRUE(keypoints == ofBits({5, 60}));
  EXPECT_FALSE(keypoints == ofBits({5, 61}));
  EXPECT_FALSE(keypoints == ofBits({5}));
  Keypoints other = ofBits({5, 60});
  other.xy[1].y += 1e-9;
  EXPECT_FALSE(keypoints == other);
  other = ofBits({5, 60});
  other.descriptors = other.descriptors.colRange(0, 31).clone();
  EXPECT_FALSE(keypoints == other);
  EXPECT_FALSE(ofNumbers({5, 60}) == keypoints);
}

TEST(Keypoints, HaveTheMedianOfTheDepthsThatAreThere) {
  const double hole = std::nan("");
  Keypoints keypoints;
  EXPECT_EQ(keypoints.withDepth(), 0);
  keypoints.z = {hole, hole};
  EXPECT_EQ(keypoints.withDepth(), 0);
  EXPECT_TRUE(std::isnan(keypoints.medianDepth()));
  keypoints.z = {3.0, hole, 0.5, 2.0};
  EXPECT_EQ(keypoints.withDepth(), 3);
  EXPECT_EQ(keypoints.medianDepth(), 2.0);
}

class Detector : public ::testing::TestWithParam<KeypointDetector> {};
INSTANTIATE_TEST_SUITE_P(Keypoints, Detector,
                         ::testing::Values(KeypointDetector::kOrb, KeypointDetector::kAkaze, KeypointDetector::kSift));

TEST_P(Detector, KeepsAtMostSoManyOfTheKeypointsThatItFinds) {
  MatchingConfig config = with(GetParam());
  Keypoints all, some;
  const testing::GreyImage image = testing::board(320, 240, 0);
  const cv::Mat grey(240, 320, CV_8U, const_cast<std::uint8_t*>(image.data.data()));
  KeypointFinder(config).find(grey, testing::cameraOf(320, 240), &all);
  config.keypoints = 30;
  KeypointFinder(config).find(grey, testing::cameraOf(320, 240), &some);
  EXPECT_GT(all.count(), 30);
  EXPECT_LE(some.count(), 30);
  EXPECT_GE(some.count(), 20);
  EXPECT_EQ(some.descriptors.rows, some.count());
}

TEST_P(Detector, LeavesOutKeypointsWithoutARay) {
  const CameraIntrinsics folded(320, 240, {200, 0, 160, 0, 200, 120, 0, 0, 1}, "plumb_bob", {-0.8, 0, 0, 0});
  Keypoints all, some;
  const testing::GreyImage image = testing::board(320, 240, 0);
  const cv::Mat grey(240, 320, CV_8U, const_cast<std::uint8_t*>(image.data.data()));
  const KeypointFinder finder(with(GetParam()));
  finder.find(grey, testing::cameraOf(320, 240), &all);
  finder.find(grey, folded, &some);
  EXPECT_GT(some.count(), 0);
  EXPECT_LT(some.count(), all.count());
  EXPECT_EQ(some.descriptors.rows, some.count());
}

}  // namespace
}  // namespace aras_visual_servo_camera::keypoints_test
