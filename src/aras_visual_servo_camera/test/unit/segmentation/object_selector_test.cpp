// The rules by which the target is chosen and kept, each bound from both of its sides: candidates instead of images.
#include "segmentation/object_selector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "usual_vision.hpp"

namespace aras_visual_servo_camera::object_selector_test {
namespace {

constexpr double kArea_px = 400.0;
constexpr int kImages = 3;  // switch_images
constexpr int kNobody = -1, kUnclear = -2;

Candidate at(double u, double v, double area_px = kArea_px) {
  const int half = static_cast<int>(0.5 * std::sqrt(area_px));
  const int iu = static_cast<int>(u), iv = static_cast<int>(v);
  return {u,         v,         area_px, iu - half, iu + half,
          iv - half, iv + half, false,   false,     std::numeric_limits<double>::quiet_NaN()};
}

Candidate like(double dissimilarity, double u, double v, double area_px = kArea_px) {
  Candidate c = at(u, v, area_px);
  c.dissimilarity = dissimilarity;
  return c;
}

/** The target at (200, 100), and perhaps another object, 100 px beside it on one of four sides. */
const Candidate kTarget = at(200, 100);

class SelectionRules : public ::testing::Test {
 protected:
  explicit SelectionRules(ComponentChoice component = ComponentChoice::kLargest) {
    VisionConfig config = testing::usualVision();
    config.component = component;
    config.switch_ratio = 1.2;
    config.switch_images = kImages;
    selector_ = std::make_unique<ObjectSelector>(config);
  }

  /** Index of the one taken, kNobody, or kUnclear. */
  int see(const std::vector<Candidate>& candidates) {
    const ObjectSelector::Choice choice = selector_->choose(candidates);
    EXPECT_FALSE(choice.ambiguous && choice.index >= 0);
    return choice.ambiguous ? kUnclear : choice.index;
  }

  void follow(const std::vector<Candidate>& others = {}) {
    selector_->forget();
    ASSERT_EQ(see({kTarget}), 0);
    std::vector<Candidate> all = others;
    all.push_back(kTarget);
    ASSERT_EQ(see(all), static_cast<int>(others.size()));
  }

