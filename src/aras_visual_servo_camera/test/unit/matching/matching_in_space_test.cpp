// Keypoints with depths: the motion of the camera in space, and what is said where there are no depths.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <limits>

#include "aras_visual_servo_camera/matching/match_extractor.hpp"
#include "board.hpp"
#include "text_of.hpp"

namespace aras_visual_servo_camera::matching_in_space_test {
namespace {

using testing::board;
using testing::GreyImage;
using testing::kFocal_px;

constexpr int kWidth = 320, kHeight = 240, kShift_px = 4;
constexpr double kDepth_m = 0.75;                   // a float has it exactly
constexpr double kPlace = 0.3 / kFocal_px;          // of keypoints, a fraction of a pixel
const GreyImage kGoal = board(kWidth, kHeight, 0);  // of a board at this depth
const GreyImage kShifted = board(kWidth, kHeight, kShift_px), kOther = board(kWidth, kHeight, 0, 8);

/** A depth image of one depth but for the columns left of `holes`. */
struct Depths {
  explicit Depths(int holes = 0, int height = kHeight)
      : z(static_cast<std::size_t>(kWidth) * height, static_cast<float>(kDepth_m)),
        view{reinterpret_cast<const std::uint8_t*>(z.data()), kWidth, height, sizeof(float) * kWidth} {
    for (std::size_t k = 0; k < z.size(); ++k)
      if (static_cast<int>(k % kWidth) < holes) z[k] = std::numeric_limits<float>::quiet_NaN();
  }
  Depths(const Depths&) = delete;

  std::vector<float> z;
  DepthView view;
};

MatchExtractor extractor() {
  MatchingConfig config = readMatchingConfig(YAML::Load("{depth: {}}"));
  return MatchExtractor(testing::cameraOf(kWidth, kHeight), config);
}

class MatchingInSpace : public ::testing::Test {
 protected:
  MatchExtractor extractor_ = extractor();
  Depths whole_;
};

TEST_F(MatchingInSpace, AShiftOfTheImageIsAMotionToTheSide) {
  extractor_.setReference(kGoal.view(), 9.0, &whole_.view);
  const MatchFeatures home = extractor_.process(kGoal.view(), kNoStamp, &whole_.view);
  const MatchFeatures away = extractor_.process(kShifted.view(), kNoStamp, &whole_.view);
  ASSERT_TRUE(home.valid && away.valid) << home.fault << away.fault;
  EXPECT_DOUBLE_EQ(home.z_star_m, kDepth_m) << "the depth that is seen, not the one that is told";
  EXPECT_EQ(home.homography, (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1})) << "the goal image itself, exactly";
  EXPECT_EQ(home.rms_px, 0.0);
  ASSERT_EQ(away.point_z.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(home.point_x[k], home.as_goal_x[k], 1e-15);
    EXPECT_NEAR(home.point_z[k], kDepth_m, 1e-15);
    EXPECT_NEAR(away.point_x[k] - home.point_x[k], kShift_px / kFocal_px, kPlace);
    EXPECT_NEAR(away.point_y[k], home.point_y[k], kPlace);
    EXPECT_NEAR(away.point_z[k], kDepth_m, kDepth_m * kPlace);
  }
  EXPECT_NEAR(away.homography[2], kShift_px / kFocal_px, kPlace);
  EXPECT_NEAR(away.xg - home.xg, kShift_px / kFocal_px, kPlace);
  EXPECT_GT(away.inliers, 30);
  EXPECT_EQ(away.match_goal_x.size(), static_cast<std::size_t>(away.inliers));
}

TEST_F(MatchingInSpace, KeypointsInHolesDoNotCount) {
  const Depths half(kWidth / 2);
  extractor_.setReference(kGoal.view(), 9.0, &half.view);
  const MatchFeatures away = extractor_.process(kShifted.view(), kNoStamp, &whole_.view);
  EXPECT_TRUE(away.valid) << away.fault;
  for (const double x : away.match_goal_x) EXPECT_GE(x, -0.5 / kFocal_px) << "in the hole of the goal";
  extractor_.setReference(kGoal.view(), 9.0, &whole_.view);
  const MatchFeatures here = extractor_.process(kShifted.view(), kNoStamp, &half.view);
  EXPECT_TRUE(here.valid) << here.fault;
  for (const double x : here.match_x) EXPECT_GE(x, -0.5 / kFocal_px) << "in the hole of the image";
}

TEST_F(MatchingInSpace, ADepthImageFullOfHolesIsToldAndRefused) {
  const Depths holes(kWidth);
  const std::string why = "have a depth, needed at least 12";
  const MatchFeatures seen = extractor_.process(kGoal.view(), kNoStamp, &holes.view);
  EXPECT_FALSE(seen.valid || seen.target_visible);
  EXPECT_EQ(seen.fault, "the depth image has holes: of " + std::to_string(seen.keypoints) + " keypoints 0 " + why);
  EXPECT_EQ(seen.depth_fault, "");
  const std::string refusal =
      testing::textOf<DegenerateFeature>([&] { extractor_.setReference(kGoal.view(), 0.5, &holes.view); });
  EXPECT_NE(refusal.find("matches reference: the depth image has holes"), std::string::npos) << refusal;
  EXPECT_FALSE(extractor_.process(kGoal.view(), kNoStamp, &whole_.view).has_reference);
}

TEST_F(MatchingInSpace, AMissingDepthImageAndOneOfAnotherSizeAreToldAndRefused) {
  const Depths half(0, kHeight / 2);
  const auto expectToldAndRefused = [&](const DepthView* depth, const std::string& why) {
    const MatchFeatures seen = extractor_.process(kGoal.view(), kNoStamp, depth);
    EXPECT_FALSE(seen.valid);
    EXPECT_EQ(seen.fault.find(why), 0u) << seen.fault;
    EXPECT_EQ(seen.depth_fault, seen.fault);
    const std::string refusal =
        testing::textOf<DegenerateFeature>([&] { extractor_.setReference(kGoal.view(), 0.5, depth); });
    EXPECT_EQ(refusal.find("matches reference: " + why), 0u) << refusal;
  };
  expectToldAndRefused(nullptr, "no depth image came with the image");
  expectToldAndRefused(&half.view, "the depth image is 320 x 120, allowed 320 x 240");
}

TEST_F(MatchingInSpace, AnotherBoardIsNotTheTarget) {
  extractor_.setReference(kGoal.view(), 9.0, &whole_.view);
  const MatchFeatures seen = extractor_.process(kOther.view(), kNoStamp, &whole_.view);
  EXPECT_FALSE(seen.valid || seen.target_visible);
  EXPECT_NE(seen.fault.find("with a depth in both images, fewer than 12 agree"), std::string::npos) << seen.fault;
  EXPECT_TRUE(seen.point_x.empty() && seen.homography.empty());
}

TEST_F(MatchingInSpace, AnImageIsTaughtWithItsDepths) {
  extractor_.process(kGoal.view(), 5, &whole_.view);
  extractor_.process(kOther.view(), 6, nullptr);
  EXPECT_THROW(extractor_.teach(6, 9.0), DegenerateFeature);
  extractor_.teach(5, 9.0);
  const MatchFeatures seen = extractor_.process(kGoal.view(), 7, &whole_.view);
  EXPECT_TRUE(seen.valid) << seen.fault;
  EXPECT_DOUBLE_EQ(seen.z_star_m, kDepth_m);
  EXPECT_EQ(seen.reference_stamp_ns, 5);
}

}  // namespace
}  // namespace aras_visual_servo_camera::matching_in_space_test
