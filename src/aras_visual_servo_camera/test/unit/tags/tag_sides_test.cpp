// Corners from the sides of a dark square, between its pixels; where they are not given.
#include "tags/tag_sides.hpp"

#include <gtest/gtest.h>

#include "coverage_image.hpp"

namespace aras_visual_servo_camera::tag_sides_test {
namespace {

using testing::GreyImage;
using testing::Polygon;

using Corners = std::array<cv::Point2d, 4>;

constexpr double kReach_px = 3.0;
constexpr double kWithin_px = 0.02;  // greys in steps of 1 / 210 along sides of some fifty pixels
constexpr double kOff_px = 0.7;      // of the corners that are handed over

/** A camera whose pixels are its coordinates, but for the lens. */
CameraIntrinsics camera(const std::vector<double>& lens = {}) {
  return CameraIntrinsics(160, 120, {100, 0, 80, 0, 100, 60, 0, 0, 1}, lens.empty() ? "" : "plumb_bob", lens);
}

cv::Point2d normalised(const cv::Point2d& px) { return {(px.x - 80.0) / 100.0, (px.y - 60.0) / 100.0}; }

std::optional<Corners> found(const Corners& drawn, const Corners& handed,
                             const CameraIntrinsics& intrinsics = camera()) {
  Polygon outline;
  for (const cv::Point2d& p : drawn) outline.push_back({normalised(p).x, normalised(p).y});
  GreyImage image(160, 120, testing::kBackgroundGrey);
  testing::drawCoverage(outline, camera(), testing::kObjectGrey, &image);
  return cornersOfSides(cv::Mat(120, 160, CV_8U, image.data.data()), handed, kReach_px, intrinsics);
}

/** A slanted square whose box begins at (u, v) and is 60 px wide and high. */
Corners squareAt(double u, double v) { return {{{u + 5, v}, {u + 60, v + 5}, {u + 55, v + 60}, {u, v + 55}}}; }

TEST(TagSides, MeetInTheCornersWhicheverWayTheseWereOff) {
  const Corners truth = squareAt(40.3, 30.6);
  for (const cv::Point2d& off : {cv::Point2d(kOff_px, 0), cv::Point2d(-kOff_px, 0), cv::Point2d(0, kOff_px),
                                 cv::Point2d(0, -kOff_px), cv::Point2d(kOff_px, -kOff_px)}) {
    Corners handed = truth;
    for (cv::Point2d& p : handed) p += off;
    const auto corners = found(truth, handed);
    ASSERT_TRUE(corners);
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_LT(cv::norm((*corners)[k] - normalised(truth[k])) * 100.0, kWithin_px) << k << off;
  }
}

TEST(TagSides, AreNotLookedForOutsideTheImage) {
  // One side lies on the first or last row or column: what is beyond it is not known.
  const Corners inside{{{50, 40}, {100, 40}, {100, 90}, {50, 90}}};
  EXPECT_TRUE(found(inside, inside));
  for (const cv::Point2d& to : {cv::Point2d(-49, 0), cv::Point2d(0, -39), cv::Point2d(58, 0), cv::Point2d(0, 28)}) {
    Corners cut = inside;
    for (cv::Point2d& p : cut) p += to;
    EXPECT_FALSE(found(cut, cut)) << to;
  }
}

TEST(TagSides, AreNotFoundWhereNothingRisesOrTheLensShowsNothing) {
  const Corners square = squareAt(40, 30);
  EXPECT_FALSE(found(Corners{}, square)) << "no square";
  EXPECT_TRUE(found(square, square, camera({-0.1, 0, 0, 0})));
  EXPECT_FALSE(found(square, square, camera({-8.0, 0, 0, 0}))) << "beyond the fold";
}

TEST(TagSides, ThatLieOnOneLineHaveNoCorner) {
  const Corners triangle{{{40, 30}, {70, 30}, {100, 30}, {70, 90}}};
  EXPECT_FALSE(found(triangle, triangle));
}

}  // namespace
}  // namespace aras_visual_servo_camera::tag_sides_test
