#include "tags/tag_finder.hpp"

#include <gtest/gtest.h>

#include "text_of.hpp"

namespace aras_visual_servo_camera::tag_finder_test {
namespace {

TEST(TagFinder, SeesNoTagInAnEmptyImage) {
  const std::unique_ptr<TagFinder> finder = openTagFinder("36h11");
  EXPECT_TRUE(finder->find(cv::Mat::zeros(60, 80, CV_8UC1)).empty());
}

TEST(TagFinder, NamesALibraryThatIsNotThereOrFindsNone) {
  for (const char* library : {"/nowhere/libtags.so", "libm.so.6"}) {
    const std::string fault = testing::textOf([&] { openTagFinder("36h11", library); });
    EXPECT_NE(fault.find(library), std::string::npos) << fault;
    EXPECT_NE(fault.find("AprilTags"), std::string::npos) << fault;
  }
}

}  // namespace
}  // namespace aras_visual_servo_camera::tag_finder_test
