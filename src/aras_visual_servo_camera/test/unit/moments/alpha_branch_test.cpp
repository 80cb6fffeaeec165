// Which of the two directions of an axis is taken, from moments made by hand: each bound from both of its sides.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/moments/moment_features.hpp"
#include "aras_visual_servo_camera/moments/moments.hpp"
#include "polygon_moments.hpp"
#include "text_of.hpp"

namespace aras_visual_servo_camera::alpha_branch_test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRounding = 1e-12;
constexpr FeatureBuilder::View kSeen{true, false, 1};

FeatureBuilder builder() { return FeatureBuilder(3, 0.03, 0.01); }

/** A view of a blob, its axis before it is resolved, and a direction of third moments that agrees with it as asked. */
struct MomentBranch : ::testing::Test {
  MomentBranch() {
    const MomentFeatures f = builder().build(kSeen, m);
    alpha = f.alpha;
    asymmetry = f.asymmetry;
    own = rotated({f.mu[6], f.mu[7], f.mu[8], f.mu[9]}, alpha);
    scale(&own, 1.0 / std::sqrt(dot(own, own)));
    across = {own[1], own[0], own[3], own[2]};
    const double along = dot(across, own);
    for (int k = 0; k < 4; ++k) across[k] -= along * own[k];
    scale(&across, 1.0 / std::sqrt(dot(across, across)));
  }

  static void scale(ThirdMoments* t, double factor) {
    for (double& value : *t) value *= factor;
  }

  ThirdMoments agreeingBy(double cosine) const {
    ThirdMoments t;
    for (int k = 0; k < 4; ++k) t[k] = cosine * own[k] + std::sqrt(1.0 - cosine * cosine) * across[k];
    return t;
  }

  /** With a reference whose alpha is the opposite one, so that the nearer branch and the direction part. */
  MomentFeatures seen(double agreement, int hard_area_px = 0) const {
    FeatureBuilder b = builder();
    b.setReference({0.5, 0.05, opposite(agreement > 0.0 ? 0.0 : kPi), agreeingBy(agreement)});
    FeatureBuilder::View view = kSeen;
    view.hard_area_px = hard_area_px;
    return b.build(view, m);
  }
  double opposite(double turn) const { return std::remainder(alpha + kPi + turn, 2.0 * kPi); }

  std::vector<double> m =
      testing::polygonMoments(testing::project(testing::blob(0.14), {0.03, -0.02, 0.5, 0.4, 0.1, 0.2}), 3);
  double alpha = 0.0, asymmetry = 0.0;
  ThirdMoments own{}, across{};
};

TEST_F(MomentBranch, ADirectionThatAgreesByATenthTellsTheBranch) {
  for (const double sign : {1.0, -1.0}) {
    const double told = sign > 0.0 ? alpha : opposite(0.0), nearer = sign > 0.0 ? opposite(0.0) : alpha;
    const MomentFeatures clear = seen(sign * 0.11), unclear = seen(sign * 0.09);
    EXPECT_FALSE(clear.symmetric) << sign;
    EXPECT_NEAR(clear.alpha, told, kRounding) << sign;
    EXPECT_TRUE(unclear.symmetric) << sign;
    EXPECT_NEAR(unclear.alpha, nearer, kRounding) << sign << ": the one nearer to the reference";
  }
}

TEST_F(MomentBranch, StairsOfASmallShapeMayNotTellIt) {
  const double least_px =
      std::pow(3.0 / (0.8 * asymmetry), 4.0 / 3.0);  // of the shape, when the directions agree by 0.8
  for (const double sign : {1.0, -1.0}) {
    EXPECT_FALSE(seen(sign * 0.8, static_cast<int>(1.1 * least_px)).symmetric) << sign;
    EXPECT_TRUE(seen(sign * 0.8, static_cast<int>(0.9 * least_px)).symmetric) << sign;
    EXPECT_FALSE(seen(sign * 0.8, 0).symmetric) << "soft edges have no stairs";
  }
}

TEST_F(MomentBranch, ASymmetricReferenceTellsNothing) {
  FeatureBuilder b = builder();
  for (const double turn : {0.0, kPi}) {
    b.setReference({0.5, 0.05, alpha + 0.3 + turn, own, true});
    const MomentFeatures f = b.build(kSeen, m);
    EXPECT_TRUE(f.symmetric && f.valid);
    EXPECT_NEAR(std::remainder(f.alpha - alpha - turn, 2.0 * kPi), 0.0, kRounding) << turn;
  }
}

