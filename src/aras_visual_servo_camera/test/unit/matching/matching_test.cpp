#include <dlfcn.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/matching/match_extractor.hpp"
#include "board.hpp"
#include "matching/keypoints.hpp"

// Images of a plane are held against true poses by test_matches.py; here what memory and sizes are about, under
// sanitizers too.
namespace aras_visual_servo_camera::matching_test {
namespace {

using testing::board;
using testing::cameraOf;
using testing::GreyImage;
using testing::kFocal_px;

MatchingConfig usual() { return readMatchingConfig(YAML::Node()); }

TEST(NearestByBits, FindsWhatAComparisonBitByBitFinds) {
  std::mt19937 random(7);
  for (int width : {1, 32, 61}) {
    cv::Mat queries(40, width, CV_8U), rows(50, width, CV_8U);
    for (cv::Mat* mat : {&queries, &rows})
      for (int i = 0; i < mat->rows; ++i)
        for (int k = 0; k < width; ++k) mat->at<std::uint8_t>(i, k) = static_cast<std::uint8_t>(random() % 256);
    const std::vector<NearestTwo> found = nearestByBits(queries, rows);
    for (int i = 0; i < queries.rows; ++i) {
      std::vector<std::pair<double, int>> all;
      for (int r = 0; r < rows.rows; ++r) all.emplace_back(cv::norm(queries.row(i), rows.row(r), cv::NORM_HAMMING), r);
      std::sort(all.begin(), all.end());
      const NearestTwo& nearest = found[static_cast<std::size_t>(i)];
      EXPECT_EQ(nearest.index, all[0].second);
      EXPECT_EQ(nearest.first, all[0].first);
      EXPECT_EQ(nearest.second, all[1].first);
    }
  }
  EXPECT_EQ(nearestByBits(cv::Mat(2, 32, CV_8U, cv::Scalar(1)), cv::Mat(0, 32, CV_8U))[1].index, -1);
  EXPECT_TRUE(
      std::isinf(nearestByBits(cv::Mat(1, 32, CV_8U, cv::Scalar(1)), cv::Mat(1, 32, CV_8U, cv::Scalar(0)))[0].second));
}

class Matching : public ::testing::TestWithParam<KeypointDetector> {};

TEST_P(Matching, FollowsAShiftOfTheImageAtAnySize) {
  MatchingConfig config = usual();
  config.detector = GetParam();
  for (int width : {320, 211}) {
    const int height = 3 * width / 4;
    MatchExtractor extractor(cameraOf(width, height), config);
    extractor.setReference(board(width, height, 0).view(), 0.5);
    const MatchFeatures home = extractor.process(board(width, height, 0).view());
    const MatchFeatures away = extractor.process(board(width, height, 4).view());
    ASSERT_TRUE(home.valid && away.valid) << home.fault << away.fault;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(away.point_x[i] - home.point_x[i], 4 / kFocal_px, 0.3 / kFocal_px);
      EXPECT_NEAR(away.point_y[i], home.point_y[i], 0.3 / kFocal_px);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Detectors, Matching,
                         ::testing::Values(KeypointDetector::kOrb, KeypointDetector::kAkaze, KeypointDetector::kSift));

TEST(Matching, AnotherCameraKeepsTheGoal) {
  MatchExtractor extractor(cameraOf(320, 240), usual());
  extractor.setReference(board(320, 240, 0).view(), 0.5);
  extractor.setIntrinsics(cameraOf(160, 120));
  EXPECT_TRUE(extractor.process(board(160, 120, 0).view()).has_reference);
  EXPECT_THROW(extractor.process(board(320, 240, 0).view()), ShapeError);
}

#if defined(__GLIBC__)
long pageFaults() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return used.ru_minflt;
}

TEST(Matching, TakesTheMemoryOfTheLastImage) {
  if (dlsym(RTLD_DEFAULT, "__asan_init")) GTEST_SKIP() << "the address sanitizer gives no memory a second time at once";
  MatchingConfig config = usual();
  config.detector = KeypointDetector::kAkaze;
  MatchExtractor extractor(cameraOf(640, 480), config);
  const GreyImage image = board(640, 480, 0);
  extractor.setReference(image.view(), 0.5);
  for (int k = 0; k < 3; ++k) extractor.process(image.view());
  const long before = pageFaults();
  for (int k = 0; k < 3; ++k) extractor.process(image.view());
  EXPECT_LT(pageFaults() - before, 3 * 200);  // 28 MB are 7000 pages
}
#endif

}  // namespace
}  // namespace aras_visual_servo_camera::matching_test
