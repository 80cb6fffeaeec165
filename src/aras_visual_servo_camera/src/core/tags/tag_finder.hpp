#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace aras_visual_servo_camera {

/** One tag in an image: the corners of its black square as one who reads the tag upright sees them, from the upper left
 *  one on clockwise, in pixels whose middles are whole numbers. */
struct SeenTag {
  int id;
  std::array<cv::Point2d, 4> corners_px;
};

/** Finds the tags of a family. */
class TagFinder {
 public:
  virtual ~TagFinder() = default;
  /** @param grey  8 bit */
  virtual std::vector<SeenTag> find(const cv::Mat& grey) = 0;
};

/** Makes the finder that apriltag/ implements. It stands in a library of its own, which is opened with the first finder
 *  and then stays open: the detector of ViSP brings some 220 libraries, which take longer to load than all others of a
 *  process, and most who use this package look for no tag.
 *  @param family   one of those that tag.yaml lists
 *  @param library  its file; by default the one that was installed beside the library of this function
 *  @throws ArasError naming the file and why it cannot be used */
std::unique_ptr<TagFinder> openTagFinder(const std::string& family, const std::string& library = "");

/** The function kNewAprilTagFinder of the library kAprilTagLibrary: it makes a finder of the tags of a family. The
 * caller deletes it. */
using NewAprilTagFinder = TagFinder*(const char* family);

constexpr const char* kAprilTagLibrary = "libaras_visual_servo_camera_apriltag.so";
constexpr const char* kNewAprilTagFinder = "aras_visual_servo_camera_new_apriltag_finder";

}  // namespace aras_visual_servo_camera
