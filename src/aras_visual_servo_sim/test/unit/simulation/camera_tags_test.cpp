#include <gtest/gtest.h>

#include "aras_visual_servo_sim/errors.hpp"
#include "aras_visual_servo_sim/simulation.hpp"

namespace aras_visual_servo_sim {
namespace {

RobotModel robotWithCamera(const std::string& format) {
  RobotModel robot;
  CameraTag tag;
  tag.link = "camera_link";
  tag.camera_name = "/eye";
  tag.frame = "eye_optical_frame";
  tag.format = format;
  tag.width = 64;
  tag.height = 48;
  tag.update_rate_hz = 25.0;
  tag.horizontal_fov_rad = 1.2;
  tag.distortion = {0.1, 0.2, 0.3, 0.4, 0.5};
  robot.cameras.push_back(tag);
  return robot;
}

TEST(CameraTags, BecomeACameraWithTheTagsNumbers) {
  const std::vector<CameraConfig> cameras = camerasFromTags(robotWithCamera("L8"));
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].name, "eye");
  EXPECT_EQ(cameras[0].frame, "eye_optical_frame");
  EXPECT_EQ(cameras[0].width, 64);
  EXPECT_EQ(cameras[0].height, 48);
  EXPECT_EQ(cameras[0].rate_hz, 25.0);
  EXPECT_EQ(*cameras[0].horizontal_fov_rad, 1.2);
  EXPECT_EQ(cameras[0].encoding, "mono8");
  EXPECT_EQ(cameras[0].distortion_model, "plumb_bob");
  EXPECT_EQ(cameras[0].distortion.back(), 0.5);
}

TEST(CameraTags, UnknownImageFormatIsRefused) {
  EXPECT_THROW(camerasFromTags(robotWithCamera("BAYER_RGGB8")), ModelError);
}

}  // namespace
}  // namespace aras_visual_servo_sim
