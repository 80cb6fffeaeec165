#include <visp3/detection/vpDetectorAprilTag.h>

#include <cstring>
#include <map>

#include "tags/tag_finder.hpp"

namespace aras_visual_servo_camera {
namespace {

// The library puts the middle of the first pixel at (1/2, 1/2).
constexpr double kShift_px = -0.5;

vpDetectorAprilTag::vpAprilTagFamily familyOf(const std::string& name) {
  static const std::map<std::string, vpDetectorAprilTag::vpAprilTagFamily> kFamilies = {
      {"36h11", vpDetectorAprilTag::TAG_36h11},
      {"36h10", vpDetectorAprilTag::TAG_36h10},
      {"25h9", vpDetectorAprilTag::TAG_25h9},
      {"16h5", vpDetectorAprilTag::TAG_16h5}};
  return kFamilies.at(name);
}

/** With ViSP's copy of the AprilTag library, in one thread. */
class AprilTagFinder : public TagFinder {
 public:
  explicit AprilTagFinder(const std::string& family) : detector_(familyOf(family)) {
    detector_.setAprilTagNbThreads(1);
    detector_.setAprilTagQuadDecimate(1.0F);
  }

  std::vector<SeenTag> find(const cv::Mat& grey) override {
    image_.resize(static_cast<unsigned>(grey.rows), static_cast<unsigned>(grey.cols));
    for (int v = 0; v < grey.rows; ++v) std::memcpy(image_[v], grey.ptr(v), static_cast<std::size_t>(grey.cols));
    std::vector<SeenTag> seen;
    detector_.detect(image_);
    const std::vector<int> ids = detector_.getTagsId();
    const std::vector<std::vector<vpImagePoint>> corners = detector_.getTagsCorners();
    for (std::size_t k = 0; k < ids.size(); ++k) {
      SeenTag tag{ids[k], {}};
      // ViSP begins at the upper right corner and goes on counter-clockwise.
      for (std::size_t i = 0; i < 4; ++i) {
        const vpImagePoint& corner = corners[k][(5 - i) % 4];
        tag.corners_px[i] = {corner.get_u() + kShift_px, corner.get_v() + kShift_px};
      }
      seen.push_back(tag);
    }
    return seen;
  }

 private:
  vpDetectorAprilTag detector_;
  vpImage<unsigned char> image_;
};

}  // namespace
}  // namespace aras_visual_servo_camera

extern "C" aras_visual_servo_camera::TagFinder* aras_visual_servo_camera_new_apriltag_finder(const char* family) {
  return new aras_visual_servo_camera::AprilTagFinder(family);
}
