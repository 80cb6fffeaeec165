#include "tags/tag_finder.hpp"

#include <gtest/gtest.h>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {
namespace {

std::string faultOf(const std::string& library) {
  try {
    openTagFinder("36h11", library);
  } catch (const ArasError& error) {
    return error.what();
  }
  return "none";
}

TEST(TagFinder, SeesNoTagInAnEmptyImage) {
  const std::unique_ptr<TagFinder> finder = openTagFinder("36h11");
  EXPECT_TRUE(finder->find(cv::Mat::zeros(60, 80, CV_8UC1)).empty());
}

TEST(TagFinder, NamesALibraryThatIsNotThere) {
  const std::string fault = faultOf("/nowhere/libtags.so");
  EXPECT_NE(fault.find("/nowhere/libtags.so"), std::string::npos) << fault;
  EXPECT_NE(fault.find("AprilTags"), std::string::npos) << fault;
}

TEST(TagFinder, NamesALibraryThatFindsNone) {
  const std::string fault = faultOf("libm.so.6");
  EXPECT_NE(fault.find("libm.so.6"), std::string::npos) << fault;
}

}  // namespace
}  // namespace aras_visual_servo_camera