TEST(MomentReference, OfASymmetricViewIsSymmetric) {
  FeatureBuilder b = builder();
  const auto of = [&](const testing::Polygon& p) {
    b.clearReference();
    b.setReference(0.5, b.build(kSeen, testing::polygonMoments(p, 3)));
    return b.reference()->symmetric;
  };
  EXPECT_TRUE(of(testing::rectangle(0.2, 0.1)));
  EXPECT_FALSE(of(testing::triangle(0.2)));
}

TEST(MomentReference, HasItsAngleWithinATurn) {
  FeatureBuilder b = builder();
  for (const auto& [given, kept] : {std::pair(-kPi, kPi), std::pair(kPi, kPi), std::pair(7.0, 7.0 - 2.0 * kPi),
                                    std::pair(-7.0, 2.0 * kPi - 7.0), std::pair(0.5, 0.5)}) {
    b.setReference({0.5, 0.05, given});
    EXPECT_NEAR(b.reference()->alpha_star, kept, kRounding) << given;
  }
}

TEST(MomentReference, NeedsMomentsToOrderThree) {
  FeatureBuilder b = builder();
  MomentFeatures f = b.build(kSeen, testing::polygonMoments(testing::triangle(0.2), 3));
  f.mu.resize(6);
  EXPECT_EQ(testing::textOf<ShapeError>([&] { b.setReference(0.5, f); }),
            "reference view: found 6 moments, allowed at least 10");
}

TEST(MomentReference, OfAnInvalidViewIsRefusedWithTheReason) {
  FeatureBuilder b = builder();
  const auto refusal = [&](bool visible, bool cut, bool ambiguous, double alpha) {
    MomentFeatures f;
    f.target_visible = visible;
    f.touches_border = cut;
    f.ambiguous = ambiguous;
    f.alpha = alpha;
    return testing::textOf<DegenerateFeature>([&] { b.setReference(0.5, f); });
  };
  const double none = MomentFeatures::kNone;
  const auto text = [](const std::string& why) { return "reference view: " + why + ", allowed a valid view"; };
  EXPECT_EQ(refusal(false, false, true, none), text("several objects, and it is not clear which is the target"));
  EXPECT_EQ(refusal(false, false, false, none), text("no target in view"));
  EXPECT_EQ(refusal(true, true, false, 0.1), text("the target is cut by the image border"));
  EXPECT_EQ(refusal(true, false, false, 0.1), text("the points were not found"));
  EXPECT_EQ(refusal(true, false, false, none), text("the target has no orientation"));
}

TEST(MomentAngles, OfAnUprightAxisIsAQuarterTurnAndNotMinusThat) {
  // Such a small mixed moment is lost beside the others, but its sign is not.
  for (const double mixed : {1e-30, -1e-30}) {
    const MomentFeatures f = builder().build(kSeen, {1.0, 0.0, 0.0, 1.0, mixed, 2.0, 0.0, 0.0, 0.0, 0.5});
    EXPECT_EQ(f.alpha, 0.5 * kPi) << mixed;
  }
}

TEST(MomentAngles, OfOnePixelAreNone) {
  // A hard-edged pixel in the middle of the image is a point.
  const MomentFeatures f = builder().build(kSeen, {1e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  EXPECT_TRUE(f.target_visible && f.symmetric && !f.valid);
  EXPECT_TRUE(std::isnan(f.alpha) && std::isnan(f.asymmetry));
}

TEST(MomentAngles, TheConditionIsThatOfTheAxesWhateverTheirDirection) {
  constexpr double kCorners = 1e-4;  // an ellipse of 720 corners
  for (const double angle : {0.0, 0.4, kPi / 4, 1.9, -kPi / 4}) {
    const auto outline = testing::ellipse(0.2, 0.1, angle, {0.1, 0.05}, 720);
    const MomentFeatures f = builder().build(kSeen, testing::polygonMoments(outline, 3));
    EXPECT_NEAR(f.orientation_condition, (4.0 - 1.0) / (4.0 + 1.0), kCorners) << angle;
  }
}

TEST(MomentFeatures, WithoutAreaNothingIsInView) {
  for (const double area : {0.0, -1.0, MomentFeatures::kNone}) {
    const MomentFeatures f = builder().build(kSeen, {area, 0.1, 0.1, 0.2, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0});
    EXPECT_FALSE(f.target_visible || f.valid) << area;
    EXPECT_TRUE(f.m.empty() && std::isnan(f.area)) << area;
  }
}

}  // namespace
}  // namespace aras_visual_servo_camera::alpha_branch_test
