#include "aras_visual_servo_camera/image/last_views.hpp"

#include <gtest/gtest.h>

#include "text_of.hpp"

namespace aras_visual_servo_camera::last_views_test {
namespace {

constexpr std::int64_t kFrame_ns = 33333333;
constexpr int kKept = static_cast<int>(LastViews<int>::kKept);

LastViews<int> filled(int images) {
  LastViews<int> views;
  for (int k = 0; k < images; ++k) views.add(k * kFrame_ns) = k;
  return views;
}

std::string refusal(const LastViews<int>& views, std::int64_t stamp_ns) {
  return testing::textOf<ParameterError>([&] { views.at(stamp_ns); });
}

TEST(LastViews, EveryOneOfTheLastIsFoundByItsStamp) {
  for (const int images : {1, 5, kKept, kKept + 1, 3 * kKept + 7}) {
    const LastViews<int> views = filled(images);
    for (int k = std::max(0, images - kKept); k < images; ++k) EXPECT_EQ(views.at(k * kFrame_ns), k) << images;
  }
}

TEST(LastViews, OneThatIsGoneIsRefusedWithItsStampAndThoseThatAreThere) {
  EXPECT_EQ(refusal(filled(kKept + 2), kFrame_ns),
            "reference.stamp: found 0.033333333 s, allowed the stamp of one of the last 32 images, from 0.066666666 s "
            "to 1.099999989 s");
  EXPECT_EQ(refusal(filled(3), 5),
            "reference.stamp: found 0.000000005 s, allowed the stamp of one of the last 3 images, from 0.000000000 s "
            "to 0.066666666 s");
  EXPECT_EQ(refusal(LastViews<int>(), 5), "reference.stamp: found 0.000000005 s, allowed after an image with a stamp");
}

TEST(LastViews, AStampThatComesAgainReplacesItsView) {
  LastViews<int> views = filled(3);
  views.add(2 * kFrame_ns) = 20;
  EXPECT_EQ(views.at(2 * kFrame_ns), 20);
  EXPECT_EQ(views.at(kFrame_ns), 1);
  EXPECT_NE(refusal(views, kFrame_ns + 1).find("last 3 images"), std::string::npos);
}

TEST(LastViews, TimeThatWasSetBackBeginsAnew) {
  for (const int images : {3, kKept + 5}) {
    LastViews<int> views = filled(images);
    views.add(kFrame_ns) = 10;
    views.add(2 * kFrame_ns) = 20;
    EXPECT_EQ(views.at(kFrame_ns), 10);
    EXPECT_EQ(views.at(2 * kFrame_ns), 20);
    EXPECT_NE(refusal(views, (images - 1) * kFrame_ns + 1).find("last 2 images, from 0.033333333 s"),
              std::string::npos);
  }
}

TEST(LastViews, NothingIsLeftAfterClear) {
  LastViews<int> views = filled(kKept + 5);
  views.clear();
  EXPECT_NE(refusal(views, (kKept + 4) * kFrame_ns), "");
  views.add(7) = 1;
  EXPECT_EQ(views.at(7), 1);
}

}  // namespace
}  // namespace aras_visual_servo_camera::last_views_test