  std::unique_ptr<ObjectSelector> selector_;
};

class SelectionBySide : public SelectionRules, public ::testing::WithParamInterface<std::pair<int, int>> {
 protected:
  Candidate beside(double px, double area_px = kArea_px) const {
    return at(kTarget.u_px + px * GetParam().first, kTarget.v_px + px * GetParam().second, area_px);
  }
  /** One that reaches from the target's place so far to the side. */
  Candidate covering(int px) const {
    Candidate c = at(kTarget.u_px, kTarget.v_px, 900);
    const auto [x, y] = GetParam();
    (x > 0   ? c.u_max
     : x < 0 ? c.u_min
     : y > 0 ? c.v_max
             : c.v_min) = static_cast<int>(x != 0 ? c.u_px : c.v_px) + (x + y) * px;
    return c;
  }
};
INSTANTIATE_TEST_SUITE_P(Sides, SelectionBySide,
                         ::testing::Values(std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)));

TEST_P(SelectionBySide, AnObjectMovesByLessThanHalfTheDistanceToTheNext) {
  // Two that are too far off are new ones, and equal.
  follow({beside(100)});
  EXPECT_EQ(see({beside(100), beside(-52), beside(-49)}), 2);
  follow({beside(100)});
  EXPECT_EQ(see({beside(100), beside(-52), beside(-51)}), kUnclear);
}

TEST_P(SelectionBySide, OneThatCoversThePlacesOfTheTargetAndOfAnotherIsBoth) {
  for (const double distance : {60.0, 90.0}) {
    follow({beside(distance)});
    EXPECT_EQ(see({covering(static_cast<int>(distance) - 1)}), kUnclear) << "the next pixel counts";
    follow({beside(distance)});
    EXPECT_EQ(see({covering(static_cast<int>(distance) - 2)}), 0);
  }
}

TEST_F(SelectionRules, AnObjectGrowsOrShrinksToTheDoubleOrHalf) {
  for (const auto& [area_px, followed] :
       {std::pair(790.0, true), std::pair(810.0, false), std::pair(210.0, true), std::pair(190.0, false)}) {
    follow();
    EXPECT_EQ(see({at(200, 100, area_px), at(400, 100, area_px)}), followed ? 0 : kUnclear) << area_px;
  }
}

TEST_F(SelectionRules, OfTwoWithinReachTheNearerIsTheTargetInAnyOrder) {
  const Candidate other = at(300, 100), near = at(210, 100), far = at(230, 100);
  follow({other});
  EXPECT_EQ(see({near, far, other}), 0);
  follow({other});
  EXPECT_EQ(see({other, far, near}), 2);
}

TEST_F(SelectionRules, AnotherThatFlickersIsRememberedAsAnother) {
  const Candidate other = at(300, 100);
  Candidate speck = at(300, 100, 300);
  speck.speck = true;
  follow({other});
  EXPECT_EQ(see({speck, kTarget}), 1);
  EXPECT_EQ(see({other}), kNobody);
}

TEST_F(SelectionRules, OnlyWhatWasSeenInTheLastImageMerges) {
  const Candidate other = at(260, 100);
  Candidate both = at(230, 100, 900);
  both.u_min = 190;
  both.u_max = 270;
  follow({other});
  EXPECT_EQ(see({both}), kUnclear);
  follow({other});
  EXPECT_EQ(see({kTarget}), 0);
  EXPECT_EQ(see({both}), 0) << "the other was gone";
  follow({other});
  EXPECT_EQ(see({other}), kNobody);
  EXPECT_EQ(see({both}), 0) << "the target was gone";
}

TEST_F(SelectionRules, TheLargestIsLargerByTheRatio) {
  EXPECT_EQ(see({at(100, 100, 400), at(300, 100, 470)}), kUnclear);
  EXPECT_EQ(see({at(100, 100, 400), at(300, 100, 490)}), 1);
  selector_->forget();
  EXPECT_EQ(see({at(100, 100, 490), at(300, 100, 400)}), 0);
}

struct SelectionOfTheNearest : SelectionRules {
  SelectionOfTheNearest() : SelectionRules(ComponentChoice::kNearestToPrevious) {}
};

TEST_F(SelectionOfTheNearest, IsNearerByTheRatio) {
  for (const double sign : {1.0, -1.0}) {  // too large to be the same object
    follow();
    EXPECT_EQ(see({at(200 + sign * 10, 100, 900), at(200, 100 + sign * 11, 900)}), kUnclear);
    follow();
    EXPECT_EQ(see({at(200, 100 + sign * 13, 900), at(200 + sign * 10, 100, 900)}), 1);
  }
}

TEST_F(SelectionOfTheNearest, IsKeptBesideALargerOneForEver) {
  follow();
  for (int k = 0; k < 3 * kImages; ++k) EXPECT_EQ(see({at(300, 100, 9000), kTarget}), 1);
}

TEST_F(SelectionRules, ACutTargetIsNotLeftForAWholeOne) {
  Candidate cut = kTarget;
  cut.cut = true;
  follow();
  for (int k = 0; k < 3 * kImages; ++k) EXPECT_EQ(see({at(300, 100, 1200), cut}), 1) << k;
  for (int k = 1; k < kImages; ++k) EXPECT_EQ(see({at(300, 100, 1200), kTarget}), 1) << k;
  EXPECT_EQ(see({at(300, 100, 1200), kTarget}), 0);
}

TEST_F(SelectionRules, ABetterOneIsTakenInItsLastOfSomeImagesInARow) {
  const Candidate better = at(300, 100, 1200), equal = at(300, 100, 420);
  follow();
  for (int k = 1; k < kImages; ++k) EXPECT_EQ(see({better, kTarget}), 1) << k;
  EXPECT_EQ(see({equal, kTarget}), 1);
  for (int k = 1; k < kImages; ++k) EXPECT_EQ(see({better, kTarget}), 1) << k;
  EXPECT_EQ(see({better, kTarget}), 0);
}

struct SelectionOfTheMostSimilar : SelectionRules {
  SelectionOfTheMostSimilar() : SelectionRules(ComponentChoice::kMostSimilar) {}
};

TEST_F(SelectionOfTheMostSimilar, IsNoneOfAStrangeShape) {
  EXPECT_EQ(see({like(0.31, 200, 100)}), kNobody);
  EXPECT_EQ(see({like(0.29, 200, 100)}), 0);
  for (int k = 0; k < 3 * kImages; ++k)
    EXPECT_EQ(see({like(0.31, 300, 100), like(0.5, 200, 100)}), 1) << "what is followed stays, and nothing is better";
}

TEST_F(SelectionOfTheMostSimilar, DiffersLessByTheRatioAndMoreThanByNoise) {
  EXPECT_EQ(see({like(0.2, 100, 100), like(0.18, 300, 100)}), kUnclear);
  EXPECT_EQ(see({like(0.2, 100, 100), like(0.15, 300, 100)}), 1);
  selector_->forget();
  EXPECT_EQ(see({like(0.0, 100, 100), like(0.003, 300, 100)}), kUnclear) << "both are the same to noise";
  EXPECT_EQ(see({like(0.0, 100, 100), like(std::numeric_limits<double>::infinity(), 300, 100)}), 0) << "a line";
}

/** After the target has merged with another, of `count` objects in view. */
class SelectionAfterMerging : public SelectionRules {
 protected:
  void merge() {
    follow({at(260, 100)});
    Candidate both = at(230, 100, 900);
    both.u_min = 190;
    both.u_max = 270;
    ASSERT_EQ(see({both}), kUnclear);
  }
};

TEST_F(SelectionAfterMerging, TheBetterOneIsTakenWhenAllAreBack) {
  merge();
  EXPECT_EQ(see({at(200, 100), at(260, 100)}), kUnclear) << "equal ones";
  EXPECT_EQ(see({at(200, 100), at(260, 100, 600)}), 1);
}

TEST_F(SelectionAfterMerging, OneIsTakenThatHasBeenAloneForSomeImagesInARow) {
  merge();
  for (int k = 1; k < kImages; ++k) EXPECT_EQ(see({at(200, 100)}), kUnclear) << k;
  EXPECT_EQ(see({at(200, 100), at(260, 100)}), kUnclear);
  for (int k = 1; k < kImages; ++k) EXPECT_EQ(see({at(200, 100)}), kUnclear) << k;
  EXPECT_EQ(see({at(200, 100)}), 0);
  EXPECT_EQ(see({at(200, 100), at(260, 100)}), 0) << "it is followed as before";
}

TEST_F(SelectionAfterMerging, OneOfAnotherSizeIsNotTheTarget) {
  for (const double area_px : {320.0, 490.0}) {
    merge();
    for (int k = 0; k < 2 * kImages; ++k) EXPECT_EQ(see({at(200, 100, area_px)}), kUnclear) << area_px;
  }
}

TEST_F(SelectionAfterMerging, SpecksDoNotCount) {
  Candidate speck = at(260, 100, 30);
  speck.speck = true;
  merge();
  EXPECT_EQ(see({speck}), kNobody);
  for (int k = 1; k < kImages; ++k) EXPECT_EQ(see({speck, at(200, 100)}), kUnclear) << k;
  EXPECT_EQ(see({speck, at(200, 100)}), 1);
}

}  // namespace
}  // namespace aras_visual_servo_camera::object_selector_test
